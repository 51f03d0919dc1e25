"""Editing levels without a screen: operations, undo, checks, files and generated labyrinths."""
