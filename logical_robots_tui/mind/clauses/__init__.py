"""Rules taken apart into clauses, each with one query for its derivations: in the compile process.

`decomposition` does it for a predicate; `normal_form` makes a clause of each choice of
alternatives.
"""
