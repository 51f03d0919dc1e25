"""How well the reference programs win our levels, measured once and shipped beside them."""

from __future__ import annotations

import csv
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.progress import Measures
from logical_robots_tui.shipped import shipped_folder

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.world import Level

__all__ = ["FIELDS", "FILE_NAME", "is_shipped", "level_key", "reference_for", "reference_table"]

FILE_NAME = "reference.csv"
FIELDS = ("level", "ticks", "rules", "distance", "wins", "starts")


def is_shipped(level: Level) -> bool:
    """Whether a level came with the game."""
    if not level.source:
        return False
    return Path(level.source).resolve().parent == shipped_folder("levels").resolve()


def level_key(level: Level) -> str:
    """The name under which progress at a level is kept: of any other file, its whole path."""
    return level.name if is_shipped(level) else str(Path(level.source or level.name).absolute())


def reference_for(level: Level) -> Measures | None:
    """Measures of a level's reference program, or None if there is none."""
    return reference_table().get(level.name) if is_shipped(level) else None


@lru_cache(maxsize=1)
def reference_table() -> Mapping[str, Measures]:
    """The measures of all reference programs, by the names of their levels."""
    try:
        with (shipped_folder("levels") / FILE_NAME).open(encoding="utf-8", newline="") as file:
            return {row["level"]: _measures(row) for row in csv.DictReader(file)}
    except FileNotFoundError:
        return {}


def _measures(row: dict[str, str]) -> Measures:
    return Measures(
        int(row["ticks"]),
        int(row["rules"]),
        float(row["distance"]),
        int(row["wins"]),
        int(row["starts"]),
    )
