"""The rows of a moment in SQLite, and the functions that programs may use there."""
