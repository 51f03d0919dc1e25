"""The state of a world at the end of a tick, as immutable values."""

from __future__ import annotations

from dataclasses import dataclass


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
    """A whole world at a tick's end, to continue from; tallies as of `scoring.tallied`."""

    tick: int
    robots: tuple[RobotState, ...]
    areas: tuple[AreaState, ...]
    won_at: int | None = None
    tallies: tuple[tuple[int, ...], ...] = ()
