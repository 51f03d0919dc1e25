"""Boxes over the game that ask or tell something."""
