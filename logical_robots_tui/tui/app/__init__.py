"""The app: the main screen, its session, settings, permissions, and work in the background."""
