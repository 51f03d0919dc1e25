"""Commands that run a program in a level without a screen, and look into the run."""
