"""Playing to the end, also from varied starts, to measure a program in a process of its own."""

from __future__ import annotations

import asyncio
import math
import os
import random
import sys
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

from logical_robots_tui.game.advancing import play_tick, start_frame
from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.minds import mind_for
from logical_robots_tui.game.victory import measures_of, reached_goals
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.processes.helper import begin
from logical_robots_tui.processes.messages import TaskHelper, next_task, send_answer
from logical_robots_tui.progress import Measures
from logical_robots_tui.world import Beacon, Level, Robot, World
from logical_robots_tui.world.level import GoalKind, rename_in_areas

STARTS = 20
"""The number of varied starts to try."""

FARTHEST_SHIFT = 8.0
"""Largest shift of a robot along each axis, in map units."""

WIDEST_TURN = 0.2
"""Largest rotation of a robot, in radians."""

MOST_DRAWS = 100
"""How often names are drawn until goals bring others together."""


class LateError(Exception):
    """The clock cut off a thought, so the run is not reproducible and does not count."""


@dataclass(frozen=True, slots=True)
class Played:
    """The result of playing a level; the distance is map units of all robots together."""

    won_at: int | None
    distance: float
    ticks: int = 0
    is_blocked: bool = False


def start_of(level: Level, start: int) -> Level:
    """Return the level with its robots at a start: 0 is the given one, others are varied."""
    return vary_start(level, start - 1) if start else level


def named_start_of(level: Level, start: int) -> Level:
    """Return the level of `start_of` with a name of its own and no file."""
    if not start:
        return level
    name = f"{level.name}-start-{start}"
    return replace(
        start_of(level, start), name=name, title=f"{level.title}, start {start}", source=""
    )


def vary_start(level: Level, seed: int) -> Level:
    """Return the level with every robot's start shifted and rotated a little, by seed.

    Robots of the same index in their teams are shifted alike, relative to their heading. The names
    that the level shuffles change among the robots, and among the beacons; goals of several robots
    then bring others together, where that is possible.
    """
    chance = random.Random(seed)  # noqa: S311 - not for security
    bounds = (FARTHEST_SHIFT, FARTHEST_SHIFT, WIDEST_TURN)
    shifts = [[chance.uniform(-bound, bound) for bound in bounds] for _ in level.robots]
    robots = []
    for index, robot in enumerate(level.robots):
        if level.teams:
            index = sum(teammate.team == robot.team for teammate in level.robots[:index])
        x, y, turn = shifts[index]
        if level.teams:
            cos, sin = math.cos(robot.angle), math.sin(robot.angle)
            x, y = x * cos - y * sin, x * sin + y * cos
        robots.append(replace(robot, x=robot.x + x, y=robot.y + y, angle=robot.angle + turn))
    return _shuffle_names(replace(level, robots=tuple(robots)), chance)


def _shuffle_names(level: Level, chance: random.Random) -> Level:
    if not level.shuffled_names:
        return level
    groups = [set(area.victory_robots) for area in level.areas if len(area.victory_robots) > 1]
    for _ in range(MOST_DRAWS):
        robots = _new_names(level.shuffled_names, level.robots, chance)
        if not any({robots.get(name, name) for name in names} in groups for names in groups):
            break
    beacons = _new_names(level.shuffled_names, level.beacons, chance)
    return replace(
        level,
        robots=tuple(replace(r, name=robots.get(r.name, r.name)) for r in level.robots),
        beacons=tuple(replace(b, name=beacons.get(b.name, b.name)) for b in level.beacons),
        areas=rename_in_areas(level.areas, robots, beacons),
    )


def _new_names(
    patterns: Iterable[str], entities: Iterable[Robot | Beacon], chance: random.Random
) -> dict[str, str]:
    """Exchange the names that match; of more than two, each moves."""
    names = [
        name
        for name in dict.fromkeys(entity.name for entity in entities)
        if any(fnmatchcase(name, pattern) for pattern in patterns)
    ]
    order = chance.sample(names, len(names))
    return dict(zip(order, order[1:] + order[:1] if len(order) > 2 else names, strict=True))


def mirror(level: Level) -> Level:
    """Return the level mirrored left to right."""
    walls = level.walls[:, ::-1].copy()
    walls.flags.writeable = False
    width = level.width
    return replace(
        level,
        walls=walls,
        robots=tuple(replace(r, x=width - r.x, angle=math.pi - r.angle) for r in level.robots),
        beacons=tuple(replace(beacon, x=width - beacon.x) for beacon in level.beacons),
        areas=tuple(replace(area, x=width - area.x) for area in level.areas),
    )


