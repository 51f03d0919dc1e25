"""Tuning: rewriting the SQL of a program so that SQLite needs less time for the same rows.

All robots' rows are loaded once a tick, with sensor fields and radar rays as columns.
"""

from logical_robots_tui.mind.tuning.columns import MemoryColumns
from logical_robots_tui.mind.tuning.passes import MOST_TUNED, tune, tune_all

__all__ = ["MOST_TUNED", "MemoryColumns", "tune", "tune_all"]
