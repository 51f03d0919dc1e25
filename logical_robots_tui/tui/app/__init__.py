"""The app: the main screen, its session, permissions, and work in the background."""
