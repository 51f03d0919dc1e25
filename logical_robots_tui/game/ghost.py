"""Ghosts: another run of the same level, to race against."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.errors import InputError
from logical_robots_tui.wording import count_of
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.world import start_state

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.world import Level, WorldState


BEST, REPLAY = "best run", "replay"
"""What a ghost may be."""


@dataclass(frozen=True, eq=False)
class Ghost:
    """Where the robots of another run of a level were.

    Attributes:
        level: The level as it was.
        name: What the run is, `BEST` or `REPLAY`.
        poses: x and y in map units and heading in radians after each tick from 0 on, of shape
            (ticks, robots, 3), robots in file order.
        arrivals: By the area's number, the tick in which it was first reached, if it was.
    """

    level: Level
    name: str
    poses: NDArray[np.float32]
    arrivals: Mapping[int, int]

    @property
    def last(self) -> int:
        return len(self.poses) - 1

    @property
    def run(self) -> str:
        """The run in words: ``your best run`` or ``the replay``."""
        return f"{'your' if self.name == BEST else 'the'} {self.name}"

    def poses_at(self, tick: int) -> NDArray[np.float32]:
        """Return the poses after a tick; after the run's end, those at the end."""
        poses: NDArray[np.float32] = self.poses[min(tick, self.last)]
        return poses

    def comparison(self, area: int, tick: int) -> str:
        """Say how reaching an area in a tick compares with this run."""
        arrival = self.arrivals.get(area)
        if arrival is None:
            return f"which {self.run} never did"
        if arrival == tick:
            return f"in the same tick as {self.run}"
        side = "before" if tick < arrival else "after"
        return f"{count_of(abs(tick - arrival), 'tick')} {side} {self.run}"


def ghost_of(replay: Replay, level: Level, name: str) -> Ghost:
    """Compute all of a replay, which needs no program; raise InputError if it is not a fair race.

    It must be of the level as given, from its start, without changes by hand.
    """
    if not alike(replay.levels[0], level):
        raise InputError("It was recorded in another level, or this level has changed since.")
    if len(replay.stages) > 1 or replay.stages[0].state != start_state(level):
        raise InputError("It was changed by hand, or does not begin at the start of the level.")
    poses = np.empty((replay.last + 1, len(level.robots), 3), np.float32)
    arrivals: dict[int, int] = {}
    for tick, state in enumerate(replay.states()):
        poses[tick] = [(robot.x, robot.y, robot.angle) for robot in state.robots]
        for area, _ in reached_areas(level, state):
            arrivals.setdefault(area, tick)
    return Ghost(level, name, poses, arrivals)


def reached_areas(level: Level, state: WorldState) -> Iterator[tuple[int, str]]:
    """Yield the areas, by number, that are on and hold a robot they are for, and that robot."""
    for number, (area, area_state) in enumerate(zip(level.areas, state.areas, strict=True)):
        names = area.victory_robots or area_state.visitors
        name = next((name for name in area_state.visitors if name in names), None)
        if area_state.active and name is not None:
            yield number, name
