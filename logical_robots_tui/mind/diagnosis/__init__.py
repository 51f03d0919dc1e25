"""Diagnosis: what a program's rules and conditions did in a whole run, and what that tells.

In the compile process `tracing` makes queries for all rules and conditions and `fields` looks for
what memories hold; in a mind `counting` asks the queries tick by tick and `telling` says what stands out.
"""
