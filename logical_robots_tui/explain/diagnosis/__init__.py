"""Diagnosis: what a program's rules and conditions did in a whole run, and what stands out.

In the compile process, `tracing` generates queries for all rules and conditions, and `checkup`
finds what memories hold. In a mind, `sites` counts the queries' rows tick by tick, and `telling`
reports what stands out.
"""
