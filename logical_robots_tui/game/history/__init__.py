"""What a game remembers: branches, marks and packed ticks."""
