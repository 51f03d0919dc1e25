"""Whether a match looks the same from every seat."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np

from logical_robots_tui.world.level import Area, Beacon, Level, Robot

_DIGITS = 6  # of places and headings that count as the same


def has_equal_seats(level: Level) -> bool:
    """Return whether turning the level takes each team to the place of the next one.

    Two teams are half a turn apart, four a quarter. Walls, beacons and areas come to lie on their
    like, with the same names; and each robot on one that is like it but for name and colour, and
    whose name has the same rank in its team. Mirrored seats differ: there left is right.
    """
    count = len(level.teams)
    if count not in (2, 4) or level.sensors.noise or level.shuffled_names:
        return False
    if any(area.victory_robots for area in level.areas):  # which are of some team
        return False
    if not np.array_equal(level.walls, np.rot90(level.walls, 4 // count)):
        return False
    objects: list[Beacon | Area] = [*level.beacons, *level.areas]
    places, next_places = (
        Counter(_turned(level, entity, turns) for entity in objects) for turns in (0, 1)
    )
    if places != next_places:
        return False
    seats = [[robot for robot in level.robots if robot.team == team.name] for team in level.teams]
    names = [[robot.name for robot in seat] for seat in seats]
    ranks = [[sorted(seat).index(name) for name in seat] for seat in names]
    bodies = [
        [_turned(level, replace(robot, name="", team="", color=""), turns) for robot in seat]
        for turns, seat in zip(range(count, 0, -1), seats, strict=True)
    ]
    return all(a == b for a, b in [*pairwise(ranks), *pairwise(bodies)])


def _turned(level: Level, entity: Robot | Beacon | Area, turns: int) -> Robot | Beacon | Area:
    """Return an object after so many turns from seat to seat, its place rounded."""
    angle = turns * math.tau / len(level.teams)
    cos, sin = round(math.cos(angle)), round(math.sin(angle))
    x, y = entity.x - level.width / 2, entity.y - level.height / 2
    x, y = round(x * cos - y * sin, _DIGITS), round(x * sin + y * cos, _DIGITS)
    if isinstance(entity, Robot):
        heading = round((entity.angle + angle) % math.tau, _DIGITS) % round(math.tau, _DIGITS)
        return replace(entity, x=x, y=y, angle=heading)
    return replace(entity, x=x, y=y)
