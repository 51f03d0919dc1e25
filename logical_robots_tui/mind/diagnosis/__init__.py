"""Diagnosis: what a program's rules and conditions did in a whole run, and what that tells.

In the compile process `tracing` makes queries for all rules and conditions and `memory` looks for
what memories hold. In a mind `counting` counts what the queries give tick by tick, `telling` says
what stands out, and `nearest` which one change would have given a rule a row.
"""
