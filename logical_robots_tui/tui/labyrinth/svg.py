"""A level as an SVG drawing."""

from __future__ import annotations

import math
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import DARK, RGB, mix, parse
from logical_robots_tui.tui.labyrinth.drawing.cells import hex_colour as _hex
from logical_robots_tui.tui.labyrinth.drawing.ground import beacon_colour
from logical_robots_tui.tui.labyrinth.drawing.lettering import robot_colour
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.world import Area, Beacon, Level, Robot

    Point = tuple[float, float]

_FONT = "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace"
_FONT_SIZE = 12  # map units


def svg(level: Level, paths: Mapping[str, Sequence[Point]] | None = None) -> str:
    """Return a level at its start as SVG in dark colours; one SVG unit is one map unit."""
    paths = paths or {}
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {level.width} {level.height}"'
            f' font-family="{_FONT}" font-size="{_FONT_SIZE}" text-anchor="middle">',
            f'<rect width="{level.width}" height="{level.height}" fill="{_hex(DARK.floor)}"/>',
            f'<path d="{"".join(_rectangles(level.walls))}" fill="{_hex(DARK.rock)}"'
            f' stroke="{_hex(DARK.rock)}" stroke-width="0.2"/>',
            f'<path d="{"".join(_edges(level.walls))}" stroke="{_hex(DARK.rim)}"'
            ' stroke-width="1.5" fill="none"/>',
            *(_area(area) for area in level.areas),
            *(_beacon(beacon) for beacon in level.beacons),
            *(_path(robot, paths.get(robot.name, ())) for robot in level.robots),
            *(_robot(robot) for robot in level.robots),
            "</svg>",
            "",
        ]
    )


def _rectangles(walls: NDArray[np.bool_]) -> Iterator[str]:
    """Yield the walls as rectangles: one for each run within a band of equal rows."""
    changes = np.flatnonzero((walls[1:] != walls[:-1]).any(axis=1)) + 1
    for top, bottom in pairwise([0, *changes.tolist(), len(walls)]):
        for left, right in _runs(walls[top]):
            yield f"M{left} {top}h{right - left}v{bottom - top}h{left - right}z"


def _edges(walls: NDArray[np.bool_]) -> Iterator[str]:
    for y in np.flatnonzero((walls[1:] != walls[:-1]).any(axis=1)).tolist():
        for left, right in _runs(walls[y] != walls[y + 1]):
            yield f"M{left} {y + 1}h{right - left}"
    for x in np.flatnonzero((walls[:, 1:] != walls[:, :-1]).any(axis=0)).tolist():
        for top, bottom in _runs(walls[:, x] != walls[:, x + 1]):
            yield f"M{x + 1} {top}v{bottom - top}"


def _runs(row: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.pad(row, 1).astype(np.int8))).tolist()
    return list(zip(edges[::2], edges[1::2], strict=True))


def _area(area: Area) -> str:
    colour = DARK.legible(parse(area.color))
    look = f'fill="{_hex(colour)}" fill-opacity="{0.5 if area.impenetrable else 0.22}"'
    if area.on_beacon:  # off at the start
        look = 'fill="none" stroke-dasharray="6 6"'
    rings = [(area.radius, look)]
    if area.victory_robots and area.radius > 6:
        rings.append((area.radius - 5, 'fill="none"'))
    return "".join(
        f'<circle cx="{_number(area.x)}" cy="{_number(area.y)}" r="{_number(radius)}" {attributes}'
        f' stroke="{_hex(colour)}" stroke-width="2"/>'
        for radius, attributes in rings
    ) + _name(area.name, area.x, area.y + 4, DARK.strong(parse(area.color)))


def _beacon(beacon: Beacon) -> str:
    colour = beacon_colour(beacon, DARK)
    size = _number(BEACON_RADIUS * 0.8)
    left, top = _number(beacon.x - BEACON_RADIUS * 0.8), _number(beacon.y)
    path = f"M{left} {top}l{size} -{size} {size} {size} -{size} {size}z"
    return f'<path d="{path}" fill="{_hex(colour)}"/>' + _name(
        beacon.name, beacon.x, beacon.y - BEACON_RADIUS - 3, colour
    )


def _robot(robot: Robot) -> str:
    colour = robot_colour(robot.color, DARK)
    nose = mix(colour, DARK.bright, 0.72)
    place = f"{_number(robot.x)} {_number(robot.y)}"
    turn = _number(math.degrees(robot.angle))
    return (
        f'<g transform="translate({place}) rotate({turn})">'
        f'<circle r="{_number(ROBOT_RADIUS)}" fill="{_hex(colour)}"'
        f' stroke="{_hex(mix(colour, (0, 0, 0), 0.45))}"/>'
        f'<path d="M8 0L-2 4V-4z" fill="{_hex(nose)}"/></g>'
        + _name(robot.name, robot.x, robot.y - ROBOT_RADIUS - 4, DARK.strong(colour))
    )


def _path(robot: Robot, points: Sequence[Point]) -> str:
    if not points:
        return ""
    colour = _hex(robot_colour(robot.color, DARK))
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    x, y = points[-1]
    return (
        f'<g fill="none" stroke="{colour}" stroke-width="2"><polyline points="{line}"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{_number(ROBOT_RADIUS)}"/></g>'
    )


def _name(name: str, x: float, y: float, colour: RGB) -> str:
    text = escape("".join(char for char in name if char.isprintable()))
    return f'<text x="{_number(x)}" y="{_number(y)}" fill="{_hex(colour)}">{text}</text>'


def _number(value: float) -> str:
    return f"{value:.10g}"
