"""Charging and draining batteries."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.world.driving import Mover
from logical_robots_tui.world.level import Beacon

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from logical_robots_tui.world.level import Level, Robot

__all__ = ["CHARGING_RADIUS", "CHARGING_RATE", "charging_sources", "is_dead", "run_battery"]

CHARGING_RADIUS = 50
"""Map units within which a source charges."""

CHARGING_RATE = 2
"""Charge that one source gives, and a robot that is a source loses, per tick and receiver."""

Source: TypeAlias = Beacon | Mover


def charging_sources(level: Level, movers: Sequence[Mover]) -> list[Source]:
    """Return the sources that charge in this tick: stations, then robots with charge to give.

    The list is valid for the whole tick, even if a robot on it runs dry in the meantime.

    Args:
        level: The level.
        movers: Its robots in file order, before any of them moved.
    """
    stations = [beacon for beacon in level.beacons if beacon.charging_station]
    givers = [
        mover
        for robot, mover in zip(level.robots, movers, strict=True)
        if robot.has_battery and robot.can_charge and mover.battery_level > 0
    ]
    return [*stations, *givers]


def run_battery(
    robot: Robot, mover: Mover, left: float, right: float, sources: Iterable[Source]
) -> None:
    """Charge one robot from the sources around it; without any, let it pay for its engines.

    Robots that give charge are drained in place.

    Args:
        robot: The robot; without a battery nothing happens.
        mover: The same robot in this tick, changed in place.
        left: Wanted power of the left engine, finite and not clamped.
        right: Wanted power of the right engine, finite and not clamped.
        sources: From ``charging_sources`` in this tick.
    """
    if not robot.has_battery:
        return
    charged = False
    if mover.battery_level < robot.battery_capacity:
        for source in sources:
            if source is mover:
                continue
            if math.hypot(source.x - mover.x, source.y - mover.y) >= CHARGING_RADIUS:
                continue
            mover.battery_level = min(robot.battery_capacity, mover.battery_level + CHARGING_RATE)
            charged = True
            if isinstance(source, Mover):
                source.battery_level = max(0.0, source.battery_level - CHARGING_RATE)
    if not charged and mover.battery_level > 0:
        # Halved before the sum, so that no pair of finite engines overflows to 0 * inf.
        cost = robot.battery_consumption_rate * (abs(left) / 2 + abs(right) / 2)
        mover.battery_level = max(0.0, mover.battery_level - cost)


def is_dead(robot: Robot, mover: Mover) -> bool:
    """Return whether an empty battery stops a robot; a robot without consumption drives on."""
    return robot.has_battery and mover.battery_level <= 0 and robot.battery_consumption_rate > 0
