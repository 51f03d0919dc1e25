"""Writing a whole level file, native or in the web format, laid out as if by hand."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
import tomlkit

from logical_robots_tui.editing.records import Record, Thing, record_of, words_of, written_number
from logical_robots_tui.editing.things import KINDS, Kind
from logical_robots_tui.world.level import Robot, Visibility
from logical_robots_tui.world.levels.drawing import coarsest_cell, draw_rows
from logical_robots_tui.world.levels.native import oddities

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.world.level import Level

__all__ = ["block_text", "lost_in_web", "needs_leniency", "toml_text", "write_native", "write_web"]

_LONG_TEXTS = ("briefing", "lesson", "further")


def write_native(level: Level) -> str:
    """Return the text of a level's file; reading it gives the same level."""
    lines = [f"{key} = {toml_text(key, value)}" for key, value in words_of(level).items()]
    if needs_leniency(level):
        lines.insert(1, "lenient = true")
    cell = coarsest_cell(level.walls)
    drawing = "\n".join(draw_rows(level.walls, cell))
    lines += ["", f"cell = {cell}", f"walls = '''\n{drawing}\n'''"]
    return "\n".join([*lines, "", "\n".join(_blocks(level))])


def _blocks(level: Level) -> Iterator[str]:
    for kind in KINDS:
        for some in getattr(level, kind):
            yield block_text(kind, record_of(some))


def block_text(kind: Kind, record: Record) -> str:
    """Return the lines of one robot, beacon or area."""
    lines = [f"{key} = {toml_text(key, value)}" for key, value in record.items()]
    return "\n".join([f"[[{kind}]]", *lines, ""])


def needs_leniency(level: Level) -> bool:
    """Return whether a level can be read only with ``lenient = true``."""
    return next(oddities(level), None) is not None


def toml_text(key: str, value: object) -> str:
    """Return a value as written after a key."""
    if key in _LONG_TEXTS:
        # The line break after the opening quotes is not part of the text.
        return '"""\n' + tomlkit.string(f"{value}\n", multiline=True).as_string()[3:]
    if isinstance(value, dict):
        inner = ", ".join(f"{name} = {toml_text(name, part)}" for name, part in value.items())
        return f"{{{inner}}}"
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return f"[{', '.join(toml_text('', record) for record in value)}]"
    if key == "hints" and isinstance(value, list):
        lines = "".join(f"  {tomlkit.item(hint).as_string()},\n" for hint in value)
        return f"[\n{lines}]"
    return tomlkit.item(value).as_string()


_WORDS = (
    *("idea", "briefing", "hints", "lesson", "further", "starter", "solution", "shared_names"),
    *("second_goals", "teams", "match_ticks", "scores", "divided_charge"),
)
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
    """Return the attributes of a level that a web platform file can't express."""
    lost = [name for name in _WORDS if getattr(level, name)]
    if level.visibility != _SEEN:
        lost.append("visibility")
    if level.title != level.name:
        lost.insert(0, "title")
    return lost


def _record(thing: Thing) -> Record:
    """Return the record of a thing, whose keys are the names of its attributes."""
    record: Record = {name: written_number(value) for name, value in asdict(thing).items()}
    record.pop("team", None)
    if isinstance(thing, Robot) and not (
        thing.has_battery or thing.battery_capacity or thing.battery_consumption_rate
    ):
        return {name: record[name] for name in ("name", "x", "y", "angle", "color")}
    return record
