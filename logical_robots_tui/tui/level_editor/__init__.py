"""Editing levels on the screen."""
