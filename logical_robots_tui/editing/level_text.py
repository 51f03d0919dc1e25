"""Writing levels, as records or as text in either format; the inverse of `world/levels/`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from itertools import chain
from typing import Literal, TypeAlias

import numpy as np
import tomlkit

from logical_robots_tui.world.level import (
    AREA_COLOR,
    COMPARED,
    FLAGS,
    LONG_TEXTS,
    ROBOT_COLOR,
    Area,
    Beacon,
    Level,
    Robot,
    Sensors,
    Visibility,
)
from logical_robots_tui.world.levels.fields import MOST_OF_A_NUMBER
from logical_robots_tui.world.levels.native import coarsest_cell, draw_rows, oddities

Kind: TypeAlias = Literal["robots", "beacons", "areas"]

KINDS: tuple[Kind, ...] = ("robots", "beacons", "areas")

Entity = Robot | Beacon | Area
"""An object in a labyrinth."""

Record = dict[str, object]
"""Keys and values of a TOML table, in the order in which they are written."""


def all_entities(level: Level) -> Iterator[Entity]:
    return chain(level.robots, level.beacons, level.areas)


def kind_of(entity: Entity) -> Kind:
    return next(
        kind for kind, cls in zip(KINDS, (Robot, Beacon, Area), strict=True) if type(entity) is cls
    )


def record_of(entity: Entity) -> Record:
    """Return the record of a robot, beacon or area, without default values."""
    record: Record = {"name": entity.name, "x": _plain(entity.x), "y": _plain(entity.y)}
    if isinstance(entity, Beacon):
        return record | _compact({"charging_station": entity.charging_station})
    if isinstance(entity, Area):
        fields = {
            "radius": entity.radius,
            "color": "" if entity.color == AREA_COLOR else entity.color,
            "solid": entity.impenetrable,
            "goal_for": entity.victory_robots,
            "on_beacon": entity.on_beacon,
            "off_beacon": entity.off_beacon,
            "sticky": entity.sticky_switch,
            "cycle": entity.cycle and entity.cycle._asdict(),
        }
        return record | _compact(fields, "radius")
    power, rate = entity.battery_capacity, entity.battery_consumption_rate
    values = {"capacity": power, "consumption": rate, "charges_others": entity.can_charge}
    battery = _compact(values, "capacity")
    if not entity.has_battery:
        battery["used"] = False
    fields = {
        "color": "" if entity.color == ROBOT_COLOR else entity.color,
        "battery": {} if battery == {"capacity": 0, "used": False} else battery,
        "team": entity.team,
    }
    return record | _heading(entity.angle) | _compact(fields)


def words_of(level: Level) -> Record:
    """Return what a file says of a level beside the labyrinth and its objects."""
    record = {
        **{name: getattr(level, name) for name in ("title", "idea", "starter", "solution")},
        "visibility": {} if level.visibility == Visibility() else asdict(level.visibility),
        "shared_names": level.shared_names,
        "second_goals": [goal.words for goal in level.second_goals],
        **{name: getattr(level, name) for name in ("briefing", "hints", "lesson")},
        **{name: getattr(level, name) for name in ("further", "story")},
        "questions": [_compact(question._asdict()) for question in level.questions],
        **{name: getattr(level, name) for name in (*FLAGS, "shuffled_names")},
        "match": {"ticks": level.match_ticks} if level.match_ticks else {},
        "teams": [_compact(asdict(team)) for team in level.teams],
        "scores": [_compact(asdict(score), "points") for score in level.scores],
        "sensors": {
            key: value
            for key, value in asdict(level.sensors).items()
            if value != getattr(Sensors(), key)
        },
    }
    return _compact(record, "title")


def _compact(record: Mapping[str, object], *required: str) -> Record:
    """Return a record without empty fields, except some; whole numbers as integers."""
    return {key: _plain(value) for key, value in record.items() if value or key in required}


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return list(value)
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _heading(angle: float) -> Record:
    """Return a heading in degrees if they are exact, otherwise in radians."""
    if angle == 0:
        return {}
    degrees = math.degrees(angle)
    for digits in range(15):
        written = round(degrees, digits)
        if abs(written) <= MOST_OF_A_NUMBER and math.radians(written) == angle:
            return {"heading": _plain(written)}
    return {"angle": angle}


def write_native(level: Level) -> str:
    """Return the text of a level's file; reading it gives the same level."""
    lines = [f"{key} = {toml_text(key, value)}" for key, value in words_of(level).items()]
    if needs_leniency(level):
        lines.insert(1, "lenient = true")
    cell = coarsest_cell(level.walls)
    drawing = "\n".join(draw_rows(level.walls, cell))
    lines += ["", f"cell = {cell}", f"walls = '''\n{drawing}\n'''"]
    blocks = [block_text(kind_of(entity), record_of(entity)) for entity in all_entities(level)]
    return "\n".join([*lines, "", "\n".join(blocks)])


def block_text(kind: Kind, record: Record) -> str:
    lines = [f"{key} = {toml_text(key, value)}" for key, value in record.items()]
    return "\n".join([f"[[{kind}]]", *lines, ""])


def needs_leniency(level: Level) -> bool:
    return next(oddities(level), None) is not None


def toml_text(key: str, value: object) -> str:
    if key in LONG_TEXTS:
        # The line break after the opening quotes is not part of the text.
        return '"""\n' + tomlkit.string(f"{value}\n", multiline=True).as_string()[3:]
    if isinstance(value, dict):
        inner = ", ".join(f"{name} = {toml_text(name, part)}" for name, part in value.items())
        return f"{{{inner}}}"
    if key == "questions" and isinstance(value, list):
        lines = "".join(f"  {toml_text('', record)},\n" for record in value)
        return f"[\n{lines}]"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return f"[{', '.join(toml_text('', record) for record in value)}]"
    if key == "hints" and isinstance(value, list):
        lines = "".join(f"  {tomlkit.item(hint).as_string()},\n" for hint in value)
        return f"[\n{lines}]"
    return tomlkit.item(value).as_string()


_IN_WEB = ("title", "width", "height", *KINDS, "visibility", "sensors")
_NOT_IN_WEB = ("team", "cycle")
_SEEN = Visibility(memory="all", sensor="all")


def write_web(level: Level) -> str:
    """Return the text of a web platform file; reading it gives the same labyrinth."""
    digits = np.where(level.walls, ord("1"), ord("0")).astype(np.uint8)
    record = {
        "width": level.width,
        "height": level.height,
        "robots": [_record(robot) for robot in level.robots],
        "beacons": [_record(beacon) for beacon in level.beacons],
        "areas": [_record(area) for area in level.areas],
        "walls": digits.tobytes().decode("ascii"),
    }
    return json.dumps(record, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def lost_in_web(level: Level) -> list[str]:
    lost = [name for name in COMPARED if name not in _IN_WEB and getattr(level, name)]
    if level.visibility != _SEEN:
        lost.append("visibility")
    if level.sensors != Sensors():
        lost.append("sensors")
    if any(area.cycle for area in level.areas):
        lost.append("cycle")
    if level.title != level.name:
        lost.insert(0, "title")
    return lost


def _record(entity: Entity) -> Record:
    """Return an object's record in a web platform file, without empty optional fields."""
    record = {name: value for name, value in asdict(entity).items() if name not in _NOT_IN_WEB}
    return _compact(record, "name", "x", "y", "radius", "color", "victory_robots")
