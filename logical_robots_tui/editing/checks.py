"""Checking levels for likely mistakes."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.editing.entities import Ref, reread
from logical_robots_tui.editing.level_text import KINDS, all_entities, words_of
from logical_robots_tui.editing.strokes import Regions
from logical_robots_tui.world.level import Area, Beacon, Level, LevelError, Robot
from logical_robots_tui.world.levels.fields import MOST_OF_A_KIND, Fields
from logical_robots_tui.world.levels.native import misfits, oddities, read_words
from logical_robots_tui.world.sensing import ROBOT_RADIUS
from logical_robots_tui.world.walls import row_clearances

if TYPE_CHECKING:
    from numpy.typing import NDArray


_REASONS = {"robots": "; each needs a unique name", "beacons": "; a radar can't distinguish them"}
_MOST_NAMES = 3  # most names listed in one finding


@dataclass(frozen=True, slots=True)
class LevelFinding:
    """A likely mistake at a place in map units; if it `forbids`, the level can't be loaded."""

    text: str
    x: float | None = None
    y: float | None = None
    forbids: bool = False


def check(level: Level) -> list[LevelFinding]:
    """Return all likely mistakes, or only those that prevent loading; at most about a second."""
    oddity_entities = ((o, getattr(level, o.kind)[o.index]) for o in oddities(level))
    return [*load_errors(level)] or [
        *(LevelFinding(f"{o.message} {o.hint}".rstrip(), e.x, e.y) for o, e in oddity_entities),
        *_placement(level),
        *_goals(level),
        *_open_rim(level.walls),
        *_shared_names(level),
    ]


def load_errors(level: Level) -> Iterator[LevelFinding]:
    top = Fields(words_of(level), level.name)
    try:
        read_words(top)
        top.check_size("walls", level.width, level.height)
    except LevelError as error:
        yield LevelFinding(error.message, forbids=True)
    if not level.robots:
        yield LevelFinding("The level has no robots.", forbids=True)
    for oddity in misfits(level):
        yield LevelFinding(f"{oddity.message} {oddity.hint}".rstrip(), forbids=True)
    for kind in KINDS:
        entities = getattr(level, kind)
        if len(entities) > MOST_OF_A_KIND:
            text = f"There are {len(entities)} {kind}; at most {MOST_OF_A_KIND} are allowed."
            yield LevelFinding(text, forbids=True)
        for index, entity in enumerate(entities):
            try:
                reread(level, Ref(kind, index), entity)
            except LevelError as error:
                is_finite = math.isfinite(entity.x) and math.isfinite(entity.y)
                x, y = (entity.x, entity.y) if is_finite else (None, None)
                yield LevelFinding(f'"{entity.name}": {error.message}', x, y, forbids=True)
    yield from (clash for clash in _duplicate_names(level) if clash.forbids)


def _duplicate_names(level: Level) -> Iterator[LevelFinding]:
    for kind in KINDS:
        groups = defaultdict(list)
        for entity in getattr(level, kind):
            groups[entity.name].append(entity)
        for name, entities in groups.items():
            if len(entities) > 1 and (kind == "robots" or name not in level.shared_names):
                text = f'{len(entities)} {kind} are called "{name}"{_REASONS.get(kind, "")}.'
                yield LevelFinding(text, entities[1].x, entities[1].y, forbids=kind == "robots")


def _shared_names(level: Level) -> Iterator[LevelFinding]:
    yield from _duplicate_names(level)
    for name in level.shared_names:
        if all([e.name for e in kind].count(name) < 2 for kind in (level.beacons, level.areas)):
            yield LevelFinding(f'"{name}" is a shared name, but no two beacons or areas have it.')


def _placement(level: Level) -> Iterator[LevelFinding]:
    for entity in all_entities(level):
        on_map = 0 <= entity.x < level.width and 0 <= entity.y < level.height
        in_wall = on_map and bool(level.walls[math.floor(entity.y), math.floor(entity.x)])
        if isinstance(entity, Area):
            problem = ""
            if entity.radius < 1:
                problem = "is too small: its radius is below 1"
            elif in_wall or not on_map:
                window, disc = units_of(entity, level)
                is_inside = bool(level.walls[window][disc].all())
                problem = "is inside walls" if is_inside else ""
                problem = problem if disc.any() else "is outside the labyrinth"
            if problem:
                yield LevelFinding(f'Area "{entity.name}" {problem}.', entity.x, entity.y)
        elif in_wall:
            noun = "Robot" if isinstance(entity, Robot) else "Beacon"
            yield LevelFinding(f'{noun} "{entity.name}" is inside a wall.', entity.x, entity.y)
        elif not on_map and isinstance(entity, Beacon):
            text = f'Beacon "{entity.name}" is outside the labyrinth.'
            yield LevelFinding(text, entity.x, entity.y)


def _goals(level: Level) -> Iterator[LevelFinding]:
    goals = [area for area in level.areas if area.victory_robots]
    if not goals:
        return
    reach = Reach(level)
    beacons = {beacon.name for beacon in level.beacons}
    for area in goals:
        if always_solid(area, beacons):
            text = f'No robot can be inside the goal "{area.name}": it is solid.'
            yield LevelFinding(text, area.x, area.y)
            continue
        never, hardly = reach.to(area)
        if never:
            text = f'{_join(never)} can\'t reach the goal "{area.name}".'
            yield LevelFinding(text, area.x, area.y)
        if hardly:
            gaps = "only through gaps narrower than a robot"
            text = f'{_join(hardly)} can reach the goal "{area.name}" {gaps}.'
            yield LevelFinding(text, area.x, area.y)


