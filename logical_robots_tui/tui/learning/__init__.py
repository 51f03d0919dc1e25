"""What helps a player on: briefing, hints, lessons, the tour."""
