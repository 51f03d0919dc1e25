"""The rules of a tick: driving, batteries, areas, and what the teams of a match score."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from itertools import product
from operator import attrgetter
from typing import TypeAlias

from logical_robots_tui.values import SensorRow
from logical_robots_tui.world.level import Area, Beacon, Level, Robot, Score


@dataclass(frozen=True, slots=True)
class RobotState:
    """One robot at the end of a tick, in map units from the top left.

    `angle` is in radians, clockwise as seen on the screen, in [0, 2π) after the first tick;
    engines are in [-1, 1]. `battery_level` is meaningless without a battery.
    """

    name: str
    x: float
    y: float
    angle: float
    battery_level: float
    left_engine: float = 0.0
    right_engine: float = 0.0
    blocked: bool = False
    dead: bool = False


@dataclass(frozen=True, slots=True)
class AreaState:
    name: str
    active: bool
    visitors: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WorldState:
    """A whole world at a tick's end, to continue from; tallies as of `tally_tick`."""

    tick: int
    robots: tuple[RobotState, ...]
    areas: tuple[AreaState, ...]
    won_at: int | None = None
    tallies: tuple[tuple[int, ...], ...] = ()


WHEEL_BASE = 20
"""Map units between the wheels; engines that differ by 1 turn a robot by 1/20 radian a tick."""

PUSH_MARGIN = 0.1
"""Map units from the edge of a solid area to where it pushes a robot."""


@dataclass(slots=True, eq=False)
class Mover:
    """A robot during a tick; the fields are those of ``RobotState``."""

    x: float
    y: float
    angle: float
    battery_level: float
    left_engine: float = 0.0
    right_engine: float = 0.0
    blocked: bool = False
    dead: bool = False


body_of = attrgetter(*Mover.__slots__)
"""Returns the values of those fields, of a ``Mover`` or a ``RobotState``."""

ROBOT_WIDTH = 18
"""Map units between the centres of two robots that touch, where robots block each other."""


def drive(
    mover: Mover, left: float, right: float, level: Level, bodies: Iterable[RobotState] = ()
) -> None:
    """Turn and move a robot, in place, for one tick.

    The turn always succeeds. The move is cancelled if it ends in a wall, or closer to another body
    than before and closer than robots are wide. There are no walls outside the labyrinth. Engine
    powers are finite.
    """
    left, right = min(1.0, max(-1.0, left)), min(1.0, max(-1.0, right))
    angle = math.fmod(mover.angle + (left - right) / WHEEL_BASE + 2 * math.pi, 2 * math.pi)
    speed = (left + right) / 2
    x = mover.x + speed * math.cos(angle)
    y = mover.y + speed * math.sin(angle)
    mover.left_engine, mover.right_engine, mover.angle = left, right, angle
    column, row = math.floor(x), math.floor(y)
    is_on_map = 0 <= column < level.width and 0 <= row < level.height
    is_in_wall = is_on_map and level.walls[row, column]
    if is_in_wall or any(
        (distance := math.hypot(x - body.x, y - body.y)) < ROBOT_WIDTH
        and distance < math.hypot(mover.x - body.x, mover.y - body.y)
        for body in bodies
    ):
        mover.blocked = speed != 0
    else:
        mover.x, mover.y = x, y


def push_out(mover: Mover, areas: Iterable[Area]) -> None:
    """Move a robot, in place, out of solid active areas in file order; ignores walls."""
    for area in areas:
        dx, dy = mover.x - area.x, mover.y - area.y
        distance = math.hypot(dx, dy)
        if distance >= area.radius:
            continue
        if distance < 1:
            dx, dy, distance = 1.0, 0.0, 1.0
        mover.x = area.x + dx / distance * (area.radius + PUSH_MARGIN)
        mover.y = area.y + dy / distance * (area.radius + PUSH_MARGIN)


def push_out_at_once(mover: Mover, areas: Iterable[Area]) -> None:
    """Move a robot, in place, by the sum of the pushes of all solid active areas around it.

    The order of the areas makes no difference; ignores walls.
    """
    pushing_areas = [area for area in areas if is_inside(mover, area)]
    x, y = mover.x, mover.y
    pushes = []
    for area in pushing_areas:
        mover.x, mover.y = x, y
        push_out(mover, [area])
        pushes.append((mover.x - x, mover.y - y))
    if len(pushing_areas) > 1:
        mover.x, mover.y = x + math.fsum(p[0] for p in pushes), y + math.fsum(p[1] for p in pushes)


