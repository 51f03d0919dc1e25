"""Labyrinths of the day, made from a date and a size: everybody gets the same.

A name such as ``daily-2026-11-22-small`` is all that such a level is made from. A ``-2`` at its end
asks for the second labyrinth of that day and size, and so on.
"""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import date
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, cast, get_args
from zlib import crc32

from logical_robots_tui.world.level import Beacon
from logical_robots_tui.world.levels.labyrinths import labyrinth

if TYPE_CHECKING:
    from logical_robots_tui.world.level import Level

__all__ = ["DAILY_SIZES", "Daily", "DailySize"]

DailySize: TypeAlias = Literal["small", "medium", "large"]
DAILY_SIZES: tuple[DailySize, ...] = get_args(DailySize)

_CELLS: dict[DailySize, tuple[int, int]] = {"small": (5, 4), "medium": (7, 5), "large": (9, 6)}
_CORRIDOR, _WALL = 90, 20  # map units
_NAME = re.compile(rf"daily-(\d{{4}}-\d\d-\d\d)-({'|'.join(DAILY_SIZES)})(?:-([2-9]|[1-9]\d))?")

_BRIEFING = """\
Bring Ada to the beacon Goal. There are no loops, so all walls hang together.
Everybody has this labyrinth today. Who needs the fewest ticks, and who the
fewest rules? The command "Copy my result" makes a line to share.
"""


class Daily(NamedTuple):
    """A labyrinth of a day.

    The number counts those of that day and size, from 1.
    """

    day: date
    size: DailySize
    number: int = 1

    @classmethod
    def named(cls, name: str) -> Daily | None:
        """Return the labyrinth with a name, or None if no labyrinth has it."""
        if (found := _NAME.fullmatch(name)) is None:
            return None
        try:
            day = date.fromisoformat(found[1])
        except ValueError:
            return None
        return cls(day, cast("DailySize", found[2]), int(found[3] or 1))

    @property
    def name(self) -> str:
        """The name of the level."""
        more = f"-{self.number}" if self.number > 1 else ""
        return f"daily-{self.day.isoformat()}-{self.size}{more}"

    @property
    def cells(self) -> int:
        """The number of its cells."""
        columns, rows = _CELLS[self.size]
        return columns * rows

    def level(self, source: str) -> Level:
        """Return the level."""
        seed = crc32(self.name.encode())
        made = labyrinth(*_CELLS[self.size], seed=seed, loops=0, corridor=_CORRIDOR, wall=_WALL)
        (goal,) = made.areas
        return replace(
            made,
            name=self.name,
            title=f"Labyrinth of {self.day.isoformat()}, {self.size}",
            beacons=(Beacon("Goal", goal.x, goal.y),),
            idea="Everybody has this labyrinth today.",
            briefing=_BRIEFING.strip(),
            starter="first-steps-starter",
            source=source,
        )
