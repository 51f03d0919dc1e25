"""Scoring: what the teams of a match have achieved, counted along the run."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence

from logical_robots_tui.values import SensorRow
from logical_robots_tui.world.dynamics import AreaState, RobotState, WorldState
from logical_robots_tui.world.level import Area, Level, Score

_PER_UNIT = 1000
"""A tally of distance counts thousandths of map units."""


def points(level: Level, state: WorldState) -> dict[str, tuple[float, ...]]:
    """Return each team's points for each part of the score; constant after the match."""
    parts = [
        [score.points * _worth(level, score, tally) for tally in tallies]
        for score, tallies in zip(level.scores, state.tallies, strict=True)
    ]
    return {team.name: tuple(part[i] for part in parts) for i, team in enumerate(level.teams)}


def _worth(level: Level, score: Score, tally: int) -> float:
    if score.kind == "first":
        return min(tally, 1)
    if score.kind == "beacons":
        return tally.bit_count()
    if score.kind == "near":
        return max(0.0, 1 - tally / _PER_UNIT / math.hypot(level.width, level.height))
    return tally


def tallies_at_start(
    level: Level, robots: Sequence[RobotState], areas: Sequence[AreaState]
) -> tuple[tuple[int, ...], ...]:
    nothing = ((0,) * len(level.teams),) * len(level.scores)
    return tally_tick(level, nothing, 0, robots, areas, ())


def tally_tick(
    level: Level,
    before: Sequence[tuple[int, ...]],
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
    if tick > level.match_ticks or not before:
        return tuple(before)
    moment = _Moment(level, tick, robots, areas, rows)
    return tuple(
        moment.tally(score, tallies) for score, tallies in zip(level.scores, before, strict=True)
    )


class _Moment:
    """The state at the end of a tick, as scoring needs it."""

    def __init__(
        self,
        level: Level,
        tick: int,
        robots: Sequence[RobotState],
        areas: Sequence[AreaState],
        rows: Sequence[SensorRow],
    ) -> None:
        self._level, self._tick, self._rows = level, tick, rows
        self._areas: dict[str, list[tuple[Area, AreaState]]] = defaultdict(list)
        for area, state in zip(level.areas, areas, strict=True):
            if state.active:
                self._areas[area.name].append((area, state))
        teams = {team.name: i for i, team in enumerate(level.teams)}
        self._team = {robot.name: teams[robot.team] for robot in level.robots}
        self._robots: list[list[RobotState]] = [[] for _ in teams]
        for robot in robots:
            self._robots[self._team[robot.name]].append(robot)

    def tally(self, score: Score, before: tuple[int, ...]) -> tuple[int, ...]:
        areas = self._areas[score.area]
        if score.kind == "beacons":
            return self._beacons(before)
        if score.kind == "charged":
            return tuple(sum(not robot.dead for robot in mine) for mine in self._robots)
        if score.kind == "near":
            return tuple(self._distance(mine, [area for area, _ in areas]) for mine in self._robots)
        if self._tick == 0 or (score.kind == "first" and any(before)):
            return before
        counts = [self._count(state) for _, state in areas]
        if score.kind == "first":
            inside = [any(each) for each in zip(*counts, strict=True)] or [False] * len(before)
            return tuple(self._tick * is_in for is_in in inside)
        leading = [_leads(count, alone=score.kind == "hold") for count in counts]
        return tuple(map(sum, zip(before, *leading, strict=True)))

    def _count(self, state: AreaState) -> list[int]:
        found = [self._team[name] for name in state.visitors]
        return [found.count(team) for team in range(len(self._robots))]

    def _beacons(self, before: tuple[int, ...]) -> tuple[int, ...]:
        names = list(dict.fromkeys(beacon.name for beacon in self._level.beacons))
        bits = {name: 1 << i for i, name in enumerate(names)}
        seen = list(before)
        for row in self._rows:
            team = self._team[row["robot_name"]]
            for ray in row["sensor"]["radar"]:
                if ray["object"] == "beacon":
                    seen[team] |= bits[ray["label"]]
        return tuple(seen)

    def _distance(self, robots: Sequence[RobotState], areas: Sequence[Area]) -> int:
        ways = [
            math.hypot(robot.x - area.x, robot.y - area.y) - area.radius
            for robot in robots
            for area in areas
        ]
        farthest = math.hypot(self._level.width, self._level.height)
        return round(max(0.0, min(ways, default=farthest)) * _PER_UNIT)


def _leads(count: Sequence[int], *, alone: bool) -> list[bool]:
    """Return which team has an area: alone, or with more robots than any other."""
    return [
        mine > max([0, *count[:i], *count[i + 1 :]]) and (not alone or mine == sum(count))
        for i, mine in enumerate(count)
    ]