def is_inside(mover: Mover | RobotState, area: Area) -> bool:
    """Return whether a robot's centre is strictly inside an area."""
    return math.hypot(mover.x - area.x, mover.y - area.y) < area.radius


CHARGING_RADIUS = 50
"""Map units within which a source charges."""

CHARGING_RATE = 2
"""Charge that one source gives, and a robot that is a source loses, per tick and receiver."""

Source: TypeAlias = Beacon | Mover


def charging_sources(level: Level, movers: Sequence[Mover]) -> list[Source]:
    """Return this tick's sources, before any move: stations, then robots with charge to give."""
    stations = [beacon for beacon in level.beacons if beacon.charging_station]
    pairs = zip(level.robots, movers, strict=True)
    chargers = (mover for robot, mover in pairs if robot.has_battery and robot.can_charge)
    return [*stations, *(mover for mover in chargers if mover.battery_level > 0)]


def run_battery(
    robot: Robot, mover: Mover, left: float, right: float, sources: Iterable[Source]
) -> None:
    """Charge one robot from sources around it, or let it pay for its engines.

    Sources that are robots are drained in place. Engine powers are finite and not clamped.
    """
    if not robot.has_battery:
        return
    is_charged = False
    if mover.battery_level < robot.battery_capacity:
        for source in sources:
            if source is mover:
                continue
            if math.hypot(source.x - mover.x, source.y - mover.y) >= CHARGING_RADIUS:
                continue
            mover.battery_level = min(robot.battery_capacity, mover.battery_level + CHARGING_RATE)
            is_charged = True
            if isinstance(source, Mover):
                source.battery_level = max(0.0, source.battery_level - CHARGING_RATE)
    if not is_charged and mover.battery_level > 0:
        mover.battery_level = max(0.0, mover.battery_level - _cost(robot, left, right))


def run_batteries(
    robots: Sequence[Robot],
    movers: Sequence[Mover],
    engines: Sequence[tuple[float, float]],
    sources: Sequence[Source],
) -> None:
    """Charge all robots before they move; each source divides what it gives.

    The order makes no difference. A share that a battery has no room for is lost. A robot that
    no source charges pays for its engines, whose powers are finite and not clamped.
    """
    shares: list[list[float]] = [[] for _ in movers]
    losses: dict[int, float] = {}
    candidates = [
        (i, mover, mover.x, mover.y)
        for i, (robot, mover) in enumerate(zip(robots, movers, strict=True))
        if robot.has_battery and mover.battery_level < robot.battery_capacity
    ]
    for source in sources:
        x, y = source.x, source.y
        receivers = [
            i
            for i, mover, its_x, its_y in candidates
            if abs(its_x - x) < CHARGING_RADIUS
            and math.hypot(its_x - x, its_y - y) < CHARGING_RADIUS
            and mover is not source
        ]
        charge = float(CHARGING_RATE)
        if isinstance(source, Mover) and receivers:
            charge = losses[id(source)] = min(charge, source.battery_level)
        for i in receivers:
            shares[i].append(charge / len(receivers))
    for robot, mover, (left, right), charges in zip(robots, movers, engines, shares, strict=True):
        if not robot.has_battery:
            continue
        cost = 0.0 if charges else _cost(robot, left, right)
        level = mover.battery_level + math.fsum(charges) - losses.get(id(mover), 0.0) - cost
        mover.battery_level = max(0.0, min(robot.battery_capacity, level))


def _cost(robot: Robot, left: float, right: float) -> float:
    # Halved before the sum, so that no pair of finite engines overflows to 0 * inf.
    return robot.battery_consumption_rate * (abs(left) / 2 + abs(right) / 2)


def next_active(area: Area, active: bool, visible_beacons: AbstractSet[str], tick: int) -> bool:
    """Return whether an area is on after this tick; the beacons are those on any radar."""
    if area.off_beacon and area.off_beacon in visible_beacons:
        return False
    if area.on_beacon and area.on_beacon in visible_beacons:
        return True
    if area.sticky_switch and (area.on_beacon or area.off_beacon):
        return active
    return area.is_on(tick)


def is_won(areas: Iterable[tuple[Area, AreaState]], all_goals: bool = False) -> bool:
    """Return whether an active goal, or each, contains all the robots that it requires."""
    goal_states = [
        state.active and set(area.victory_robots) <= set(state.visitors)
        for area, state in areas
        if area.victory_robots
    ]
    return bool(goal_states) and (all if all_goals else any)(goal_states)


