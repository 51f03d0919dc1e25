"""Themes, colours, and making text from players safe to show."""
