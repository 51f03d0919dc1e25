"""The arrangement of panes, lines and dialogs on the screen."""