def _open_rim(walls: NDArray[np.bool_]) -> Iterator[LevelFinding]:
    height, width = walls.shape
    for side, rim, x, y in (
        ("top", walls[0], None, 0.5),
        ("bottom", walls[-1], None, height - 0.5),
        ("left", walls[:, 0], 0.5, None),
        ("right", walls[:, -1], width - 0.5, None),
    ):
        edges = np.diff(np.pad(~rim, 1).astype(np.int8))
        starts, stops = np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist()
        for start, stop in zip(starts, stops, strict=True):
            size, middle = stop - start, (start + stop) / 2
            wide = f"{size} unit{'' if size == 1 else 's'} wide"
            text = f"The outer wall has a gap on the {side}, {wide}."
            yield LevelFinding(text, middle if x is None else x, middle if y is None else y)


def _join(names: Sequence[str]) -> str:
    listed = list(names[:_MOST_NAMES])
    rest_count = len(names) - len(listed)
    if rest_count:
        return f"{', '.join(listed)} and {rest_count} more"
    return " and ".join([", ".join(listed[:-1]), listed[-1]] if len(listed) > 1 else listed)


_MARGIN = int(ROBOT_RADIUS) + 2  # map units around the map, where robots can drive as well


class Reach:
    """The parts of a level that its robots can reach.

    Obstacles are walls, and solid areas that nothing switches off. Collisions treat a robot as
    a point, but it gets through a gap narrower than its body only by luck.
    """

    def __init__(self, level: Level) -> None:
        blocked = level.walls.copy()
        beacons = {beacon.name for beacon in level.beacons}
        for area in level.areas:
            if always_solid(area, beacons):
                window, disc = units_of(area, level)
                blocked[window] |= disc
        blocked = np.pad(blocked, _MARGIN)
        self._shape = blocked.shape
        self._narrow = Regions(~blocked, corners=True)
        self._wide = Regions(_widen_obstacles(blocked), corners=True)
        self._starts = {
            robot.name: (self._start(robot), self._near(robot, ROBOT_RADIUS))
            for robot in level.robots
        }

    def to(self, area: Area) -> tuple[list[str], list[str]]:
        """Return the robots that can't reach their goal, and those whose way there is too narrow.

        A robot that is walled in at the start is in neither list.
        """
        narrow = self._narrow.within(area.x + _MARGIN, area.y + _MARGIN, area.radius)
        wide = self._near(area, area.radius + ROBOT_RADIUS)
        never, hardly = [], []
        for name in area.victory_robots:
            start, wide_start = self._starts.get(name, (None, None))
            if not start or wide_start is None:
                continue
            if not start & narrow:
                never.append(name)
            elif not wide_start & wide:
                hardly.append(name)
        return never, hardly

    def _start(self, robot: Robot) -> frozenset[int]:
        row, column = math.floor(robot.y) + _MARGIN, math.floor(robot.x) + _MARGIN
        row = min(max(row, 0), self._shape[0] - 1)
        column = min(max(column, 0), self._shape[1] - 1)
        region = self._narrow.region_at(row, column)
        if region >= 0:
            return frozenset((region,))
        return self._narrow.within(column + 0.5, row + 0.5, 1.0)

    def _near(self, entity: Robot | Area, reach: float) -> frozenset[int]:
        x, y = entity.x + _MARGIN, entity.y + _MARGIN
        x, y = min(max(x, 0.0), self._shape[1]), min(max(y, 0.0), self._shape[0])
        return self._wide.within(x, y, reach)


def always_solid(area: Area, beacons: set[str]) -> bool:
    is_switched = area.on_beacon or area.off_beacon in beacons or area.cycle
    return area.impenetrable and not is_switched


def units_of(area: Area, level: Level) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    left, right = _span(area.x, area.radius, level.width)
    top, bottom = _span(area.y, area.radius, level.height)
    dx = np.arange(left, right) + 0.5 - area.x
    dy = np.arange(top, bottom) + 0.5 - area.y
    disc = np.hypot(dx[None, :], dy[:, None]) < area.radius
    return (slice(top, bottom), slice(left, right)), disc


def _span(middle: float, radius: float, size: int) -> tuple[int, int]:
    first = min(max(math.floor(middle - radius), 0), size)
    return first, max(min(math.ceil(middle + radius), size), first)


def _widen_obstacles(blocked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    reach = math.ceil(ROBOT_RADIUS) - 1
    clearance = row_clearances(blocked, reach + 1)
    free = np.ones(blocked.shape, np.bool_)
    for down in range(-reach, reach + 1):
        across = math.ceil(math.sqrt(ROBOT_RADIUS**2 - down**2)) - 1
        near = clearance <= across
        if down >= 0:
            free[: len(free) - down] &= ~near[down:]
        else:
            free[-down:] &= ~near[:down]
    return free