_PER_UNIT = 1000
"""A tally of distance counts thousandths of map units."""


def points(level: Level, state: WorldState) -> dict[str, tuple[float, ...]]:
    """Return each team's points for each part of the score; constant after the match."""
    farthest = _PER_UNIT * math.hypot(level.width, level.height)
    worth: dict[str, Callable[[int], float]] = {
        "first": lambda tick: min(tick, 1),
        "beacons": int.bit_count,
        "near": lambda distance: max(0.0, 1 - distance / farthest),
    }
    parts = [
        [score.points * worth.get(score.kind, int)(tally) for tally in tallies]
        for score, tallies in zip(level.scores, state.tallies, strict=True)
    ]
    return {team.name: tuple(part[i] for part in parts) for i, team in enumerate(level.teams)}


def start_tallies(
    level: Level, robots: Sequence[RobotState], areas: Sequence[AreaState]
) -> tuple[tuple[int, ...], ...]:
    zeros = ((0,) * len(level.teams),) * len(level.scores)
    return tally_tick(level, zeros, 0, robots, areas, ())


def tally_tick(
    level: Level,
    previous: Sequence[tuple[int, ...]],
    tick: int,
    robots: Sequence[RobotState],
    areas: Sequence[AreaState],
    rows: Sequence[SensorRow],
) -> tuple[tuple[int, ...], ...]:
    """Return the tallies after a tick of a match, for each part of the score and each team.

    A tally is, by kind: ``hold`` and ``most`` the ticks, for each area of the name; ``first``
    the tick of arrival, or 0; ``near`` the nearest robot's distance to the nearest of these
    areas, in thousandths of a map unit; ``beacons`` a bit for each name; ``charged`` the robots
    that can drive on. Inactive areas count for nothing. Rows are what robots sensed in the
    tick.
    """
    if tick > level.match_ticks or not previous:
        return tuple(previous)
    teams = {team.name: i for i, team in enumerate(level.teams)}
    team_of = {robot.name: teams[robot.team] for robot in level.robots}
    members = [[r for r in robots if team_of[r.name] == i] for i in teams.values()]
    active = [pair for pair in zip(level.areas, areas, strict=True) if pair[1].active]

    def tally(score: Score, previous: tuple[int, ...]) -> tuple[int, ...]:
        scored = [pair for pair in active if pair[0].name == score.area]
        if score.kind == "beacons":
            return _beacon_masks(level, previous, team_of, rows)
        if score.kind == "charged":
            return tuple(sum(not robot.dead for robot in team) for team in members)
        if score.kind == "near":
            farthest = math.hypot(level.width, level.height)
            return tuple(
                _distance(team, [area for area, _ in scored], farthest) for team in members
            )
        if tick == 0 or (score.kind == "first" and any(previous)):
            return previous
        visitors = [[team_of[name] for name in state.visitors] for _, state in scored]
        counts = [[names.count(team) for team in teams.values()] for names in visitors]
        if score.kind == "first":
            return tuple(tick * any(row[i] for row in counts) for i in teams.values())
        # The leader has an area alone, or more robots there than any other team.
        return tuple(
            total
            + sum(
                row[i] > max([0, *row[:i], *row[i + 1 :]])
                and (score.kind == "most" or row[i] == sum(row))
                for row in counts
            )
            for i, total in enumerate(previous)
        )

    return tuple(map(tally, level.scores, previous))


def _beacon_masks(
    level: Level, masks: Sequence[int], team_of: Mapping[str, int], rows: Sequence[SensorRow]
) -> tuple[int, ...]:
    """Return a bit for each name of a beacon that a team has seen, also in these rows."""
    names = dict.fromkeys(beacon.name for beacon in level.beacons)
    bits = {name: 1 << i for i, name in enumerate(names)}
    masks = list(masks)
    for row in rows:
        for ray in row["sensor"]["radar"]:
            if ray["object"] == "beacon":
                masks[team_of[row["robot_name"]]] |= bits[ray["label"]]
    return tuple(masks)


def _distance(robots: Sequence[RobotState], areas: Sequence[Area], farthest: float) -> int:
    gaps = [math.hypot(r.x - a.x, r.y - a.y) - a.radius for r, a in product(robots, areas)]
    return round(max(0.0, min(gaps, default=farthest)) * _PER_UNIT)
