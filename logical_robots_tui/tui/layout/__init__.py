"""How panes, lines and dialogs share the screen."""
