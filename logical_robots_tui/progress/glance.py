"""A look at a player's record that opens nothing for good, mends nothing and tells nobody."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["fact_in"]


def fact_in(file: Path, name: str) -> str | None:
    """Return what `Progress.fact` would; "" where there is no such fact, None if that is unclear.

    Args:
        file: The record, whether there is one or not.
        name: Of the fact.
    """
    if not file.exists():
        return ""
    try:
        place = f"{file.absolute().as_uri()}?mode=ro"
        with closing(sqlite3.connect(place, uri=True, timeout=0)) as record:
            row = record.execute("SELECT value FROM fact WHERE name = ?", (name,)).fetchone()
    except sqlite3.Error:
        return None
    return str(row[0]) if row else ""
