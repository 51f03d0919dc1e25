"""Levels: reading them from files of either format, and making new ones."""
