"""Loading levels of either format, by path or name."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.confinement import check_mine
from logical_robots_tui.paths import (
    ARENAS,
    did_you_mean,
    read_ordinary,
    shipped_folder,
    shipped_names,
)
from logical_robots_tui.toml_files import too_many
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
    MOST_BYTES,
    Fields,
    check_robot_names,
)
from logical_robots_tui.world.levels.native import read_native

if TYPE_CHECKING:
    from numpy.typing import NDArray


_WALL = ord("1")
_MOST_OF_JSON = {"{": 30_000, "[": 60_000, ",": 300_000, '"': 600_000}
_LONG_NUMBER = re.compile(r"[:\[,]\s*+-?\d{10000}")


def read_web(text: str, name: str, source: str) -> Level:
    """Read a level of the web platform, about as leniently as the platform does.

    Visibility is ``all`` for both, as there. Robots may be outside, and areas may name
    unknown robots and beacons. Raises LevelError.
    """
    top = Fields(_parse(text, source), source)
    if top.has("sensors"):
        hint = "Convert the level first: logical-robots level convert level.json level.toml"
        raise top.error("sensors", "A level of the web platform can't say sensors.", hint)
    width, height = top.integer("width", minimum=1), top.integer("height", minimum=1)
    top.check_size("width", width, height)
    walls = _walls(top, width, height)
    robots = top.records("robots", _robot)
    check_robot_names(top, tuple(robot.name for robot in robots))
    return Level(
        name=name,
        title="".join(c for c in name if c.isprintable())[:LONGEST_NAME].strip() or "Level",
        width=width,
        height=height,
        walls=walls,
        robots=robots,
        beacons=top.records("beacons", _beacon),
        areas=top.records("areas", _area),
        visibility=Visibility(memory="all", sensor="all"),
        source=source,
    )


def _parse(text: str, source: str) -> dict[str, object]:
    hint, place = "A level of the web platform is a JSON file.", source
    if excess := too_many(text, _MOST_OF_JSON):
        raise LevelError(f"The file has {excess}.", place=source, hint=hint)
    if _LONG_NUMBER.search(text):
        message = "The file has a number of more than 10,000 digits."
        raise LevelError(message, place=source, hint=hint)
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        place = f"{source}, line {error.lineno}, column {error.colno}"
        message = f"This is not valid JSON: {error.msg}."
    except RecursionError:
        message = "This is not valid JSON: it is nested too deeply."
    except ValueError:  # a number with thousands of digits
        message = "This is not valid JSON: a number in it is too long."
    else:
        if isinstance(value, dict):
            return value
        message = "The file must hold one JSON object."
    raise LevelError(message, place=place, hint=hint)


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
        *fields.name_and_position(),
        angle=fields.number("angle", 0.0),
        color=_color(fields, ROBOT_COLOR),
        has_battery=has_battery,
        can_charge=has_battery and can_charge,
        battery_capacity=fields.number("battery_capacity", 0.0, minimum=0),
        battery_consumption_rate=fields.number("battery_consumption_rate", 0.0, minimum=0),
    )


def _beacon(fields: Fields) -> Beacon:
    station = fields.record.get("charging_station")
    # The platform compares loosely: true, 1 and "1" count.
    is_one = station == 1 or (isinstance(station, str) and station.strip() == "1")
    return Beacon(*fields.name_and_position(), is_one)


def _area(fields: Fields) -> Area:
    sticky = fields.record.get("sticky_switch")
    return Area(
        *fields.name_and_position(),
        radius=fields.number("radius", minimum=0),
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


NATIVE, WEB = SUFFIXES = (".toml", ".json")
"""The file name endings of this game and of the web platform."""

_FORMATS = "A level is a .toml file of this game or a .json file of the web platform."


def list_levels() -> list[str]:
    """Return the names of the shipped levels except the arenas, sorted by file name."""
    return sorted({name for suffix in SUFFIXES for name in shipped_names("levels", suffix)})


def list_shipped() -> list[str]:
    """Return the names of all shipped levels, the arenas last."""
    return [*list_levels(), *list_arenas()]


def list_arenas() -> list[str]:
    """Return the names of the shipped levels for matches of teams, sorted by file name."""
    return shipped_names("levels", NATIVE, ARENAS)


def load_level(path_or_name: str | Path) -> Level:
    """Read a level, or raise LevelError, whose ``place`` names the file and the line or key.

    A path is that of a ``.toml`` level of this game or a ``.json`` level of the web platform; the
    format of any other file is guessed from its first character. Text without a folder and an
    ending is the name or number of a shipped level, or the name of a labyrinth of the day.
    """
    path = Path(path_or_name)
    is_name = isinstance(path_or_name, str) and not set(path_or_name) & {"/", "\\"}
    if is_name and not path.suffix and path_or_name not in {".", ".."}:
        name = str(path_or_name)
        if name.startswith("daily-"):
            from logical_robots_tui.world.levels.labyrinths import Daily

            if (daily := Daily.parse(name)) is not None:
                return daily.level(str(shipped_folder("levels") / f"{name}{NATIVE}"))
        path = _shipped_path(name)
    text = read_text(path)
    is_web = is_web_file(path) or (path.suffix.lower() != NATIVE and is_of_web(text))
    return (read_web if is_web else read_native)(text.removeprefix("\ufeff"), path.stem, str(path))


def read_level(text: str, name: str) -> Level:
    """Return the level of a text, whose first character tells the format, or raise LevelError."""
    return (read_web if is_of_web(text) else read_native)(text.removeprefix("\ufeff"), name, name)


def is_of_web(text: str) -> bool:
    """Return whether a text is a level in the web platform's format."""
    return text.removeprefix("\ufeff").lstrip().startswith("{")


