"""Why a robot did what it did: each rule taken apart, part by part.

Like compiling, taking apart is done in the compile process: `building` makes one query for every
beginning of a rule's body. `explaining` asks these queries at a tick.
"""
