"""The level format of the Logical Robots web platform: one JSON object."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.world.level import (
    AREA_COLOR,
    ROBOT_COLOR,
    Area,
    Beacon,
    Level,
    LevelError,
    Robot,
    Visibility,
)
from logical_robots_tui.world.levels.fields import (
    LONGEST_NAME,
    Fields,
    check_robot_names,
    excess_of_json,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WALL = ord("1")


def read_web(text: str, name: str, source: str) -> Level:
    """Read a level of the web platform, as leniently as that where it makes sense.

    Visibility is ``all`` for both, as there. Robots may be outside the map, and areas may name
    unknown robots and beacons. Raises LevelError.
    """
    top = Fields(_parse(text, source), source)
    width, height = top.whole("width", least=1), top.whole("height", least=1)
    top.check_size("width", width, height)
    walls = _walls(top, width, height)
    robots = top.each("robots", _robot)
    check_robot_names(top, tuple(robot.name for robot in robots))
    return Level(
        name=name,
        title=_title(name),
        width=width,
        height=height,
        walls=walls,
        robots=robots,
        beacons=top.each("beacons", _beacon),
        areas=top.each("areas", _area),
        visibility=Visibility(memory="all", sensor="all"),
        source=source,
    )


def _parse(text: str, source: str) -> dict[str, object]:
    hint = "A level of the web platform is a JSON file."
    if found := excess_of_json(text):
        raise LevelError(f"The file has {found}.", place=source, hint=hint)
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        place = f"{source}, line {error.lineno}, column {error.colno}"
        raise LevelError(f"This is not valid JSON: {error.msg}.", place=place, hint=hint) from None
    except RecursionError:
        message = "This is not valid JSON: it is nested too deeply."
        raise LevelError(message, place=source, hint=hint) from None
    except ValueError:  # a number with thousands of digits
        message = "This is not valid JSON: a number in it is too long."
        raise LevelError(message, place=source, hint=hint) from None
    if not isinstance(value, dict):
        raise LevelError("The file must hold one JSON object.", place=source, hint=hint)
    return value


def _title(name: str) -> str:
    return "".join(c for c in name if c.isprintable())[:LONGEST_NAME].strip() or "Level"


def _walls(top: Fields, width: int, height: int) -> NDArray[np.bool_]:
    digits = top.record.get("walls")
    if not isinstance(digits, str):
        message = '"walls" must be text with one digit per cell, row after row.'
        raise top.error("walls", message, "1 is a wall, anything else is free.")
    size = width * height
    cells = np.frombuffer(digits[:size].encode("ascii", "replace"), dtype=np.uint8) == _WALL
    walls = np.zeros(size, dtype=np.bool_)
    walls[: len(cells)] = cells
    walls.flags.writeable = False
    return walls.reshape(height, width)


def _robot(fields: Fields) -> Robot:
    has_battery = fields.flag("has_battery")
    can_charge = fields.flag("can_charge")
    return Robot(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        angle=fields.number("angle", 0.0),
        color=_color(fields, ROBOT_COLOR),
        has_battery=has_battery,
        can_charge=has_battery and can_charge,
        battery_capacity=fields.number("battery_capacity", 0.0, least=0),
        battery_consumption_rate=fields.number("battery_consumption_rate", 0.0, least=0),
    )


def _beacon(fields: Fields) -> Beacon:
    station = fields.record.get("charging_station")
    return Beacon(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        # The platform compares loosely: true, 1 and "1" count.
        charging_station=station == 1 or (isinstance(station, str) and station.strip() == "1"),
    )


def _area(fields: Fields) -> Area:
    sticky = fields.record.get("sticky_switch")
    return Area(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        radius=fields.number("radius", least=0),
        color=_color(fields, AREA_COLOR),
        victory_robots=fields.names("victory_robots"),
        on_beacon=_switch(fields, "on_beacon"),
        off_beacon=_switch(fields, "off_beacon"),
        # As in JavaScript: lists and objects are true even when empty.
        sticky_switch=bool(sticky) or isinstance(sticky, (list, dict)),
        impenetrable=fields.record.get("impenetrable") is True,
    )


def _switch(fields: Fields, key: str) -> str:
    return fields.name(key, "") if fields.record.get(key) else ""


def _color(fields: Fields, default: str) -> str:
    try:
        return fields.color("color", default)
    except LevelError:
        return default
