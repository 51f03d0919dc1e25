"""The state of a world at the end of a tick, as immutable values."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RobotState:
    """One robot at the end of a tick.

    Attributes:
        name: The robot's name.
        x: Map units from the left edge.
        y: Map units from the top edge.
        angle: Heading in radians, clockwise as seen on the screen; in [0, 2π) after the first tick.
        battery_level: Charge left; meaningless without a battery.
        left_engine: Power of the left engine in this tick, in [-1, 1].
        right_engine: Power of the right engine in this tick, in [-1, 1].
        blocked: Whether a wall stopped its move in this tick.
        dead: Whether its battery was empty in this tick.
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
    """One area at the end of a tick."""

    name: str
    active: bool
    visitors: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WorldState:
    """A whole world at the end of a tick: everything needed to continue from there.

    Attributes:
        tick: Number of the last finished tick; 0 is the start.
        robots: In file order.
        areas: In file order.
        won_at: The tick of victory, or None.
        tallies: For each part of the score what each team has so far, see `scoring.tallied`; ()
            where nothing is scored.
    """

    tick: int
    robots: tuple[RobotState, ...]
    areas: tuple[AreaState, ...]
    won_at: int | None = None
    tallies: tuple[tuple[int, ...], ...] = ()
