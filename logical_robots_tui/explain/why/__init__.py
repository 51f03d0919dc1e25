"""Why a predicate has a row or none: a derivation of the row, or where each rule fails.

The compile process decomposes rules: one query for the derivations of each body.
`derivations` evaluates these queries at a tick, `deriving` and `refuting` describe the results,
`nearest` looks for changes after which a rule would hold, and `sourcing` traces a value.
"""
