"""The drawing of a labyrinth in a level file: rows of characters, or run-length encoded rows.

A row is drawn, ``#..####``, or shortened, ``1# 2. 4#``; a shortened row that begins with ``12*`` is
repeated twelve times. One character is ``cell`` map units wide and high.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import cycle, pairwise
from operator import sub
from string import whitespace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from logical_robots_tui.world.level import LevelError
from logical_robots_tui.world.levels.fields import MOST_SIDE, Fields

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WALL = ord("#")
_STRANGE = re.compile(r"[^#. ]")
_DIGIT = re.compile(r"\d")
_SHORT = re.compile(r"(?:(\d{1,4})\*\s*)?(\d{1,4}[#.](?:\s*\d{1,4}[#.])*)", re.ASCII)
_NO_KINDS = b"0123456789" + whitespace.encode()
_ONLY_COUNTS = str.maketrans("#.", "  ")
_WIDEST_DRAWN = 240  # characters; wider rows are shortened, because nobody draws them by hand
_LONGEST_ROW = 10 * MOST_SIDE  # characters of a shortened one
_LARGEST_CELL = 20  # map units; larger cells would be too coarse to draw anything new
_DRAW = "Draw walls as # and free cells as . or space, one row per line, between ''' and '''."
_SHORTEN = "Write runs of # and . such as 6# 94. 6#; 12* in front repeats the row 12 times."


class _Row(NamedTuple):
    """A line of a drawing, for equal rows; True in `kinds` is wall."""

    line: str
    times: int
    counts: NDArray[np.int16] | None = None
    kinds: NDArray[np.bool_] | None = None

    @property
    def columns(self) -> int:
        return len(self.line) if self.counts is None else int(self.counts.sum())

    def cells(self) -> NDArray[np.bool_]:
        cells: NDArray[np.bool_]
        if self.counts is None or self.kinds is None:
            cells = np.frombuffer(self.line.encode("ascii", "replace"), np.uint8) == _WALL
        else:
            cells = self.kinds.repeat(self.counts)
        return cells


def read_drawing(top: Fields, text: str) -> NDArray[np.bool_]:
    """Read ``cell`` and ``walls`` of a level file, or raise LevelError.

    Returns a read-only array of shape (height, width) in map units; True is wall.
    """
    cell = top.whole("cell", least=1)
    drawing = top.record.get("walls")
    if not isinstance(drawing, str):
        raise top.error("walls", '"walls" must be text that draws the map.', _DRAW)
    drawing_lines = drawing.removesuffix("\n").count("\n") + 1
    if drawing_lines > MOST_SIDE:
        raise top.error(
            "walls", f"The map has {drawing_lines} rows; at most {MOST_SIDE} are allowed."
        )
    lines = drawing.removesuffix("\n").split("\n")
    rows = [_row(line) for line in lines]
    columns = rows[0].columns if rows[0] else 0
    if rows[0] and not columns:
        raise top.error("walls", "The first row of the map is empty.", _DRAW)
    top.check_size("walls", columns * cell, sum(row.times if row else 1 for row in rows) * cell)

    start = find_drawing(drawing, text)
    first_line = text.count("\n", 0, start) + 1 if start is not None else None
    cells = np.zeros((len(rows), columns), np.bool_)
    for i, (row, line) in enumerate(zip(rows, lines, strict=True)):
        problem = _problem(row, line, columns)
        if problem:
            place = f"{top.file}, row {i + 1} of walls"
            place += f" (line {first_line + i})" if first_line else ""
            raise LevelError(problem[0], place=place, hint=problem[1])
        assert row
        cells[i] = row.cells()
    times = [row.times if row else 1 for row in rows]
    walls = cells.repeat(np.multiply(times, cell), axis=0).repeat(cell, axis=1)
    walls.flags.writeable = False
    return walls


def find_drawing(drawing: str, text: str) -> int | None:
    for found in re.finditer(r"^[ \t]*walls[ \t]*=[ \t]*('''|\"\"\")\n?", text, re.MULTILINE):
        if text.startswith(drawing + found[1], found.end()):
            return found.end()
    return None


def coarsest_cell(walls: NDArray[np.bool_]) -> int:
    """Return the largest cell size in map units, at most 20, that draws the walls exactly."""
    height, width = walls.shape
    down = np.flatnonzero((walls[1:] != walls[:-1]).any(axis=1)) + 1
    across = np.flatnonzero((walls[:, 1:] != walls[:, :-1]).any(axis=0)) + 1
    common = int(np.gcd.reduce([height, width, *down.tolist(), *across.tolist()]))
    return max(size for size in range(1, _LARGEST_CELL + 1) if common % size == 0)


def expresses(walls: NDArray[np.bool_], cell: int) -> bool:
    height, width = walls.shape
    if height % cell or width % cell:
        return False
    cells = walls[::cell, ::cell]
    return bool((walls == cells.repeat(cell, axis=0).repeat(cell, axis=1)).all())


def draw_rows(walls: NDArray[np.bool_], cell: int, earlier: Sequence[str] = ()) -> list[str]:
    """Return the lines that draw walls, keeping earlier ones that are still right.

    `cell`, in map units per character, must express the walls.
    """
    cells = walls[::cell, ::cell]
    known = [row for row in map(_row, earlier) if row]
    shape = sum(row.times for row in known), known[0].columns if known else 0
    alike = shape == cells.shape and all(row.columns == shape[1] for row in known)
    if not alike or len(known) < len(earlier):
        return list(_fresh(cells, short=cells.shape[1] > _WIDEST_DRAWN))
    lines = []
    start = 0
    for row in known:
        block = cells[start : start + row.times]
        start += row.times
        if (block == row.cells()).all():
            lines.append(row.line)
        elif row.counts is None:
            lines.append(_redrawn(row.line, block[0]))
        else:
            lines += _fresh(block, short=True)
    return lines


def _row(line: str) -> _Row | None:
    if not _DIGIT.search(line):
        return _Row(line, 1)
    if len(line) > _LONGEST_ROW:
        return None
    found = _SHORT.fullmatch(line.strip())
    if not found or not int(found[1] or 1):
        return None
    text = found[2]
    if text.count("#") + text.count(".") > MOST_SIDE:
        return None
    counts = np.fromstring(text.translate(_ONLY_COUNTS), np.int16, sep=" ")
    kinds = np.frombuffer(text.encode("ascii").translate(None, _NO_KINDS), np.uint8) == _WALL
    return _Row(line, int(found[1] or 1), counts, kinds)


def _problem(row: _Row | None, line: str, columns: int) -> tuple[str, str] | None:
    if row is None:
        return "This shortened row can't be read.", _SHORTEN
    if row.columns != columns:
        message = f"This row has {row.columns} characters, the first one has {columns}."
        return message, "All rows must have the same length."
    strange = _STRANGE.search(line) if row.counts is None else None
    if strange is None:
        return None
    character = strange[0]
    shown = f'"{character}"' if character.isprintable() else f"U+{ord(character):04X}"
    message = f"Character {strange.start() + 1} is {shown}, which is neither wall nor free."
    return message, _DRAW


def _fresh(cells: NDArray[np.bool_], *, short: bool) -> Iterator[str]:
    if not short:
        for row in cells:
            yield "".join("#" if wall else "." for wall in row.tolist())
        return
    changes = np.flatnonzero((cells[1:] != cells[:-1]).any(axis=1)) + 1
    bounds = [0, *changes.tolist(), len(cells)]
    for start, stop in pairwise(bounds):
        yield (f"{stop - start}* " if stop - start > 1 else "") + _shorten(cells[start])


def _shorten(row: NDArray[np.bool_]) -> str:
    bounds = [0, *(np.flatnonzero(row[1:] != row[:-1]) + 1).tolist(), len(row)]
    walls, free = _runs()
    kinds = (walls, free) if row[0] else (free, walls)
    counts = map(sub, bounds[1:], bounds)
    return " ".join(kind[count] for kind, count in zip(cycle(kinds), counts, strict=False))


@cache
def _runs() -> tuple[tuple[str, ...], tuple[str, ...]]:
    counts = range(MOST_SIDE + 1)
    return tuple(f"{count}#" for count in counts), tuple(f"{count}." for count in counts)


def _redrawn(line: str, row: NDArray[np.bool_]) -> str:
    """Return a drawn line with new walls; free cells keep their character."""
    free = " " if " " in line and "." not in line else "."
    return "".join(
        "#" if wall else free if before == "#" else before
        for before, wall in zip(line, row.tolist(), strict=True)
    )
