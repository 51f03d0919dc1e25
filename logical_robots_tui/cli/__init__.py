"""The commands: play in a terminal, run without one, list what there is."""
