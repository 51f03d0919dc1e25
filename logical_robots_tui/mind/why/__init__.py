"""Why a row is there, or none: one derivation of it, or where each rule ends.

Like compiling, taking apart is done in the compile process: `clauses` makes one query for the
derivations of each body. `derivations` asks these queries at a tick, `deriving` and `refuting` tell
what they gave, and `sourcing` follows a value through them.
"""
