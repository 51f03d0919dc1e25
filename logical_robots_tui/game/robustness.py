"""Playing a level to the end from its start and from slightly shifted starts."""

from __future__ import annotations

import math
import random
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace

from logical_robots_tui.game.advancing import play_tick, start_frame
from logical_robots_tui.game.frame import Frame, driven
from logical_robots_tui.game.minds import mind_for
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.world import Level, World

STARTS = 20
"""The number of shifted starts to try."""

FARTHEST_SHIFT = 8.0
"""Largest shift of a robot along each axis, in map units."""

WIDEST_TURN = 0.2
"""Largest rotation of a robot, in radians."""


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
    """Return the level with its robots at a start: 0 is the given one, others are shifted."""
    return shift_start(level, start - 1) if start else level


def named_start_of(level: Level, start: int) -> Level:
    """Do the same as `start_of`, but give the level its own name and no file."""
    if not start:
        return level
    name = f"{level.name}-start-{start}"
    return replace(
        start_of(level, start), name=name, title=f"{level.title}, start {start}", source=""
    )


def shift_start(level: Level, seed: int) -> Level:
    """Return the level with every robot's start shifted and rotated a little, by seed.

    Robots of the same index in their teams are shifted alike, relative to their heading.
    """
    chance = random.Random(seed)  # noqa: S311 - not for security
    most = (FARTHEST_SHIFT, FARTHEST_SHIFT, WIDEST_TURN)
    shifts = [[chance.uniform(-each, each) for each in most] for _ in level.robots]
    robots = []
    for place, robot in enumerate(level.robots):
        if level.teams:
            place = sum(earlier.team == robot.team for earlier in level.robots[:place])
        x, y, turn = shifts[place]
        if level.teams:
            cos, sin = math.cos(robot.angle), math.sin(robot.angle)
            x, y = x * cos - y * sin, x * sin + y * cos
        robots.append(replace(robot, x=robot.x + x, y=robot.y + y, angle=robot.angle + turn))
    return replace(level, robots=tuple(robots))


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
            distance += driven(frame.before, frame.after)
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
    """Play a level from shifted starts, always the same; return the number won. Blocks.

    `report` gets the numbers of tried and won starts. Raises Stopped, or LateError if the clock
    cut off a thought.
    """
    wins = 0
    for seed in range(starts):
        wins += (
            play_through(shift_start(level, seed), program, patience, stop=stop).won_at is not None
        )
        report(seed + 1, wins)
    return wins
