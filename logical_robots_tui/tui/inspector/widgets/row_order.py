"""Rows filtered, sorted and transposed, and as CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.game import ROBOT_COLUMNS
from logical_robots_tui.tui.inspector.widgets.cells import written

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.values import Value

Row: TypeAlias = "tuple[Value, ...]"

_SIDEWAYS = 50  # most rows of a transposed table


@dataclass(frozen=True, slots=True)
class RowOrder:
    """How to filter (by robot and text), sort and transpose rows; "" for no such choice."""

    robot: str = ""
    search: str = ""
    sort: str = ""
    descending: bool = False
    sideways: bool = False

    @property
    def words(self) -> str:
        way = "descending" if self.descending else "ascending"
        parts = [
            f"only {self.robot}" if self.robot else "",
            f"with “{self.search}”" if self.search else "",
            f"{way} by {self.sort}" if self.sort else "",
        ]
        return ", ".join(part for part in parts if part)


@dataclass(frozen=True, slots=True)
class Rows:
    """Columns and rows; `changed` are (row, column), `left_out` rows of a transposed table."""

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    changed: frozenset[tuple[int, int]] = frozenset()
    left_out: int = 0


def arranged(rows: Rows, how: RowOrder) -> Rows:
    columns = rows.columns
    kept = list(range(len(rows.rows)))
    place = next((columns.index(name) for name in ROBOT_COLUMNS if name in columns), None)
    if how.robot and place is not None:
        kept = [number for number in kept if rows.rows[number][place] == how.robot]
    if how.search:
        wanted = how.search.casefold()
        kept = [
            number
            for number in kept
            if any(wanted in written(value).casefold() for value in rows.rows[number])
        ]
    if how.sort in columns:
        by = columns.index(how.sort)
        kept.sort(key=lambda number: _rank(rows.rows[number][by]), reverse=how.descending)
    places = {number: at for at, number in enumerate(kept)}
    changed = frozenset((places[row], column) for row, column in rows.changed if row in places)
    found = Rows(columns, tuple(rows.rows[number] for number in kept), changed)
    return _transposed(found) if how.sideways else found


def changed_cells(rows: Sequence[Row], before: Sequence[Row]) -> frozenset[tuple[int, int]]:
    """Row and column of each change; rows in both are unchanged, others compared in order."""
    now, then = [repr(row) for row in rows], [repr(row) for row in before]
    known, kept = set(then), set(now)
    left = [row for row, told in zip(before, then, strict=True) if told not in kept]
    found: set[tuple[int, int]] = set()
    for number, (row, told) in enumerate(zip(rows, now, strict=True)):
        if told not in known:
            other = left.pop(0) if left else ()
            found.update(
                (number, column)
                for column, value in enumerate(row)
                if column >= len(other) or value != other[column]
            )
    return frozenset(found)


def as_csv(rows: Rows) -> str:
    """Return the rows as CSV with a header; records and lists become JSON."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(rows.columns)
    writer.writerows([_plain(value) for value in row] for row in rows.rows)
    return file.getvalue()


def as_json(rows: Rows) -> str:
    records = [dict(zip(rows.columns, row, strict=True)) for row in rows.rows]
    return json.dumps(records, ensure_ascii=False, indent=1) + "\n"


def _transposed(rows: Rows) -> Rows:
    """Turn each column into a line, with the first rows side by side."""
    shown = rows.rows[:_SIDEWAYS]
    lines = tuple((name, *(row[at] for row in shown)) for at, name in enumerate(rows.columns))
    names = ("", *(str(number + 1) for number in range(len(shown))))
    changed = ((column, row + 1) for row, column in rows.changed if row < _SIDEWAYS)
    return Rows(names, lines, frozenset(changed), len(rows.rows) - len(shown))


def _rank(value: Value) -> tuple[int, Any]:
    """Return a sort key for any value: null, Booleans and numbers, texts, the rest."""
    if value is None:
        return 0, 0
    if isinstance(value, bool | int | float):
        return 1, value
    return (2, value) if isinstance(value, str) else (3, written(value))


def _plain(value: Value) -> Any:
    if isinstance(value, Mapping | list | tuple):
        return json.dumps(value, ensure_ascii=False)
    return value