def is_web_file(path: str | Path) -> bool:
    """Return whether a file's ending is that of the web platform's levels."""
    return Path(path).suffix.lower() == WEB


def current_name(name: str) -> str | None:
    """Return the name of a shipped level, or None.

    The number may be missing, come from an earlier version, or stand alone.
    """
    names = list_shipped()
    if re.fullmatch("[0-9]{1,2}", name):
        return next((n for n in names if n.startswith(f"{int(name):02}-")), None)
    if name in names:
        return name
    bare = _without_number(name)
    return next((n for n in names if _without_number(n) == bare), None)


def _without_number(name: str) -> str:
    return re.sub(r"\A[0-9]{2}-", "", name)


def _shipped_path(name: str) -> Path:
    folder, level_name = shipped_folder("levels"), current_name(name)
    for path in (
        *(folder / f"{level_name}{suffix}" for suffix in SUFFIXES),
        folder / ARENAS / f"{level_name}{NATIVE}",
    ):
        if level_name is not None and path.is_file():
            return path
    hint = did_you_mean(name, list_shipped()) or "A path needs its ending, such as maze.toml."
    raise LevelError(f'There is no level called "{name}".', hint=hint)


def read_text(path: Path) -> str:
    """Return a level file's text, exact to line ends and byte order mark, or raise LevelError."""
    try:
        check_mine(path)
        if path.is_dir():
            raise LevelError("This is a folder, not a level.", place=str(path), hint=_FORMATS)
        if path.exists() and not path.is_file():
            raise LevelError("This is not a regular file.", place=str(path), hint=_FORMATS)
        if not path.exists():
            siblings = path.parent.iterdir() if path.parent.is_dir() else ()
            hint = did_you_mean(path.name, [p.name for p in siblings if p.suffix in SUFFIXES])
            raise LevelError("There is no such file.", place=str(path), hint=hint)
        content = read_ordinary(path, MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise LevelError(f"The file can't be read: {reason}.", place=str(path)) from None
    if len(content) > MOST_BYTES:
        message = f"The file is larger than {MOST_BYTES // 2**20} MB."
        raise LevelError(message, place=str(path), hint=_FORMATS)
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        place = f"{path}, line {line}"
        raise LevelError("This file is not UTF-8 text.", place=place, hint=_FORMATS) from None
