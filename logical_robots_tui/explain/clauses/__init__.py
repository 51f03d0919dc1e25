"""Rules decomposed into clauses, each with one query for its derivations. In the compile process.

`decomposition` handles a predicate; `normal_form` turns each choice of alternatives into a
clause.
"""
