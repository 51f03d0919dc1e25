"""The level format of this game: TOML with the labyrinth drawn in characters."""

from __future__ import annotations

import math
import re
import tomllib
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.shipped import did_you_mean
from logical_robots_tui.world.fields import Fields, check_robot_names
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

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

__all__ = ["read_native"]

_WALL, _FREE = "#", (".", " ")

_TOP_KEYS = (
    "title",
    "cell",
    "walls",
    "idea",
    "briefing",
    "hints",
    "lesson",
    "further",
    "starter",
    "solution",
    "visibility",
    "robots",
    "beacons",
    "areas",
)
_ROBOT_KEYS = ("name", "x", "y", "heading", "color", "battery")
_BATTERY_KEYS = ("capacity", "consumption", "charges_others")
_BEACON_KEYS = ("name", "x", "y", "charging_station")
_AREA_KEYS = (
    "name",
    "x",
    "y",
    "radius",
    "color",
    "goal_for",
    "on_beacon",
    "off_beacon",
    "sticky",
    "solid",
)


def read_native(text: str, name: str, source: str) -> Level:
    """Read a level of this game; anything that looks like a mistake is refused.

    Args:
        text: The file's text.
        name: The level's name.
        source: The file's name, for messages.

    Raises:
        LevelError: The text is no such level.
    """
    text = text.replace("\r\n", "\n")
    top = Fields(_parsed(text, source), source)
    top.refuse_unknown(_TOP_KEYS)
    title = top.name("title")
    walls = _walls(top, text)
    height, width = walls.shape
    robots = top.each("robots", _robot)
    robot_names = tuple(robot.name for robot in robots)
    check_robot_names(top, robot_names)
    for i, robot in enumerate(robots):
        if not (0 <= robot.x < width and 0 <= robot.y < height):
            raise top.error(
                f"robots[{i}]",
                f'Robot "{robot.name}" stands outside the map.',
                f"The map is {width} x {height} units.",
            )
    beacons = top.each("beacons", _beacon)
    areas = top.each("areas", _area)
    _check_areas(top, areas, robot_names, tuple(beacon.name for beacon in beacons))
    return Level(
        name=name,
        title=title,
        width=width,
        height=height,
        walls=walls,
        robots=robots,
        beacons=beacons,
        areas=areas,
        visibility=_visibility(top.table("visibility")),
        idea=top.name("idea", ""),
        briefing=top.text("briefing", "").strip("\n"),
        hints=top.texts("hints"),
        lesson=top.text("lesson", "").strip("\n"),
        further=top.text("further", "").strip("\n"),
        starter=top.name("starter", ""),
        solution=top.name("solution", ""),
        source=source,
    )


def _parsed(text: str, source: str) -> dict[str, object]:
    hint = "A level of this game is a file of TOML."
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message, at, where = str(error).rpartition(" (at ")
        place = f"{source}, {where.removesuffix(')')}" if at else source
        message = message if at else where
        message = f"This is no valid TOML: {message}."
        raise LevelError(message, place=place, hint=hint) from None
    except RecursionError:
        message = "This is no valid TOML: it is nested too deeply."
        raise LevelError(message, place=source, hint=hint) from None
    except ValueError:  # a number of thousands of digits, or a date that doesn't exist
        message = "This is no valid TOML: a number or date in it is out of bounds."
        raise LevelError(message, place=source, hint=hint) from None


