"""The level screen: a card for each level, with its miniature and what was achieved there."""
