"""What a game remembers: courses, marks and packed ticks."""
