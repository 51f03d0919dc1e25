"""A level as an SVG drawing, still or moving."""

from __future__ import annotations

import math
from dataclasses import replace
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.cells import DARK, RGB, mix, parse
from logical_robots_tui.tui.labyrinth.drawing.cells import hex_colour as _hex
from logical_robots_tui.tui.labyrinth.drawing.ground import beacon_colour
from logical_robots_tui.tui.labyrinth.drawing.lettering import names_once, robot_colour
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.world import Area, Beacon, Level, Robot, WorldState

    Point = tuple[float, float]
    Pose = tuple[float, float, float]

_FONT = "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace"
_FONT_SIZE = 12  # map units

_TICKS_PER_SECOND = 40
_FRAMES_PER_SECOND = 20  # between which robots drive straight on
_LONGEST = 60  # seconds of motion; a longer run is played faster
_REST = 2  # seconds for which the end is shown
_MOST_BYTES = 1_800_000  # of poses, by an upper bound
_POSE_BYTES, _SWITCH_BYTES = 20, 8
_STILL = "<style>@media (prefers-reduced-motion){.run{display:none}.end{display:inline}}</style>"


def svg(level: Level, paths: Mapping[str, Sequence[Point]] | None = None) -> str:
    """Return a level at its start as SVG in dark colours; one SVG unit is one map unit."""
    paths = paths or {}
    activity = tuple(area.is_on(0) for area in level.areas)
    trails = (_path(robot, paths.get(robot.name, ())) for robot in level.robots)
    return _document(level, *_objects(level, [_poses_of(level)], [activity], "", *trails))


def moving_svg(level: Level, states: Iterable[WorldState], ticks: int) -> tuple[str, int]:
    """Return a run of so many ticks as SVG, and how many ticks one drawn pose stands for.

    Where a reader wants no motion, it shows the end.
    """
    speed = max(_TICKS_PER_SECOND, ticks / _LONGEST)
    switches = sum(bool(area.on_beacon or area.off_beacon or area.cycle) for area in level.areas)
    size = ticks * (len(level.robots) * _POSE_BYTES + switches * _SWITCH_BYTES)
    step = math.ceil(max(size / _MOST_BYTES, speed / _FRAMES_PER_SECOND))
    poses, activities = _frames(level, states, ticks, step)
    pause = min(len(poses), round(_REST * speed / step))
    poses += poses[-1:] * pause
    activities += activities[-1:] * pause
    timing = f'dur="{(len(poses) - 1) * step / speed:.5g}s" repeatCount="indefinite"'
    text = _document(
        level,
        f'{_STILL}<g class="run">',
        *_objects(level, poses, activities, timing),
        '</g><g class="end" display="none">',
        *_objects(level, poses[-1:], activities[-1:], ""),
        "</g>",
    )
    return text, step


def _poses_of(level: Level) -> tuple[Pose, ...]:
    return tuple((robot.x, robot.y, robot.angle) for robot in level.robots)


def _frames(
    level: Level, states: Iterable[WorldState], ticks: int, step: int
) -> tuple[list[tuple[Pose, ...]], list[tuple[bool, ...]]]:
    """Return the poses of the level's robots in every so many ticks, and which areas are on.

    A robot that a state lacks stays where it is in the level. Angles go on beyond a whole turn.
    """
    poses = dict(zip((robot.name for robot in level.robots), _poses_of(level), strict=True))
    activity = tuple(area.is_on(0) for area in level.areas)
    all_poses, activities = [], []
    for number, state in enumerate(states):
        for robot in state.robots:
            if robot.name in poses:
                angle = poses[robot.name][2]
                angle += math.remainder(robot.angle - angle, math.tau)
                poses[robot.name] = robot.x, robot.y, angle
        if number % step == 0 or number == ticks:
            if len(state.areas) == len(activity):
                activity = tuple(area.active for area in state.areas)
            all_poses.append(tuple(poses.values()))
            activities.append(activity)
    return all_poses, activities


def _objects(
    level: Level,
    poses: Sequence[tuple[Pose, ...]],
    activities: Sequence[tuple[bool, ...]],
    timing: str,
    *trails: str,
) -> Iterator[str]:
    """Yield areas, beacons, trails and robots through frames, or in the only one."""
    names = iter(names_once(level))
    for area, activity in zip(level.areas, zip(*activities, strict=True), strict=True):
        yield _switched(replace(area, name=next(names)), activity, timing)
    yield from map(_beacon, level.beacons, names)
    yield from trails
    for robot, motion in zip(level.robots, zip(*poses, strict=True), strict=True):
        yield _robot(robot, motion, timing)


