"""The screen: draws frames and sends commands; it owns no rules of the game."""
