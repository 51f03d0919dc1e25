"""A look at a player's record that opens nothing for good, mends nothing and tells nobody."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING

from logical_robots_tui.paths import is_there

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["facts_in"]


def facts_in(file: Path, *names: str) -> tuple[str, ...] | None:
    """Return what `Progress.fact` would for each name; "" where there is no such fact.

    Args:
        file: The record, whether there is one or not.
        names: Of the facts.

    Returns:
        Facts; None if it is unclear what they are.
    """
    if not is_there(file):
        return ("",) * len(names)
    try:
        place = f"{file.absolute().as_uri()}?mode=ro"
        with closing(sqlite3.connect(place, uri=True, timeout=0)) as record:
            found = dict(record.execute("SELECT name, value FROM fact"))
    except sqlite3.Error:
        return None
    return tuple(str(found.get(name, "")) for name in names)
