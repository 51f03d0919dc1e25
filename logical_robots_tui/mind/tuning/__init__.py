"""Tuning: rewriting the SQL of a program so that SQLite needs less time for the same rows.

Rows of all robots are loaded once a tick, with sensor fields and radar rays in columns of their
own; repeated expressions are computed once. Runs in the compile process only.
"""

from logical_robots_tui.mind.tuning.columns import MemoryColumns
from logical_robots_tui.mind.tuning.passes import MOST_TUNED, tune, tune_all

__all__ = ["MOST_TUNED", "MemoryColumns", "tune", "tune_all"]
