"""Environments in which robots learn: steps a second, without a mind and beside a program."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.measure import Effort, Measurement, at_least, best_of, processor_seconds_for
from benchmarks.subjects import drive
from logical_robots_tui import World, load_level
from logical_robots_tui.rl import RobotsEnv

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["learning"]

FIRST, HOME = "01-first-steps", "04-everybody-home"
STEPS = 2_000


def learning(effort: Effort) -> Iterator[Measurement]:
    """Measure steps a second of a processor; the world alone is the limit."""
    world = World(load_level(FIRST))
    first = RobotsEnv(FIRST, ticks=10 * STEPS)
    shaped = RobotsEnv(FIRST, ticks=10 * STEPS, reward="shaped")
    mixed = RobotsEnv(HOME, ["Ruby"], "everybody-home", ticks=10 * STEPS)
    for subject, steps, target in (
        ("the world alone", partial(drive, world, STEPS), None),
        ("level 1", partial(_steps, first), at_least(20_000)),
        ("level 1, shaped", partial(_steps, shaped), None),
        ("one of three learns, two have a program", partial(_steps, mixed), None),
    ):
        once = partial(_pace, steps)
        yield best_of(
            "steps a second", subject, "/s", effort.repeats, once, target=target, best=max
        )
    mixed.close()


def _pace(steps: partial[None]) -> float:
    return STEPS / processor_seconds_for(steps)


def _steps(env: RobotsEnv) -> None:
    env.reset(seed=1)
    action = np.array([1, 0.9], np.float32)
    for _ in range(STEPS):
        env.step(dict.fromkeys(env.possible_agents, action))
        if not env.agents:
            env.reset()
