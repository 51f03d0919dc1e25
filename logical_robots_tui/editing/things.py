"""Placing, moving, changing and removing robots, beacons and areas.

Every function returns a new level that can be loaded, or raises a ``LevelError`` that says why it
couldn't be.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from logical_robots_tui.editing.records import Thing, record_of
from logical_robots_tui.world.fields import Fields, check_robot_names
from logical_robots_tui.world.level import Beacon, LevelError, Robot
from logical_robots_tui.world.limits import LONGEST_NAME, MOST_OF_A_KIND
from logical_robots_tui.world.native import read_area, read_beacon, read_robot
from logical_robots_tui.world.sensing import BEACON_RADIUS, ROBOT_RADIUS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from logical_robots_tui.world.level import Level

__all__ = [
    "KINDS",
    "Kind",
    "Ref",
    "add",
    "change",
    "duplicate",
    "kind_of",
    "ref_at",
    "remove",
    "reread",
    "thing",
]

Kind: TypeAlias = Literal["robots", "beacons", "areas"]

KINDS: tuple[Kind, ...] = ("robots", "beacons", "areas")
_SMALLER = ROBOT_RADIUS - BEACON_RADIUS  # map units by which a beacon is harder to hit
_READ: dict[Kind, Callable[[Fields], Thing]] = {
    "robots": read_robot,
    "beacons": read_beacon,
    "areas": read_area,
}


@dataclass(frozen=True, slots=True, order=True)
class Ref:
    """One thing of a level.

    Attributes:
        kind: Which list of the level it is in.
        index: Its place in that list.
    """

    kind: Kind
    index: int


def thing(level: Level, ref: Ref) -> Thing:
    """Return a robot, beacon or area; raises IndexError."""
    return _list(level, ref.kind)[ref.index]


def add(level: Level, new: Thing) -> tuple[Level, Ref]:
    """Place a robot, beacon or area, the last of its kind.

    A robot whose name is taken gets a number behind it.

    Returns:
        The level, and where the new thing is.

    Raises:
        LevelError: There are too many of them, or something of it is out of bounds.
    """
    kind = kind_of(new)
    things = _list(level, kind)
    if len(things) >= MOST_OF_A_KIND:
        raise LevelError(f"There are {MOST_OF_A_KIND} {kind} already; more would be too many.")
    if isinstance(new, Robot):
        new = replace(new, name=_free_name(new.name, {robot.name for robot in level.robots}))
    ref = Ref(kind, len(things))
    return _with(level, kind, (*things, _checked(level, ref, new))), ref


def change(level: Level, ref: Ref, **values: Any) -> Level:
    """Set properties of a thing: its place, heading, name, colour or any other.

    When a robot is given another name, the areas that are a goal for it follow; when the last
    beacon of a name is, the areas that it switches do.

    Args:
        level: The level.
        ref: The thing.
        **values: By the names of the attributes of ``Robot``, ``Beacon`` or ``Area``.

    Raises:
        LevelError: A value is out of bounds, or no value for this, or the name is another robot's.
    """
    before = thing(level, ref)
    known = {field.name for field in fields(before)}
    for name in values:
        if name not in known:
            raise LevelError(f"{ref.kind.capitalize()} have no {name}.")
    after = _checked(level, ref, replace(before, **values))
    if after == before:
        return level
    things = list(_list(level, ref.kind))
    things[ref.index] = after
    changed = _with(level, ref.kind, tuple(things))
    return _followed(changed, before, after) if after.name != before.name else changed


def duplicate(level: Level, ref: Ref, dx: float, dy: float) -> tuple[Level, Ref]:
    """Place another one like a thing, so many map units beside it.

    Raises:
        LevelError: There are too many of its kind, or it would stand too far away.
    """
    original = thing(level, ref)
    return add(level, replace(original, x=original.x + dx, y=original.y + dy))


def remove(level: Level, ref: Ref) -> Level:
    """Take a thing away; what names it goes on naming it.

    Raises:
        LevelError: It is the last robot.
    """
    thing(level, ref)
    if ref.kind == "robots" and len(level.robots) == 1:
        raise LevelError("The last robot has to stay: a level needs at least one.")
    things = _list(level, ref.kind)
    return _with(level, ref.kind, (*things[: ref.index], *things[ref.index + 1 :]))


def ref_at(level: Level, x: float, y: float, reach: float = 0.0) -> Ref | None:
    """Return the thing at a point: the nearest robot or beacon, else the smallest area there.

    Args:
        level: The level.
        x: Map units.
        y: Map units.
        reach: Map units by which a robot or beacon may be missed.
    """

    def away(some: Thing) -> float:
        return math.hypot(x - some.x, y - some.y)

    near = [
        *((away(r), Ref("robots", i)) for i, r in enumerate(level.robots)),
        *((away(b) + _SMALLER, Ref("beacons", i)) for i, b in enumerate(level.beacons)),
    ]
    bodies = [found for found in near if found[0] < ROBOT_RADIUS + reach]
    if bodies:
        return min(bodies)[1]
    around = [
        (area.radius, Ref("areas", i))
        for i, area in enumerate(level.areas)
        if away(area) < area.radius
    ]
    return min(around)[1] if around else None


def kind_of(some: Thing) -> Kind:
    """Return which list of a level a thing belongs to."""
    return (
        "robots" if isinstance(some, Robot) else "beacons" if isinstance(some, Beacon) else "areas"
    )


def _list(level: Level, kind: Kind) -> tuple[Thing, ...]:
    things: tuple[Thing, ...] = getattr(level, kind)
    return things


def _with(level: Level, kind: Kind, things: tuple[Thing, ...]) -> Level:
    changes: dict[str, Any] = {kind: things}
    return replace(level, **changes)


def reread(level: Level, ref: Ref, some: Thing) -> Thing:
    """Return a thing as it will be when it is loaded again.

    Raises:
        LevelError: It couldn't be loaded.
    """
    place = Fields(record_of(some), level.name, f"{ref.kind}[{ref.index}]")
    return _READ[ref.kind](place)


def _checked(level: Level, ref: Ref, some: Thing) -> Thing:
    """Return a thing as it will be when it is loaded again, with a name of its own."""
    top = Fields({}, level.name)
    found = reread(level, ref, some)
    if ref.kind == "robots":
        names = [robot.name for robot in level.robots]
        names[ref.index : ref.index + 1] = [found.name]
        if names.count(found.name) > 1:
            check_robot_names(top, tuple(names))
    return found


def _followed(level: Level, before: Thing, after: Thing) -> Level:
    """Return a level whose areas go on meaning a thing that has a new name."""
    names = {before.name: after.name}
    if isinstance(before, Robot):
        areas = tuple(
            replace(area, victory_robots=tuple(names.get(n, n) for n in area.victory_robots))
            for area in level.areas
        )
    elif isinstance(before, Beacon) and before.name not in {b.name for b in level.beacons}:
        areas = tuple(
            replace(
                area,
                on_beacon=names.get(area.on_beacon, area.on_beacon),
                off_beacon=names.get(area.off_beacon, area.off_beacon),
            )
            for area in level.areas
        )
    else:
        return level
    return replace(level, areas=areas)


def _free_name(name: str, taken: set[str]) -> str:
    """Return a name that nobody has, made by counting on: Ann, Ann 2, Ann 3."""
    return name if name not in taken else next(n for n in _numbered(name) if n not in taken)


def _numbered(name: str) -> Iterator[str]:
    stem = re.sub(r" \d{1,4}$", "", name)
    for number in range(2, MOST_OF_A_KIND + 3):
        ending = f" {number}"
        yield stem[: LONGEST_NAME - len(ending)] + ending
