"""New levels: empty rooms, random labyrinths, and those of a day, alike for everybody.

The labyrinth of a day is made from its name alone, such as ``daily-2026-11-22-small``; a
final ``-2`` asks for the second of that day and size.
"""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from random import Random
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, TypeVar, cast, get_args
from zlib import crc32

import numpy as np

from logical_robots_tui.world.level import Area, Beacon, Level, LevelError, Robot
from logical_robots_tui.world.levels.fields import MOST_SIDE

if TYPE_CHECKING:
    from numpy.typing import NDArray

_LEAST_CORRIDOR = 20  # map units; a robot is 18 wide
_LARGEST_GOAL = 40.0

_T = TypeVar("_T")
_Cell = tuple[int, int]
"""Column and row."""


def empty_room(width: int, height: int, *, wall: int = 10) -> Level:
    """Return a walled room with a robot and a goal, or raise LevelError.

    All lengths are in map units; the size includes the outer wall.
    """
    _check_wall(wall)
    _check_size(width, height)
    room = min(width, height) - 2 * wall
    if room < _LEAST_CORRIDOR:
        message = f"A robot does not fit between the walls of a room of {width} x {height} units."
        raise LevelError(message)
    walls = np.ones((height, width), np.bool_)
    walls[wall:-wall, wall:-wall] = False
    inside = width - 2 * wall
    left, right = wall + inside * 0.2, wall + inside * 0.8
    robot, goal = (round(left), round(height / 2)), (round(right), round(height / 2))
    return _level("Room", walls, robot, 0.0, goal, room)


def labyrinth(
    columns: int,
    rows: int,
    *,
    seed: int = 0,
    loops: float = 0.1,
    corridor: int = 60,
    wall: int = 10,
) -> Level:
    """Return a random labyrinth with every cell reachable; reproducible by its arguments.

    The goal is farthest from the start in the upper left. `loops` is the fraction, 0 to 1, of
    remaining walls to open; `corridor` and `wall` are in map units. Raises LevelError.
    """
    if columns < 1 or rows < 1 or columns * rows < 2:
        raise LevelError(f"A labyrinth needs at least 2 cells, not {columns} x {rows}.")
    if not 0 <= loops <= 1:
        raise LevelError(f"The share of loops must be between 0 and 1, not {loops:g}.")
    if not _LEAST_CORRIDOR <= corridor <= MOST_SIDE:
        message = f"A corridor must be {_LEAST_CORRIDOR} to {MOST_SIDE} units wide, not {corridor}."
        raise LevelError(message, hint="A robot is 18 wide; use at least 50.")
    _check_wall(wall)
    step = corridor + wall
    _check_size(columns * step + wall, rows * step + wall)
    doors = _doors(columns, rows, loops, Random(seed))  # noqa: S311 - not for security

    walls = np.ones((rows * step + wall, columns * step + wall), np.bool_)
    for column, row in _cells(columns, rows):
        top, left = row * step + wall, column * step + wall
        walls[top : top + corridor, left : left + corridor] = False
    for (column, row), (next_column, next_row) in doors:
        top, left = row * step + wall, column * step + wall
        bottom, right = next_row * step + step, next_column * step + step
        walls[top:bottom, left:right] = False
    middle = wall + corridor // 2
    end = _farthest(doors)
    goal = middle + end[0] * step, middle + end[1] * step
    angle = 0.0 if ((0, 0), (1, 0)) in doors else math.pi / 2
    return _level(f"Labyrinth {seed}", walls, (middle, middle), angle, goal, corridor)


def _doors(columns: int, rows: int, loops: float, random: Random) -> list[tuple[_Cell, _Cell]]:
    start = (0, 0)
    visited, path, doors = {start}, [start], []
    while path:
        column, row = path[-1]
        sides = [(column + 1, row), (column, row + 1), (column - 1, row), (column, row - 1)]
        free = [c for c in sides if c not in visited and 0 <= c[0] < columns and 0 <= c[1] < rows]
        if not free:
            path.pop()
            continue
        neighbour = _draw(free, random)
        doors.append((min(path[-1], neighbour), max(path[-1], neighbour)))
        visited.add(neighbour)
        path.append(neighbour)
    open_doors = set(doors)
    closed_doors = [
        (cell, neighbour)
        for cell in _cells(columns, rows)
        for neighbour in ((cell[0] + 1, cell[1]), (cell[0], cell[1] + 1))
        if neighbour[0] < columns and neighbour[1] < rows and (cell, neighbour) not in open_doors
    ]
    for _ in range(round(loops * len(closed_doors))):
        door = _draw(closed_doors, random)
        closed_doors.remove(door)
        doors.append(door)
    return doors


