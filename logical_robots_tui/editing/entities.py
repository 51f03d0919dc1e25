"""Robots, beacons and areas: adding, changing and removing them, and their current poses."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, cast

import numpy as np

from logical_robots_tui.editing.level_text import (
    KINDS,
    Entity,
    Kind,
    all_entities,
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
    new_level = replace(level, **words)
    return level if words_of(new_level) == words_of(level) else new_level


def resize(
    level: Level, width: int, height: int, *, left: int = 0, top: int = 0, wall: bool = False
) -> Level:
    """Resize a level, in map units; its objects move along.

    `left` and `top` are inserted before the first column and row, negative values cut; `wall`
    fills new space. Raises LevelError if the size is out of range or an object too far from the
    map.
    """
    sizes = Fields({"width": width, "height": height}, level.name)
    width, height = sizes.integer("width", minimum=1), sizes.integer("height", minimum=1)
    sizes.check_size("width", width, height)
    if (width, height, left, top) == (level.width, level.height, 0, 0):
        return level
    for entity in all_entities(level):
        if max(abs(entity.x + left), abs(entity.y + top)) > MOST_OF_A_NUMBER:
            raise LevelError(f'"{entity.name}" would be too far outside the labyrinth.')
    walls = np.full((height, width), wall, np.bool_)
    new_rows, old_rows = _overlap(height, level.height, top)
    new_columns, old_columns = _overlap(width, level.width, left)
    walls[new_rows, new_columns] = level.walls[old_rows, old_columns]
    walls.flags.writeable = False
    moved: dict[str, Any] = {
        kind: tuple(replace(e, x=e.x + left, y=e.y + top) for e in getattr(level, kind))
        for kind in KINDS
    }
    return replace(level, width=width, height=height, walls=walls, **moved)


def _overlap(new: int, old: int, shift: int) -> tuple[slice, slice]:
    first, last = max(shift, 0), min(old + shift, new)
    last = max(last, first)
    return slice(first, last), slice(first - shift, last - shift)


_BEACON_HANDICAP = ROBOT_RADIUS - BEACON_RADIUS  # map units, when picking an object
_READ: dict[Kind, Callable[[Fields], Entity]] = {
    "robots": read_robot,
    "beacons": read_beacon,
    "areas": read_area,
}


@dataclass(frozen=True, slots=True, order=True)
class Ref:
    kind: Kind
    index: int


def entity_of(level: Level, ref: Ref) -> Entity:
    """Return a robot, beacon or area; raises IndexError."""
    return _entities(level, ref.kind)[ref.index]


def add(level: Level, new: Entity) -> tuple[Level, Ref]:
    """Add an object, last of its kind; return level and reference, or raise LevelError.

    A number is appended to a robot's name if it is taken. Where there are teams, a robot
    without one joins the first.
    """
    kind = kind_of(new)
    entities = _entities(level, kind)
    if len(entities) >= MOST_OF_A_KIND:
        raise LevelError(f"There are {MOST_OF_A_KIND} {kind} already, the most allowed.")
    if isinstance(new, Robot):
        names = {robot.name for robot in level.robots}
        name = next(name for name in _numbered_names(new.name) if name not in names)
        new = replace(new, name=name)
        if level.teams and not new.team:
            new = replace(new, team=level.teams[0].name)
    ref = Ref(kind, len(entities))
    return _replace_entities(level, kind, (*entities, _validate(level, ref, new))), ref


def change(level: Level, ref: Ref, **values: Any) -> Level:
    """Set attributes of an object, and update references to its name, or raise LevelError.

    For beacons and areas, only renaming the last one of a name updates references.
    """
    old = entity_of(level, ref)
    names = {field.name for field in fields(old)}
    for name in values:
        if name not in names:
            raise LevelError(f"{ref.kind.capitalize()} have no {name}.")
    new = _validate(level, ref, replace(old, **values))
    if new == old:
        return level
    entities = list(_entities(level, ref.kind))
    entities[ref.index] = new
    new_level = _replace_entities(level, ref.kind, tuple(entities))
    return _rename_references(new_level, old, new) if new.name != old.name else new_level


def duplicate(level: Level, ref: Ref, dx: float, dy: float) -> tuple[Level, Ref]:
    """Add a copy of an object, shifted by map units, or raise LevelError."""
    original = entity_of(level, ref)
    return add(level, replace(original, x=original.x + dx, y=original.y + dy))


def remove(level: Level, ref: Ref) -> Level:
    """Remove an object, but not references to its name; raises LevelError for the last robot."""
    entity_of(level, ref)
    if ref.kind == "robots" and len(level.robots) == 1:
        raise LevelError("A level needs at least one robot.")
    entities = _entities(level, ref.kind)
    return _replace_entities(level, ref.kind, (*entities[: ref.index], *entities[ref.index + 1 :]))


def ref_at(level: Level, x: float, y: float, reach: float = 0.0) -> Ref | None:
    """Return the nearest robot or beacon within `reach` map units, or else the smallest area."""

    def distance(entity: Entity) -> float:
        return math.hypot(x - entity.x, y - entity.y)

    near = [
        *((distance(r), Ref("robots", i)) for i, r in enumerate(level.robots)),
        *((distance(b) + _BEACON_HANDICAP, Ref("beacons", i)) for i, b in enumerate(level.beacons)),
    ]
    bodies = [candidate for candidate in near if candidate[0] < ROBOT_RADIUS + reach]
    if bodies:
        return min(bodies)[1]
    areas = [(area.radius, i) for i, area in enumerate(level.areas) if distance(area) < area.radius]
    return Ref("areas", min(areas)[1]) if areas else None


def _entities(level: Level, kind: Kind) -> tuple[Entity, ...]:
    entities: tuple[Entity, ...] = getattr(level, kind)
    return entities


def _replace_entities(level: Level, kind: Kind, entities: tuple[Entity, ...]) -> Level:
    return replace(level, **cast("dict[str, Any]", {kind: entities}))


def reread(level: Level, ref: Ref, entity: Entity) -> Entity:
    """Return an object as a reload would read it, or raise LevelError."""
    return _READ[ref.kind](Fields(record_of(entity), level.name, f"{ref.kind}[{ref.index}]"))


def _validate(level: Level, ref: Ref, entity: Entity) -> Entity:
    entity = reread(level, ref, entity)
    if ref.kind == "robots":
        names = [robot.name for robot in level.robots]
        names[ref.index : ref.index + 1] = [entity.name]
        if names.count(entity.name) > 1:
            check_robot_names(Fields({}, level.name), tuple(names))
    return entity


def _rename_references(level: Level, old: Entity, new: Entity) -> Level:
    """Rename an object in the areas and scores of a level that refer to it."""
    areas, scores, names = level.areas, level.scores, {old.name: new.name}
    if isinstance(old, Robot):
        areas = rename_in_areas(areas, names, {})
    elif old.name in [entity.name for entity in _entities(level, kind_of(old))]:
        return level
    elif isinstance(old, Beacon):
        areas = rename_in_areas(areas, {}, names)
    else:
        scores = tuple(replace(score, area=names.get(score.area, score.area)) for score in scores)
    return replace(level, areas=areas, scores=scores)


def _numbered_names(name: str) -> Iterator[str]:
    yield name
    match = re.fullmatch(r"(.+?)( ?)\d{1,4}", name, re.DOTALL)
    stem, gap = (match[1], match[2]) if match else (name, " ")
    for number in range(2, MOST_OF_A_KIND + 3):
        suffix = f"{gap}{number}"
        yield stem[: LONGEST_NAME - len(suffix)] + suffix


def level_at(level: Level, state: WorldState) -> Level:
    if state.tick == 0:
        return level
    bodies = {body.name: body for body in state.robots}
    pairs = ((robot, bodies.get(robot.name, robot)) for robot in level.robots)
    robots = (replace(robot, x=body.x, y=body.y, angle=body.angle) for robot, body in pairs)
    return replace(level, robots=tuple(robots))


class Poses:
    """Where robots are put when the level changes while they run.

    Undo moves a robot back to its place at the moment of the change, not to its start.
    """

    def __init__(self) -> None:
        self._poses: dict[tuple[str, Pose], Pose] = {}

    def note(self, robot: Robot, body: Robot) -> None:
        """Remember a robot's pose, in the level and now (`body`), before it is moved."""
        self._poses[robot.name, _pose(robot)] = _pose(body)

    def between(self, old: Level, new: Level) -> dict[str, Pose]:
        starts = {robot.name: _pose(robot) for robot in old.robots}
        poses = [(robot.name, _pose(robot)) for robot in new.robots if robot.name in starts]
        return {name: self._poses.get((name, p), p) for name, p in poses if starts[name] != p}


def _pose(robot: Robot) -> Pose:
    return robot.x, robot.y, robot.angle
