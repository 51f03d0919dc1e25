"""What the main screen looks like, cell by cell."""
