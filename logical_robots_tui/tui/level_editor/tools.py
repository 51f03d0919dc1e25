"""The tools of the level editor, and their settings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum


class Tool(Enum):
    """What the mouse button does; the values are command names."""

    HAND = "hand"
    BRUSH = "brush"
    LINE = "line"
    RECTANGLE = "rectangle"
    FILL = "fill"
    ERASER = "eraser"
    ROBOT = "robot"
    BEACON = "beacon"
    AREA = "area"


PAINTING = (Tool.BRUSH, Tool.LINE, Tool.RECTANGLE, Tool.ERASER)
"""Tools with a width."""

PLACING = (Tool.ROBOT, Tool.BEACON, Tool.AREA)
"""Tools that place something."""

WIDTHS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 40)
"""Choices for the width of brush and border, in grid squares."""

GRIDS = (1, 2, 5, 10, 20, 50)
"""Choices for the size of a grid square, in map units."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the tools: `width` in grid squares, `grid` in map units."""

    tool: Tool = Tool.HAND
    width: int = 1
    grid: int = 5
    is_grid_shown: bool = True
    is_wall: bool = True
    is_filled: bool = False

    @property
    def paints_wall(self) -> bool:
        return self.is_wall and self.tool is not Tool.ERASER

    def wider(self, steps: int) -> Settings:
        return replace(self, width=_beside(WIDTHS, self.width, steps))

    def next_grid(self) -> Settings:
        later = [grid for grid in GRIDS if grid > self.grid]
        return replace(self, grid=later[0] if later else GRIDS[0])


def _beside(choices: tuple[int, ...], now: int, steps: int) -> int:
    at = min(range(len(choices)), key=lambda place: abs(choices[place] - now))
    return choices[min(max(at + steps, 0), len(choices) - 1)]