def _document(level: Level, *parts: str) -> str:
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {level.width} {level.height}"'
            f' font-family="{_FONT}" font-size="{_FONT_SIZE}" text-anchor="middle">',
            f'<rect width="{level.width}" height="{level.height}" fill="{_hex(DARK.floor)}"/>',
            f'<path d="{"".join(_rectangles(level.walls))}" fill="{_hex(DARK.rock)}"'
            f' stroke="{_hex(DARK.rock)}" stroke-width="0.2"/>',
            f'<path d="{"".join(_edges(level.walls))}" stroke="{_hex(DARK.rim)}"'
            ' stroke-width="1.5" fill="none"/>',
            *parts,
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


def _area(area: Area, *, is_active: bool) -> str:
    colour = DARK.legible(parse(area.color))
    look = f'fill="{_hex(colour)}" fill-opacity="{0.5 if area.impenetrable else 0.22}"'
    if not is_active:
        look = 'fill="none" stroke-dasharray="6 6"'
    rings = [(area.radius, look)]
    if area.victory_robots and area.radius > 6:
        rings.append((area.radius - 5, 'fill="none"'))
    return "".join(
        f'<circle cx="{_number(area.x)}" cy="{_number(area.y)}" r="{_number(radius)}" {attributes}'
        f' stroke="{_hex(colour)}" stroke-width="2"/>'
        for radius, attributes in rings
    ) + _name(area.name, area.x, area.y + 4, DARK.strong(parse(area.color)))


def _switched(area: Area, activity: Sequence[bool], timing: str) -> str:
    """Return an area that is drawn as on and as off by turns."""
    changes = [n for n, active in enumerate(activity) if n == 0 or active != activity[n - 1]]
    if len(changes) == 1:
        return _area(area, is_active=activity[0])
    times = ";".join(f"{n / (len(activity) - 1):.4g}" for n in changes)
    pieces = []
    for is_active in (True, False):
        values = ["visible" if activity[n] == is_active else "hidden" for n in changes]
        pieces.append(
            f'<g visibility="{values[-1]}"><animate attributeName="visibility" calcMode="discrete"'
            f' values="{";".join(values)}" keyTimes="{times}" {timing}/>'
            f"{_area(area, is_active=is_active)}</g>"
        )
    return "".join(pieces)


def _beacon(beacon: Beacon, name: str) -> str:
    colour = beacon_colour(beacon, DARK)
    size = _number(BEACON_RADIUS * 0.8)
    left, top = _number(beacon.x - BEACON_RADIUS * 0.8), _number(beacon.y)
    path = f"M{left} {top}l{size} -{size} {size} {size} -{size} {size}z"
    return f'<path d="{path}" fill="{_hex(colour)}"/>' + _name(
        name, beacon.x, beacon.y - BEACON_RADIUS - 3, colour
    )


def _robot(robot: Robot, poses: Sequence[Pose], timing: str) -> str:
    colour = robot_colour(robot.color, DARK)
    places = _transformed("translate", [f"{x:.1f} {y:.1f}" for x, y, _ in poses], timing)
    turns = _transformed("rotate", [f"{math.degrees(angle):.0f}" for *_, angle in poses], timing)
    return (
        f'{places}{turns}<circle r="{_number(ROBOT_RADIUS)}" fill="{_hex(colour)}"'
        f' stroke="{_hex(mix(colour, (0, 0, 0), 0.45))}"/>'
        f'<path d="M8 0L-2 4V-4z" fill="{_hex(mix(colour, DARK.bright, 0.72))}"/></g>'
        f"{_name(robot.name, 0, -ROBOT_RADIUS - 4, DARK.strong(colour))}</g>"
    )


def _transformed(kind: str, values: Sequence[str], timing: str) -> str:
    """Return the beginning of a group that moves through values, or has the only one."""
    group = f'<g transform="{kind}({values[0]})">'
    if len(set(values)) == 1:
        return group
    return (
        f'{group}<animateTransform attributeName="transform" type="{kind}"'
        f' values="{";".join(values)}" {timing}/>'
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
    return text and f'<text x="{_number(x)}" y="{_number(y)}" fill="{_hex(colour)}">{text}</text>'


def _number(value: float) -> str:
    return f"{value:.10g}"