def _draw(options: Sequence[_T], random: Random) -> _T:
    """Choose at random; only ``random()`` gives the same numbers in every version of Python."""
    return options[int(random.random() * len(options))]


def _farthest(doors: list[tuple[_Cell, _Cell]]) -> _Cell:
    neighbours: dict[_Cell, list[_Cell]] = {}
    for cell, neighbour in doors:
        neighbours.setdefault(cell, []).append(neighbour)
        neighbours.setdefault(neighbour, []).append(cell)
    cell = (0, 0)
    visited, border = {cell}, deque([cell])
    while border:
        cell = border.popleft()
        new = [neighbour for neighbour in neighbours[cell] if neighbour not in visited]
        visited.update(new)
        border.extend(new)
    return cell


def _cells(columns: int, rows: int) -> list[_Cell]:
    return [(column, row) for row in range(rows) for column in range(columns)]


def _check_wall(wall: int) -> None:
    if not 1 <= wall <= MOST_SIDE:
        raise LevelError(f"A wall must be 1 to {MOST_SIDE} units thick, not {wall}.")


def _check_size(width: int, height: int) -> None:
    if max(width, height) > MOST_SIDE:
        limit = f"{MOST_SIDE} x {MOST_SIDE}"
        raise LevelError(
            f"The labyrinth would be {width} x {height} units; at most {limit} is allowed."
        )


def _level(
    title: str,
    walls: NDArray[np.bool_],
    start: tuple[int, int],
    angle: float,
    goal: tuple[int, int],
    room: int,
) -> Level:
    walls.flags.writeable = False
    radius = math.floor(min(room * 0.4, _LARGEST_GOAL))
    return Level(
        name=title.lower().replace(" ", "-"),
        title=title,
        width=walls.shape[1],
        height=walls.shape[0],
        walls=walls,
        robots=(Robot("Ada", start[0], start[1], angle, "orange"),),
        areas=(Area("Goal", goal[0], goal[1], radius, "green", ("Ada",)),),
        briefing="Bring Ada to the goal.",
        starter="first-steps-starter",
    )


DailySize: TypeAlias = Literal["small", "medium", "large"]
DAILY_SIZES: tuple[DailySize, ...] = get_args(DailySize)

_CELLS: dict[DailySize, tuple[int, int]] = {"small": (5, 4), "medium": (7, 5), "large": (9, 6)}
_CORRIDOR, _WALL = 90, 20  # map units
_NAME = re.compile(rf"daily-(\d{{4}}-\d\d-\d\d)-({'|'.join(DAILY_SIZES)})(?:-([2-9]|[1-9]\d))?")

_BRIEFING = """\
Bring Ada to the beacon Goal. There are no loops, so all walls hang together.
Everybody has this labyrinth today. Who needs the fewest ticks, and who the
shortest program? The command "Copy my result" makes a line to share.
"""


class Daily(NamedTuple):
    """A labyrinth of a day; the number counts from 1 for each day and size."""

    day: date
    size: DailySize
    number: int = 1

    @classmethod
    def parse(cls, name: str) -> Daily | None:
        if (match := _NAME.fullmatch(name)) is None:
            return None
        try:
            day = date.fromisoformat(match[1])
        except ValueError:
            return None
        return cls(day, cast("DailySize", match[2]), int(match[3] or 1))

    @property
    def name(self) -> str:
        suffix = f"-{self.number}" if self.number > 1 else ""
        return f"daily-{self.day.isoformat()}-{self.size}{suffix}"

    @property
    def cells(self) -> int:
        columns, rows = _CELLS[self.size]
        return columns * rows

    def level(self, source: str) -> Level:
        seed = crc32(self.name.encode())
        level = labyrinth(*_CELLS[self.size], seed=seed, loops=0, corridor=_CORRIDOR, wall=_WALL)
        (goal,) = level.areas
        return replace(
            level,
            name=self.name,
            title=f"Labyrinth of {self.day.isoformat()}, {self.size}",
            beacons=(Beacon("Goal", goal.x, goal.y),),
            idea="Everybody has this labyrinth today.",
            briefing=_BRIEFING.strip(),
            source=source,
        )
