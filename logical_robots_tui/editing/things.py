"""Robots, beacons and areas: adding, changing and removing them, and where they stand by now."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np

from logical_robots_tui.editing.level_text import (
    KINDS,
    Kind,
    Thing,
    all_things,
    kind_of,
    record_of,
    words_of,
)
from logical_robots_tui.world import WorldState
from logical_robots_tui.world.level import (
    COMPARED,
    Beacon,
    Level,
    LevelError,
    Robot,
    rename_in_areas,
)
from logical_robots_tui.world.levels.fields import (
    LONGEST_NAME,
    MOST_OF_A_KIND,
    MOST_OF_A_NUMBER,
    Fields,
    check_robot_names,
)
from logical_robots_tui.world.levels.native import read_area, read_beacon, read_robot, read_words
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS
from logical_robots_tui.world.world import Pose


def set_words(level: Level, **values: Any) -> Level:
    """Set texts, visibility or shared names, named as in ``Level``, or raise LevelError."""
    for name in values:
        if name not in COMPARED or name in ("width", "height", *KINDS):
            raise LevelError(f"A level has no property {name}.")
    words = read_words(Fields(words_of(replace(level, **values)), level.name))
    changed = replace(level, **words)
    return level if words_of(changed) == words_of(level) else changed


def resize(
    level: Level, width: int, height: int, *, left: int = 0, top: int = 0, wall: bool = False
) -> Level:
    """Resize a level, in map units; its objects move along.

    `left` and `top` are inserted before the first column and row, negative values cut; `wall`
    fills new space. Raises LevelError if the size is out of range or an object too far from the
    map.
    """
    sizes = Fields({"width": width, "height": height}, level.name)
    width, height = sizes.whole("width", minimum=1), sizes.whole("height", minimum=1)
    sizes.check_size("width", width, height)
    if (width, height, left, top) == (level.width, level.height, 0, 0):
        return level
    for some in all_things(level):
        if max(abs(some.x + left), abs(some.y + top)) > MOST_OF_A_NUMBER:
            raise LevelError(f'"{some.name}" would be too far outside the labyrinth.')
    walls = np.full((height, width), wall, np.bool_)
    new_rows, old_rows = _overlap(height, level.height, top)
    new_columns, old_columns = _overlap(width, level.width, left)
    walls[new_rows, new_columns] = level.walls[old_rows, old_columns]
    walls.flags.writeable = False
    moved: dict[str, Any] = {
        kind: tuple(replace(one, x=one.x + left, y=one.y + top) for one in getattr(level, kind))
        for kind in KINDS
    }
    return replace(level, width=width, height=height, walls=walls, **moved)


def _overlap(new: int, old: int, shift: int) -> tuple[slice, slice]:
    first, last = max(shift, 0), min(old + shift, new)
    last = max(last, first)
    return slice(first, last), slice(first - shift, last - shift)


_SMALLER = ROBOT_RADIUS - BEACON_RADIUS  # handicap of beacons in map units when picking an object
_READ: dict[Kind, Callable[[Fields], Thing]] = {
    "robots": read_robot,
    "beacons": read_beacon,
    "areas": read_area,
}


@dataclass(frozen=True, slots=True, order=True)
class Ref:
    kind: Kind
    index: int


def thing(level: Level, ref: Ref) -> Thing:
    """Return a robot, beacon or area; raises IndexError."""
    return _list(level, ref.kind)[ref.index]


def add(level: Level, new: Thing) -> tuple[Level, Ref]:
    """Add an object, last of its kind; return level and reference, or raise LevelError.

    A number is appended to a robot's name if it is taken. Where there are teams, a robot
    without one joins the first.
    """
    kind = kind_of(new)
    things = _list(level, kind)
    if len(things) >= MOST_OF_A_KIND:
        raise LevelError(f"There are {MOST_OF_A_KIND} {kind} already, the most allowed.")
    if isinstance(new, Robot):
        taken = {robot.name for robot in level.robots}
        name = next(name for name in _numbered(new.name) if name not in taken)
        new = replace(new, name=name)
        if level.teams and not new.team:
            new = replace(new, team=level.teams[0].name)
    ref = Ref(kind, len(things))
    return _with(level, kind, (*things, _validate(level, ref, new))), ref


def change(level: Level, ref: Ref, **values: Any) -> Level:
    """Set attributes of an object, and update references to its name, or raise LevelError.

    For beacons and areas, only renaming the last one of a name updates references.
    """
    before = thing(level, ref)
    known = {field.name for field in fields(before)}
    for name in values:
        if name not in known:
            raise LevelError(f"{ref.kind.capitalize()} have no {name}.")
    after = _validate(level, ref, replace(before, **values))
    if after == before:
        return level
    things = list(_list(level, ref.kind))
    things[ref.index] = after
    changed = _with(level, ref.kind, tuple(things))
    return _follow(changed, before, after) if after.name != before.name else changed


def duplicate(level: Level, ref: Ref, dx: float, dy: float) -> tuple[Level, Ref]:
    """Add a copy of an object, shifted by map units, or raise LevelError."""
    original = thing(level, ref)
    return add(level, replace(original, x=original.x + dx, y=original.y + dy))


def remove(level: Level, ref: Ref) -> Level:
    """Remove an object, but not references to its name; raises LevelError for the last robot."""
    thing(level, ref)
    if ref.kind == "robots" and len(level.robots) == 1:
        raise LevelError("A level needs at least one robot.")
    things = _list(level, ref.kind)
    return _with(level, ref.kind, (*things[: ref.index], *things[ref.index + 1 :]))


def ref_at(level: Level, x: float, y: float, reach: float = 0.0) -> Ref | None:
    """Return the nearest robot or beacon within `reach` map units, or else the smallest area."""

    def away(some: Thing) -> float:
        return math.hypot(x - some.x, y - some.y)

    near = [
        *((away(r), Ref("robots", i)) for i, r in enumerate(level.robots)),
        *((away(b) + _SMALLER, Ref("beacons", i)) for i, b in enumerate(level.beacons)),
    ]
    bodies = [found for found in near if found[0] < ROBOT_RADIUS + reach]
    if bodies:
        return min(bodies)[1]
    around = [(area.radius, i) for i, area in enumerate(level.areas) if away(area) < area.radius]
    return Ref("areas", min(around)[1]) if around else None


def _list(level: Level, kind: Kind) -> tuple[Thing, ...]:
    things: tuple[Thing, ...] = getattr(level, kind)
    return things


def _with(level: Level, kind: Kind, things: tuple[Thing, ...]) -> Level:
    return replace(level, **cast("dict[str, Any]", {kind: things}))


def reread(level: Level, ref: Ref, some: Thing) -> Thing:
    """Return an object as it will be when it is loaded again, or raise LevelError."""
    place = Fields(record_of(some), level.name, f"{ref.kind}[{ref.index}]")
    return _READ[ref.kind](place)


def _validate(level: Level, ref: Ref, some: Thing) -> Thing:
    found = reread(level, ref, some)
    if ref.kind == "robots":
        names = [robot.name for robot in level.robots]
        names[ref.index : ref.index + 1] = [found.name]
        if names.count(found.name) > 1:
            check_robot_names(Fields({}, level.name), tuple(names))
    return found


def _follow(level: Level, before: Thing, after: Thing) -> Level:
    """Rename an object in the areas and scores of a level that refer to it."""
    areas, scores, names = level.areas, level.scores, {before.name: after.name}
    if isinstance(before, Robot):
        areas = rename_in_areas(areas, names, {})
    elif before.name in [each.name for each in _list(level, kind_of(before))]:
        return level
    elif isinstance(before, Beacon):
        areas = rename_in_areas(areas, {}, names)
    else:
        scores = tuple(replace(score, area=names.get(score.area, score.area)) for score in scores)
    return replace(level, areas=areas, scores=scores)


def _numbered(name: str) -> Iterator[str]:
    yield name
    found = re.fullmatch(r"(.+?)( ?)\d{1,4}", name, re.DOTALL)
    stem, gap = (found[1], found[2]) if found else (name, " ")
    for number in range(2, MOST_OF_A_KIND + 3):
        ending = f"{gap}{number}"
        yield stem[: LONGEST_NAME - len(ending)] + ending


def as_it_stands(level: Level, state: WorldState) -> Level:
    if state.tick == 0:
        return level
    bodies = {body.name: body for body in state.robots}
    pairs = ((robot, bodies.get(robot.name, robot)) for robot in level.robots)
    robots = (replace(robot, x=now.x, y=now.y, angle=now.angle) for robot, now in pairs)
    return replace(level, robots=tuple(robots))


class Poses:
    """Where robots are put when the level changes while they run.

    Undo moves a robot back to its place at the moment of the change, not to its start.
    """

    def __init__(self) -> None:
        self._stood: dict[tuple[str, Pose], Pose] = {}

    def note(self, robot: Robot, now: Robot) -> None:
        """Remember a robot's place, in the level and `now`, before it is moved."""
        self._stood[robot.name, _pose(robot)] = _pose(now)

    def between(self, before: Level, after: Level) -> dict[str, Pose]:
        known = {robot.name: _pose(robot) for robot in before.robots}
        poses = [(robot.name, _pose(robot)) for robot in after.robots if robot.name in known]
        return {name: self._stood.get((name, at), at) for name, at in poses if known[name] != at}


def _pose(robot: Robot) -> Pose:
    return robot.x, robot.y, robot.angle
