"""What a player has and does, without a screen: session, texts, results, settings, recovery."""
