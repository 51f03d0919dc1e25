"""What draws and writes the pages of this folder."""
