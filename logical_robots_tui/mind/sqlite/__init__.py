"""The rows of a moment in SQLite, and what a program may compute there."""
