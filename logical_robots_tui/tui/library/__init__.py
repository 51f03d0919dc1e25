"""Choosing levels and programs, and the player's progress."""
