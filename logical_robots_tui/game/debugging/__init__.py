"""Tools for finding mistakes: breakpoints, searches, questions and explanations."""