def play_through(
    level: Level,
    program: Program,
    patience: int,
    *,
    limits: Limits | None = None,
    is_over: Callable[[Frame, Mind], bool] | None = None,
    stop: threading.Event | None = None,
) -> Played:
    """Play a level without history until won, for at most `patience` ticks. Blocks.

    `is_over` ends the run by returning True. Raises Stopped, or LateError if the clock cut off
    a thought.
    """
    world = World(level)
    mind = mind_for(program, level, limits)
    frame = start_frame(level, world)
    distance, is_blocked = 0.0, False
    try:
        while world.tick < patience and world.won_at is None:
            frame = play_tick(world, mind, frame, stop)
            if not frame.is_reliable:
                raise LateError
            distance += frame.distance
            is_blocked = is_blocked or any(robot.blocked for robot in frame.after.robots)
            if is_over is not None and is_over(frame, mind):
                break
    finally:
        mind.close()
    return Played(world.won_at, distance, world.tick, is_blocked)


def try_starts(
    level: Level,
    program: Program,
    patience: int,
    *,
    starts: int = STARTS,
    stop: threading.Event | None = None,
    report: Callable[[int, int], None] = lambda _tried, _wins: None,
) -> int:
    """Play a level from varied starts, always the same; return the number won. Blocks.

    `report` gets the numbers of tried and won starts. Raises Stopped, or LateError if the clock
    cut off a thought.
    """
    wins = 0
    for seed in range(starts):
        wins += (
            play_through(vary_start(level, seed), program, patience, stop=stop).won_at is not None
        )
        report(seed + 1, wins)
    return wins


MOST_TICKS = 20_000
"""Ticks within which every level can be won."""

PROCESSOR_SECONDS = 3600
"""The longest measuring."""

NICENESS = 10
"""How much other processes go before this one."""


class MeasuringError(Exception):
    """The process ended early, or the clock cut off a thought."""


@dataclass(frozen=True, slots=True)
class Trial:
    """How far the varied starts are; `waits_for` is the title of a level that is tried first."""

    tried: int = 0
    wins: int = 0
    of_all: int = STARTS
    waits_for: str = ""


def patience_for(ticks: int) -> int:
    """Return the tick limit for a varied start, given the ticks of the original one."""
    return min(2 * ticks + 200, 2 * MOST_TICKS)


async def measure(
    level: Level,
    program: Program,
    measures: Measures | None,
    report: Callable[[Trial], None] = lambda _trial: None,
    seconds: int = PROCESSOR_SECONDS,
    *,
    has_starts: bool = True,
) -> Measures | None:
    """Measure a program in a process; None if it does not win from the original start.

    Without `has_starts` it plays from that start only. `report` is called on the event loop after
    each varied start. Raises MeasuringError if the process ended early, after so many processor
    seconds at the latest, or the clock cut off a thought.
    """
    loop = asyncio.get_running_loop()
    helper: TaskHelper

    def report_unless_over(trial: Trial) -> None:
        if helper.returncode is None:
            report(trial)

    def exchange() -> Measures | None:
        helper.send((level, program, measures, has_starts))
        while "tried" in (answer := helper.answer()):
            trial = Trial(answer["tried"], answer["wins"])
            loop.call_soon_threadsafe(report_unless_over, trial)
        if answer["late"]:
            raise MeasuringError
        fields = answer["measures"]
        return fields and Measures(**{**fields, "goals": tuple(fields["goals"])})

    try:
        helper = TaskHelper(__name__, str(seconds))
        try:
            return await asyncio.to_thread(exchange)
        finally:
            helper.end()
    except (OSError, ValueError) as error:
        raise MeasuringError from error


def main() -> None:
    begin(int(sys.argv[2]))
    os.nice(NICENESS)
    level, program, measures, has_starts = next_task()
    try:
        final = _measure(level, program, measures, has_starts=has_starts)
        send_answer({"late": False, "measures": final and final._asdict()})
    except LateError:
        send_answer({"late": True})


def _measure(
    level: Level, program: Program, measures: Measures | None, *, has_starts: bool = True
) -> Measures | None:
    if measures is None:
        play = play_through(level, program, 2 * MOST_TICKS)
        if play.won_at is None:
            return None
        measures = measures_of(level, program, play.won_at, play.distance, play.is_blocked)
    if not has_starts:
        return measures
    patience = patience_for(measures.ticks)
    if measures.wins is None:

        def report(tried: int, wins: int) -> None:
            send_answer({"tried": tried, "wins": wins})

        wins = try_starts(level, program, patience, report=report)
        measures = measures._replace(wins=wins, starts=STARTS)
    goal_values: dict[GoalKind, int] = {"starts": measures.starts - (measures.wins or 0)}
    if any(goal.kind == "mirrored" for goal in level.second_goals):
        goal_values["mirrored"] = play_through(mirror(level), program, patience).won_at is None
    goals = dict.fromkeys((*measures.goals, *reached_goals(level, goal_values)))
    return measures._replace(goals=tuple(goals))
