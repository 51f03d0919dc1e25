"""Writing a level file of the web platform, and what such a file can't express."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.editing.records import Record, written_number
from logical_robots_tui.world.level import Visibility

if TYPE_CHECKING:
    from logical_robots_tui.world.level import Area, Beacon, Level, Robot

__all__ = ["lost_in_web", "write_web"]

_WORDS = ("idea", "briefing", "hints", "lesson", "further", "starter", "solution")
_SEEN = Visibility(memory="all", sensor="all")


def write_web(level: Level) -> str:
    """Return the text of a web platform file; reading it gives the same labyrinth."""
    digits = np.where(level.walls, ord("1"), ord("0")).astype(np.uint8)
    record = {
        "width": level.width,
        "height": level.height,
        "robots": [_robot(robot) for robot in level.robots],
        "beacons": [_beacon(beacon) for beacon in level.beacons],
        "areas": [_area(area) for area in level.areas],
        "walls": digits.tobytes().decode("ascii"),
    }
    return json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def lost_in_web(level: Level) -> list[str]:
    """Return the attributes of a level that a web platform file can't express."""
    lost = [name for name in _WORDS if getattr(level, name)]
    if level.visibility != _SEEN:
        lost.append("visibility")
    if level.title != level.name:
        lost.insert(0, "title")
    return lost


def _robot(robot: Robot) -> Record:
    record: Record = {
        "name": robot.name,
        "x": written_number(robot.x),
        "y": written_number(robot.y),
        "angle": written_number(robot.angle),
        "color": robot.color,
    }
    numbers = (robot.battery_capacity, robot.battery_consumption_rate)
    if robot.has_battery or any(numbers):
        record["has_battery"] = robot.has_battery
        record["can_charge"] = robot.can_charge
        record["battery_capacity"] = written_number(robot.battery_capacity)
        record["battery_consumption_rate"] = written_number(robot.battery_consumption_rate)
    return record


def _beacon(beacon: Beacon) -> Record:
    return {
        "name": beacon.name,
        "x": written_number(beacon.x),
        "y": written_number(beacon.y),
        "charging_station": beacon.charging_station,
    }


def _area(area: Area) -> Record:
    return {
        "name": area.name,
        "x": written_number(area.x),
        "y": written_number(area.y),
        "radius": written_number(area.radius),
        "color": area.color,
        "victory_robots": list(area.victory_robots),
        "on_beacon": area.on_beacon,
        "off_beacon": area.off_beacon,
        "sticky_switch": area.sticky_switch,
        "impenetrable": area.impenetrable,
    }
