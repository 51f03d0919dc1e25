"""What a player has and does, without a screen: session, texts, drafts, results, recovery."""
