"""What was not saved when a session ended badly: kept, offered, swept."""
