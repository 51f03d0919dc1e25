"""Playing a level to its end from the given start and from starts that differ a little."""

from __future__ import annotations

import random
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from logical_robots_tui.game.odometer import driven
from logical_robots_tui.mind import Mind
from logical_robots_tui.world import World

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable

    from logical_robots_tui.mind import Program
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level

__all__ = ["STARTS", "LateError", "Played", "play_through", "shifted", "try_starts"]

STARTS = 20
"""From how many shifted starts a program is tried."""

FARTHEST_SHIFT = 8.0
"""Map units by which a robot may be moved, along each axis."""

WIDEST_TURN = 0.2
"""Radians by which a robot may be turned."""


class LateError(Exception):
    """A clock ended a thought: another run might go otherwise, so this one counts for nothing."""


@dataclass(frozen=True, slots=True)
class Played:
    """How a level was played.

    Attributes:
        won_at: The tick of victory, or None.
        distance: Map units driven by all robots together.
    """

    won_at: int | None
    distance: float


def shifted(level: Level, seed: int) -> Level:
    """The level with every robot's start moved and turned a little; same seed, same starts."""
    chance = random.Random(seed)  # noqa: S311 - nobody's secret
    robots = tuple(
        replace(
            robot,
            x=robot.x + chance.uniform(-FARTHEST_SHIFT, FARTHEST_SHIFT),
            y=robot.y + chance.uniform(-FARTHEST_SHIFT, FARTHEST_SHIFT),
            angle=robot.angle + chance.uniform(-WIDEST_TURN, WIDEST_TURN),
        )
        for robot in level.robots
    )
    return replace(level, robots=robots)


def play_through(
    level: Level, program: Program, patience: int, *, stop: threading.Event | None = None
) -> Played:
    """Play a level until it is won, without a history. Blocks.

    Args:
        level: Where.
        program: What the robots think.
        patience: Ticks after which it counts as not won.
        stop: Set it from another thread to give up.

    Raises:
        Stopped: `stop` was set.
        LateError: A clock ended a thought.
    """
    world = World(level)
    visibility = level.visibility
    mind = Mind(program, memory=visibility.memory, sensor=visibility.sensor, frozen=True)
    memories: dict[str, Value] = {robot.name: "" for robot in level.robots}
    distance = 0.0
    try:
        before = world.save()
        while world.tick < patience and world.won_at is None:
            decisions = mind.think(world.sense(), memories, stop=stop)
            if not all(decision.is_reliable for decision in decisions):
                raise LateError
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
            before, after = world.save(), before
            distance += driven(after, before)
    finally:
        mind.close()
    return Played(world.won_at, distance)


def try_starts(
    level: Level,
    program: Program,
    patience: int,
    *,
    starts: int = STARTS,
    stop: threading.Event | None = None,
    report: Callable[[int, int], None] = lambda _tried, _wins: None,
) -> int:
    """Play a level from shifted starts. Blocks.

    Args:
        level: Where.
        program: What the robots think.
        patience: Ticks after which a start counts as not won.
        starts: How many; the first ones are always the same.
        stop: Set it from another thread to give up.
        report: Called after each with how many were tried and won.

    Returns:
        From how many it is won.

    Raises:
        Stopped: `stop` was set.
        LateError: A clock ended a thought.
    """
    wins = 0
    for seed in range(starts):
        wins += play_through(shifted(level, seed), program, patience, stop=stop).won_at is not None
        report(seed + 1, wins)
    return wins
