"""What a program would do on the web platform, where that is something else than here."""
