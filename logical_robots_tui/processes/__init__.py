"""The processes of the game: what helpers may do, and how a game shows that it is alive."""
