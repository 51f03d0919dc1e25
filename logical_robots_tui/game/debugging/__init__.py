"""Tools for finding mistakes: breakpoints, searches, queries and explanations."""