def _walls(top: Fields, text: str) -> NDArray[np.bool_]:
    cell = top.whole("cell", least=1)
    drawing = top.record.get("walls")
    if not isinstance(drawing, str):
        raise top.error("walls", '"walls" must be a text that draws the map.', _drawing_hint())
    rows = drawing.removesuffix("\n").split("\n")
    columns = len(rows[0])
    if not columns:
        raise top.error("walls", "The first row of the map is empty.", _drawing_hint())
    top.check_size("walls", columns * cell, len(rows) * cell)

    first_line = _first_line(drawing, text)
    for i, row in enumerate(rows, 1):
        place = f"{top.file}, row {i} of walls"
        if first_line:
            place += f" (line {first_line + i - 1})"
        if len(row) != columns:
            message = f"This row has {len(row)} characters, the first one has {columns}."
            raise LevelError(message, place=place, hint="All rows must be of one length.")
        for column, character in enumerate(row, 1):
            if character != _WALL and character not in _FREE:
                shown = f'"{character}"' if character.isprintable() else f"U+{ord(character):04X}"
                message = f"Character {column} is {shown}, which is neither wall nor free."
                raise LevelError(message, place=place, hint=_drawing_hint())

    cells = np.array([[character == _WALL for character in row] for row in rows], dtype=np.bool_)
    walls = cells.repeat(cell, axis=0).repeat(cell, axis=1)
    walls.flags.writeable = False
    return walls


def _drawing_hint() -> str:
    return "Draw walls as # and free cells as . or space, one row per line, between ''' and '''."


def _first_line(drawing: str, text: str) -> int | None:
    """Return the line of the file in which the drawing starts, or None if it can't be told."""
    for found in re.finditer(r"^[ \t]*walls[ \t]*=[ \t]*('''|\"\"\")\n?", text, re.MULTILINE):
        if text.startswith(drawing, found.end()):
            return text.count("\n", 0, found.end()) + 1
    return None


def _robot(fields: Fields) -> Robot:
    fields.refuse_unknown(_ROBOT_KEYS)
    battery = fields.table("battery")
    battery.refuse_unknown(_BATTERY_KEYS)
    has_battery = fields.has("battery")
    return Robot(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        angle=math.radians(fields.number("heading", 0.0)),
        color=fields.color("color", ROBOT_COLOR),
        has_battery=has_battery,
        can_charge=battery.flag("charges_others"),
        battery_capacity=battery.number("capacity", least=0) if has_battery else 0.0,
        battery_consumption_rate=battery.number("consumption", 0.0, least=0),
    )


def _beacon(fields: Fields) -> Beacon:
    fields.refuse_unknown(_BEACON_KEYS)
    return Beacon(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        charging_station=fields.flag("charging_station"),
    )


def _area(fields: Fields) -> Area:
    fields.refuse_unknown(_AREA_KEYS)
    return Area(
        name=fields.name("name"),
        x=fields.number("x"),
        y=fields.number("y"),
        radius=fields.number("radius", least=0),
        color=fields.color("color", AREA_COLOR),
        victory_robots=fields.names("goal_for"),
        on_beacon=fields.name("on_beacon", ""),
        off_beacon=fields.name("off_beacon", ""),
        sticky_switch=fields.flag("sticky"),
        impenetrable=fields.flag("solid"),
    )


def _check_areas(
    top: Fields, areas: Iterable[Area], robots: tuple[str, ...], beacons: tuple[str, ...]
) -> None:
    """Refuse an area that names a robot or beacon that isn't there."""
    for i, area in enumerate(areas):
        for robot in area.victory_robots:
            if robot not in robots:
                message = f'Area "{area.name}" is a goal for "{robot}", which is no robot here.'
                raise top.error(f"areas[{i}].goal_for", message, did_you_mean(robot, robots))
        for key, beacon in (("on_beacon", area.on_beacon), ("off_beacon", area.off_beacon)):
            if beacon and beacon not in beacons:
                message = f'Area "{area.name}" is switched by "{beacon}", which is no beacon here.'
                raise top.error(f"areas[{i}].{key}", message, did_you_mean(beacon, beacons))


def _visibility(fields: Fields) -> Visibility:
    fields.refuse_unknown(("memory", "sensor"))
    return Visibility(
        memory=fields.choice("memory", ("own", "seen", "all"), "own"),
        sensor=fields.choice("sensor", ("own", "all"), "own"),
    )
