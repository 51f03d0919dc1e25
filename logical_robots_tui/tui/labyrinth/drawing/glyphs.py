"""How a labyrinth is drawn: its characters, the choices that a player has, and on what."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from logical_robots_tui.tui.labyrinth.drawing.cells import DARK, RGB, Cells, Palette, rgb_number
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport


class Drawing(Enum):
    QUADRANTS = "quadrants"
    """Four dots of two colours in each cell."""
    HALVES = "halves"
    """Two dots in each cell, for fonts without quadrants."""
    SEXTANTS = "sextants"
    """Six dots of two colours in each cell, for fonts that have them."""
    ASCII = "ascii"
    """Plain characters that need no colour."""

    @property
    def dots(self) -> tuple[int, int]:
        """Dots of a cell, across and down."""
        return _DOTS[self]

    @property
    def glyphs(self) -> GlyphSet:
        return ASCII if self is Drawing.ASCII else UNICODE


_DOTS = {
    Drawing.QUADRANTS: (2, 2),
    Drawing.HALVES: (1, 2),
    Drawing.SEXTANTS: (2, 3),
    Drawing.ASCII: (1, 1),
}


class GlyphSet(NamedTuple):
    """One character, one cell wide, for everything that stands in a labyrinth.

    Attributes:
        headings: Clockwise from the right, evenly spread.
        ghosts: The same for robots of another run.
        undecided: Behind the name of a robot for which the program decided nothing.
        hit_wall_near: The end of a ray at a wall, where rays end far apart.
        thread: A cell that a trail or a ray goes through, where it is not drawn in braille.
    """

    headings: str = "→↘↓↙←↖↑↗"
    ghosts: str = "▹▿◃▵"
    dead: str = "✕"
    blocked: str = "!"
    undecided: str = "?"
    beacon: str = "◆"
    charger: str = "↯"
    goal: str = "⚑"
    hit_wall: str = "·"
    hit_wall_near: str = "\N{MULTIPLICATION SIGN}"
    hit_beacon: str = "◇"
    hit_robot: str = "•"
    thread: str = "·"
    cut: str = "…"
    unknown: str = "□"

    def heading(self, angle: float) -> str:
        """Return the arrow nearest to a heading in radians, clockwise from the right."""
        return self._nearest(self.headings, angle)

    def ghost(self, angle: float) -> str:
        """Return the same for a robot of another run."""
        return self._nearest(self.ghosts, angle)

    def _nearest(self, signs: str, angle: float) -> str:
        if not math.isfinite(angle):
            return self.unknown
        return signs[round(angle / (2 * math.pi) * len(signs)) % len(signs)]


UNICODE = GlyphSet()
ASCII = GlyphSet(
    headings=">v<^",
    ghosts="&",
    dead="X",
    beacon="*",
    charger="$",
    goal="@",
    hit_wall="x",
    hit_wall_near="x",
    hit_beacon="+",
    hit_robot="o",
    thread="'",
    cut="~",
    unknown="?",
)


def legend(
    drawing: Drawing = Drawing.QUADRANTS, palette: Palette = DARK
) -> Sequence[tuple[str, RGB, str]]:
    """Return the meaning of each glyph, as (glyph, colour, meaning)."""
    glyphs = drawing.glyphs
    robot, area = (74, 158, 255), (63, 185, 80)
    rows = [
        (glyphs.heading(0), robot, "robot, pointing where it is heading"),
        (glyphs.dead, palette.dead, "robot with an empty battery"),
        (glyphs.blocked, palette.alarm, "robot that a wall stopped"),
        (glyphs.undecided, palette.alarm, "robot for which the program decided nothing"),
        (glyphs.ghost(0), palette.faint(robot), "robot of another run, a ghost"),
        (glyphs.beacon, palette.beacon, "beacon"),
        (glyphs.charger, palette.charger, "beacon that charges batteries"),
        (glyphs.goal, area, "goal area"),
        (glyphs.hit_wall, palette.hit_wall, "a ray ends at a wall"),
        (glyphs.hit_wall_near, palette.hit_wall, "the same, seen from near"),
        (glyphs.hit_beacon, palette.hit_beacon, "a ray ends at a beacon"),
        (glyphs.hit_robot, palette.hit_robot, "a ray ends at a robot"),
    ]
    braille = drawing in (Drawing.QUADRANTS, Drawing.SEXTANTS)
    rows.append(("⠢" if braille else glyphs.thread, robot, "where a robot came from"))
    if drawing is Drawing.ASCII:
        rows += [
            ("#", palette.rim, "wall"),
            (".", robot, "floor that a robot's rays reach"),
            (":", area, "area"),
            ("%", area, "solid area"),
            (",", area, "area that is switched off"),
        ]
    else:
        rows += [
            ("█", palette.rim, "wall"),
            ("▒", robot, "light: what a robot's rays reach"),
            ("○", area, "area; dotted and dim while it is switched off"),
            ("◍", area, "solid area, striped"),
        ]
    return rows


class Highlight(NamedTuple):
    """A robot, or a ray by its angle in radians, to highlight; None means the robot."""

    robot: str
    ray: float | None = None


@dataclass(frozen=True, slots=True)
class Look:
    """The choices that a player has about the picture.

    `rays` show as light, `marks` are at their ends, `lines` are the rays of the selected robot;
    `pulse` is the beacons' phase, 0 to 3, 0 being brightest.
    """

    drawing: Drawing = Drawing.QUADRANTS
    palette: Palette = DARK
    rays: bool = True
    marks: bool = True
    lines: bool = False
    trails: bool = True
    names: bool = True
    selected: str | None = None
    highlight: Highlight | None = None
    pulse: int = 0

    @property
    def glyphs(self) -> GlyphSet:
        return self.drawing.glyphs

    @property
    def is_plain(self) -> bool:
        return self.drawing is Drawing.ASCII


class Canvas(NamedTuple):
    """Cells to draw on, the part of the map that they show, and how it is drawn."""

    cells: Cells
    view: Viewport
    look: Look

    def put(
        self, cell: tuple[int, int] | None, sign: str, ink: RGB, paper: RGB | None = None
    ) -> None:
        """Write a bold sign into a (row, column), if there is one; by default on its tone."""
        if cell is not None:
            behind = -1 if paper is None else rgb_number(paper)
            self.cells.put(*cell, sign, rgb_number(ink), behind, bold=True)
