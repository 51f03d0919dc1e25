"""Types of expressions, traced through the rules, for messages about a program."""
