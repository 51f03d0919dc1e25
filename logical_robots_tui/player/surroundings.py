"""What is around a robot, in words: by direction from its heading, and distance."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from logical_robots_tui.schema import NO_OBJECT, WALL
from logical_robots_tui.wording import join_names
from logical_robots_tui.world import Level, WorldState
from logical_robots_tui.world.dynamics import AreaState
from logical_robots_tui.world.level import Area, Sensors
from logical_robots_tui.world.sensing import Senses

_STEP = 30  # degrees between two looks at walls
_RADAR = 120  # degrees that the radar covers
_MOST = 24  # things that are named


def surroundings(level: Level, state: WorldState, robot_name: str) -> Iterator[str]:
    """Yield what is ahead and around, then beacons, robots and areas, the nearest first.

    Walls are as far as the forward ray would tell in that direction; what no radar would see from
    there is said to be out of sight. Names are not escaped.
    """
    index = next(i for i, robot in enumerate(state.robots) if robot.name == robot_name)
    me, reach, visible = state.robots[index], level.sensors.reach, set()
    senses = Senses(replace(level, sensors=Sensors(reach=reach)))
    walls = []
    for turn in sorted(range(_STEP - 180, 181, _STEP), key=lambda turn: (abs(turn), -turn)):
        robots = list(state.robots)
        robots[index] = replace(me, angle=me.angle - math.radians(turn))
        sensor = senses.sense(robots, state.areas, state.tick)[0][index]["sensor"]
        kind, label = sensor["forward_object"], sensor["forward_label"]
        name = label if kind == WALL or label == NO_OBJECT else f"{kind} {label}"
        if kind == NO_OBJECT:
            walls.append(f"{_direction(turn)}: nothing within {reach}")
        else:
            walls.append(f"{_direction(turn)}: {name} at {sensor['forward_distance']}")
        if turn % _RADAR == 0:
            visible |= {(ray["object"], ray["label"]) for ray in sensor["radar"]}
    yield "; ".join(walls) + "."
    entities = [
        *(("beacon", beacon.name, beacon.x, beacon.y, "") for beacon in level.beacons),
        *(("robot", robot.name, robot.x, robot.y, "") for robot in state.robots if robot is not me),
        *(
            ("area", area.name, area.x, area.y, _area_text(area, state))
            for area, state in zip(level.areas, state.areas, strict=True)
        ),
    ]
    lines = []
    for kind, name, x, y, note in entities:
        distance = math.hypot(x - me.x, y - me.y)
        bearing = math.degrees(me.angle - math.atan2(y - me.y, x - me.x))
        if kind != "area" and (kind, name) not in visible:
            note = ", out of sight"
        lines.append((distance, f"{_direction(bearing)}: {kind} {name} at {distance:.0f}{note}."))
    lines.sort()
    yield from (words for _, words in lines[:_MOST])
    if (remaining := len(lines) - _MOST) > 0:
        yield f"{remaining} more are farther away."


def _direction(degrees: float) -> str:
    """Return a bearing in words; left is positive."""
    around = (round(degrees) + 180) % 360 - 180
    if around in (0, -180):
        return "behind" if around else "ahead"
    return f"{abs(around)}° {'left' if around > 0 else 'right'}"


def _area_text(area: Area, state: AreaState) -> str:
    words = f", radius {area.radius:.0f}"
    if area.victory_robots:
        words += f", goal of {join_names(area.victory_robots)}"
    if area.impenetrable:
        words += ", solid"
    if area.cycle:
        words += f", on in {area.cycle.words}"
    if not state.active:
        words += ", switched off"
    return words
