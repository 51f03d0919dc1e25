"""A mind's inputs in SQLite, and the functions that programs may use there."""
