"""Names in the labyrinth: cutting them to fit, and placing them without overlap."""

from __future__ import annotations

import unicodedata
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from rich.cells import cell_len

from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing

if TYPE_CHECKING:
    from collections.abc import Iterator


def fit_name(name: str, width: int, cut: str, unknown: str, ascii_only: bool = False) -> list[str]:
    """Return a name as the texts of cells, at most ``width`` of them.

    A character two cells wide is followed by an empty text. Marks stay with their letter.
    Control characters become ``unknown``; invisible ones, which could reorder the line, are
    left out. `cut` ends a name that was too long.
    """
    cells: list[str] = []
    for char in unicodedata.normalize("NFC", name[: 4 * width + 16]):
        category = unicodedata.category(char)
        if category in {"Cf", "Cs", "Me"} or "\ufe00" <= char <= "\ufe0f":
            continue
        if "\U0001f3fb" <= char <= "\U0001f3ff" or "\U0001f1e6" <= char <= "\U0001f1ff":
            char = unknown
        if category in {"Cc", "Zl", "Zp", "Co", "Cn"} or (ascii_only and not char.isascii()):
            char = unknown
        size = cell_len(char)
        if size:
            cells += [char] if size == 1 else [char, ""]
        elif cells and not ascii_only:
            base = -1 if cells[-1] else -2
            if len(cells[base]) < 3 and cell_len(cells[base] + char) == cell_len(cells[base]):
                cells[base] += char
    if len(cells) <= width:
        return cells
    cells = cells[: max(width - 1, 0)]
    if cells and cell_len(cells[-1]) == 2:
        cells.pop()
    return [*cells, cut][:width]


@lru_cache(maxsize=4096)
def fit_into(name: str, width: int, drawing: Drawing) -> tuple[str, ...]:
    glyphs = drawing.glyphs
    return tuple(fit_name(name, width, glyphs.cut, glyphs.unknown, drawing is Drawing.ASCII))


class Label(NamedTuple):
    """A name and its cell, with `clear` rows of what it names, which it may be `inside`."""

    cells: tuple[str, ...]
    row: int
    column: int
    clear: int = 0
    inside: bool = False

    def places(self, rows: int, columns: int) -> Iterator[tuple[int, int]]:
        """Yield possible places as (row, first column), the best first."""
        width, beside = len(self.cells), 2 * self.clear + 2
        if width > columns:
            return
        middle = min(max(self.column - width // 2, 0), columns - width)
        steps = [self.clear + 1, self.clear + 2, self.clear + 3]
        wanted = [(self.row, middle)] if self.inside else []
        wanted += [(self.row - steps[0], middle), (self.row + steps[0], middle)]
        wanted += [(self.row, self.column + beside), (self.row, self.column - beside + 1 - width)]
        for step in steps:
            for row in (self.row - step, self.row + step):
                wanted += [(row, self.column + 1), (row, self.column - width), (row, middle)]
        for row, column in wanted:
            if 0 <= row < rows and 0 <= column <= columns - width:
                yield row, column


class FreeCells:
    """The cells that are free for names: one integer per row, with one bit per cell."""

    def __init__(self, rows: int, columns: int) -> None:
        self._taken = [0] * rows
        self._columns = columns

    def copy(self) -> FreeCells:
        other = FreeCells(0, self._columns)
        other._taken = self._taken.copy()
        return other

    def take(self, row: int, first: int, stop: int) -> None:
        first, stop = max(first, 0), min(stop, self._columns)
        if 0 <= row < len(self._taken) and first < stop:
            self._taken[row] |= (1 << stop) - (1 << first)

    def is_free(self, row: int, first: int, stop: int) -> bool:
        """Return whether cells of a row, and one to each side, are free."""
        return not (self._taken[row] << 1 >> first) & ((1 << stop - first + 2) - 1)

    def place(self, plate: Label) -> tuple[int, int] | None:
        width = len(plate.cells)
        taken, whole = self._taken, (1 << width + 2) - 1
        for row, column in plate.places(len(taken), self._columns):
            # As `is_free` has it; this is the innermost loop of a crowded picture.
            if not (taken[row] << 1 >> column) & whole:
                self.take(row, column, column + width)
                return row, column
        return None
