"""What a player can ask for: commands, their keys, the palette and the help."""
