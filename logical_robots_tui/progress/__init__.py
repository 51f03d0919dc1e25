"""A player's progress in one SQLite file that survives crashes and concurrent games."""

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
