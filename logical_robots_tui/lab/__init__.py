"""The laboratory: many runs, from one file, each computed once. No screen."""
