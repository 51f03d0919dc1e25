"""The language server: programs in the player's own editor, over standard input and output."""
