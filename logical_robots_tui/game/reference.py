"""The measures of the reference programs, and counting the rules of a program."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.progress import Measures
from logical_robots_tui.shipped import shipped_folder

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.world import Level

__all__ = [
    "FIELDS",
    "FILE_NAME",
    "count_rules",
    "is_shipped",
    "level_key",
    "reference_for",
    "reference_table",
]

FILE_NAME = "reference.csv"
FIELDS = ("level", "ticks", "rules", "distance", "wins", "starts")


def is_shipped(level: Level) -> bool:
    """Return whether a level is a shipped one."""
    if not level.source:
        return False
    return Path(level.source).resolve().parent == shipped_folder("levels").resolve()


def level_key(level: Level) -> str:
    """Return the key for progress at a level: its name, or the full path of a player's level."""
    return level.name if is_shipped(level) else str(Path(level.source or level.name).absolute())


def reference_for(level: Level) -> Measures | None:
    """Return the measures of a level's reference program, or None if there is none."""
    return reference_table().get(level.name) if is_shipped(level) else None


@lru_cache(maxsize=1)
def reference_table() -> Mapping[str, Measures]:
    """Return the measures of all reference programs by level name."""
    import csv  # takes time that the first picture needs

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


def count_rules(text: str) -> int:
    """Return the number of rules of a program that compiles.

    Every statement counts as one, however long it is and however many cases it has; annotations,
    which begin with ``@``, don't.
    """
    from logical_robots_tui.mind.source_text import prepare, statements

    source = prepare(text)
    return sum(source.text[start] != "@" for start, _ in statements(source))
