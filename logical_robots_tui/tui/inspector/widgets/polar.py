"""A radar as a small picture: the robot below in the middle, looking up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from textual.content import Content

from logical_robots_tui.tui.theme.themes import INK

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

__all__ = ["polar"]

_FARTHEST = 200.0
_BRAILLE = 0x2800
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
_COLOURS = {"wall": INK.wall, "beacon": INK.beacon, "robot": INK.robot}


def polar(radar: Sequence[Mapping[str, Any]], rows: int) -> list[Content]:
    """Draw where the rays of a radar end.

    Args:
        radar: The rays, each with angle (radians, to the left is positive), distance and object.
        rows: How many lines to use; the picture is twice as wide as it is high in cells.

    Returns:
        The lines, from the top, each 4 * rows cells wide.
    """
    columns = 4 * rows
    across, down = 2 * columns, 4 * rows
    dots: dict[tuple[int, int], int] = {}
    colours: dict[tuple[int, int], str] = {}
    scale = (down - 1) / _FARTHEST

    def put(distance: float, angle: float, colour: str) -> None:
        x = round(across / 2 - math.sin(angle) * distance * scale)
        y = round(down - 1 - math.cos(angle) * distance * scale)
        if 0 <= x < across and 0 <= y < down:
            cell = y // 4, x // 2
            dots[cell] = dots.get(cell, 0) | _DOTS[y % 4][x % 2]
            if colours.get(cell, INK.faint) == INK.faint:
                colours[cell] = colour

    for ray in radar:
        end = float(ray["distance"])
        for step in range(1, 10):
            put(end * step / 10, ray["angle"], INK.faint)
        put(end, ray["angle"], _COLOURS.get(ray["object"], INK.faint))
    colours[rows - 1, columns // 2] = INK.key
    dots[rows - 1, columns // 2] = 0xC0
    return [
        Content.assemble(
            *(
                (chr(_BRAILLE + dots.get((row, column), 0)), colours.get((row, column), INK.faint))
                for column in range(columns)
            )
        )
        for row in range(rows)
    ]
