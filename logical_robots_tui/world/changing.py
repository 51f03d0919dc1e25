"""Changing the level of a running world: which state is kept, and which is reset."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

from logical_robots_tui.world.dynamics import (
    AreaState,
    RobotState,
    WorldState,
    is_inside,
    starts_active,
)
from logical_robots_tui.world.level import Area, Level, Robot
from logical_robots_tui.world.scoring import tallies_at_start

Pose: TypeAlias = tuple[float, float, float]
"""Position in map units (x, y), and heading in radians."""


def start_state(level: Level) -> WorldState:
    robots = tuple(_at_start(robot) for robot in level.robots)
    areas = tuple(AreaState(area.name, starts_active(area)) for area in level.areas)
    return WorldState(0, robots, areas, tallies=tallies_at_start(level, robots, areas))


def change_state(
    state: WorldState, before: Level, after: Level, poses: Mapping[str, Pose]
) -> WorldState:
    """Return the state in which a world continues in a changed level, or raise ValueError.

    Robots keep position and charge; new ones are at their start, as are all at tick 0. Areas
    keep their state unless their switch changed, teams theirs unless the scoring did; visitors
    are recomputed. The poses are by the robots' names in the new level.
    """
    if strangers := poses.keys() - {robot.name for robot in after.robots}:
        raise ValueError(f"There are no robots {sorted(strangers)}.")
    if state.tick == 0:
        start = start_state(after)
        return replace(start, robots=tuple(_put(robot, poses) for robot in start.robots))
    given = {robot.name: robot for robot in before.robots}
    bodies = {robot.name: robot for robot in state.robots}
    former = former_names(before, after)
    robots = tuple(
        _put(_carry(robot, given[old], bodies[old]), poses)
        if (old := former.get(robot.name)) is not None
        else _put(_at_start(robot), poses)
        for robot in after.robots
    )
    areas = tuple(
        AreaState(area.name, active, _visitors(area, robots))
        for area, active in zip(after.areas, _switch_as_before(state, before, after), strict=True)
    )
    if _score_key(before) == _score_key(after):
        tallies = state.tallies
    else:
        tallies = tallies_at_start(after, robots, areas)
    return WorldState(state.tick, robots, areas, state.won_at, tallies)


def former_names(before: Level, after: Level) -> dict[str, str]:
    """Return old names of robots; a single new one in a missing one's place is renamed."""
    old, new = [r.name for r in before.robots], [r.name for r in after.robots]
    names = {name: name for name in new if name in set(old)}
    if len(old) == len(new):
        pairs = [(then, now) for then, now in zip(old, new, strict=True) if then != now]
        if len(pairs) == 1 and pairs[0][0] not in names:
            names[pairs[0][1]] = pairs[0][0]
    return names


def _carry(robot: Robot, before: Robot, body: RobotState) -> RobotState:
    charge = min(body.battery_level, float(robot.battery_capacity))
    if robot.has_battery and not before.has_battery:
        charge = float(robot.battery_capacity)
    return replace(body, name=robot.name, battery_level=charge)


def _put(body: RobotState, poses: Mapping[str, Pose]) -> RobotState:
    if body.name not in poses:
        return body
    x, y, angle = poses[body.name]
    return replace(body, x=float(x), y=float(y), angle=float(angle) % (2 * math.pi))


def _at_start(robot: Robot) -> RobotState:
    capacity = float(robot.battery_capacity)
    return RobotState(robot.name, float(robot.x), float(robot.y), float(robot.angle), capacity)


def _switch_as_before(state: WorldState, before: Level, after: Level) -> list[bool]:
    """Return which areas are on: as before if they are the same areas, else as at the start."""
    known: dict[tuple[object, ...], list[bool]] = {}
    for area, now in zip(before.areas, state.areas, strict=True):
        known.setdefault(_switch(area), []).append(now.active)
    found = []
    for area in after.areas:
        left = known.get(_switch(area))
        found.append(left.pop(0) if left else starts_active(area))
    return found


def _switch(area: Area) -> tuple[object, ...]:
    return area.name, area.on_beacon, area.off_beacon, area.sticky_switch


def _score_key(level: Level) -> tuple[object, ...]:
    return level.scores, level.teams, [beacon.name for beacon in level.beacons]


def _visitors(area: Area, robots: Sequence[RobotState]) -> tuple[str, ...]:
    return tuple(robot.name for robot in robots if is_inside(robot, area))
