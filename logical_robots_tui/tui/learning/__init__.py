"""Learning: briefing, hints, lessons, the tour."""
