"""A player's progress in one SQLite file, and the board of all players in another."""

from logical_robots_tui.progress.progress import FILE_NAME, MOST_VERSIONS, Progress
from logical_robots_tui.progress.store import NEW, Bests, LevelRecord, Measures, State, Version

__all__ = [
    "FILE_NAME",
    "MOST_VERSIONS",
    "NEW",
    "Bests",
    "LevelRecord",
    "Measures",
    "Progress",
    "State",
    "Version",
]
