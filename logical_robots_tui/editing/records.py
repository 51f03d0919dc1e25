"""Converting levels to the records of a level file; the inverse of reading them."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING

from logical_robots_tui.world.level import (
    AREA_COLOR,
    ROBOT_COLOR,
    Area,
    Beacon,
    Robot,
    Score,
    Team,
    Visibility,
)
from logical_robots_tui.world.levels.limits import MOST_OF_A_NUMBER

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.world.level import Level

__all__ = ["Record", "Thing", "all_things", "record_of", "words_of", "written_number"]

Thing = Robot | Beacon | Area
"""An object in a labyrinth."""

Record = dict[str, object]
"""Keys and values of a TOML table, in the order in which they are written."""


def all_things(level: Level) -> Iterator[Thing]:
    """Yield all objects in a labyrinth."""
    yield from level.robots
    yield from level.beacons
    yield from level.areas


def record_of(thing: Thing) -> Record:
    """Return the record of a robot, beacon or area, without default values."""
    if isinstance(thing, Robot):
        return _robot(thing)
    if isinstance(thing, Beacon):
        return _beacon(thing)
    return _area(thing)


def words_of(level: Level) -> Record:
    """Return the record of what a level says besides the labyrinth and the objects in it."""
    record: Record = {
        "title": level.title,
        "idea": level.idea,
        "starter": level.starter,
        "solution": level.solution,
        "visibility": {"memory": level.visibility.memory, "sensor": level.visibility.sensor},
        "shared_names": list(level.shared_names),
        "second_goals": [goal.words for goal in level.second_goals],
        "briefing": level.briefing,
        "hints": list(level.hints),
        "lesson": level.lesson,
        "further": level.further,
        "divided_charge": level.divided_charge,
        "match": {"ticks": level.match_ticks} if level.match_ticks else {},
        "teams": [_told(team) for team in level.teams],
        "scores": [_told(score) for score in level.scores],
    }
    if level.visibility == Visibility():
        del record["visibility"]
    return {key: value for key, value in record.items() if value or key == "title"}


def _told(part: Team | Score) -> Record:
    """Return the attributes that say something."""
    record = {name: value for name, value in asdict(part).items() if value != ""}
    if isinstance(part, Score):
        record["points"] = written_number(part.points)
    return record


def _robot(robot: Robot) -> Record:
    record: Record = {
        "name": robot.name,
        "x": written_number(robot.x),
        "y": written_number(robot.y),
    }
    record |= _heading(robot.angle)
    if robot.color != ROBOT_COLOR:
        record["color"] = robot.color
    battery: Record = {"capacity": written_number(robot.battery_capacity)}
    if robot.battery_consumption_rate:
        battery["consumption"] = written_number(robot.battery_consumption_rate)
    if robot.can_charge:
        battery["charges_others"] = True
    if not robot.has_battery:
        battery["used"] = False
    if battery != {"capacity": 0, "used": False}:
        record["battery"] = battery
    if robot.team:
        record["team"] = robot.team
    return record


def _beacon(beacon: Beacon) -> Record:
    record: Record = {
        "name": beacon.name,
        "x": written_number(beacon.x),
        "y": written_number(beacon.y),
    }
    if beacon.charging_station:
        record["charging_station"] = True
    return record


def _area(area: Area) -> Record:
    record: Record = {
        "name": area.name,
        "x": written_number(area.x),
        "y": written_number(area.y),
        "radius": written_number(area.radius),
        "color": area.color,
        "solid": area.impenetrable,
        "goal_for": list(area.victory_robots),
        "on_beacon": area.on_beacon,
        "off_beacon": area.off_beacon,
        "sticky": area.sticky_switch,
    }
    if area.color == AREA_COLOR:
        del record["color"]
    needed = ("name", "x", "y", "radius")
    return {key: value for key, value in record.items() if value or key in needed}


def written_number(value: float) -> float | int:
    """Return a number in its simplest form."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _heading(angle: float) -> Record:
    """Return a heading in degrees if they are exact, otherwise in radians."""
    if angle == 0:
        return {}
    degrees = math.degrees(angle)
    for digits in range(15):
        written = round(degrees, digits)
        if abs(written) <= MOST_OF_A_NUMBER and math.radians(written) == angle:
            return {"heading": written_number(written)}
    return {"angle": angle}
