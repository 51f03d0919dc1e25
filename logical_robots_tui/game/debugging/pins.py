"""Pins: values that a player watches, and reading them at a tick."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from logical_robots_tui.mind import QueryError
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.mind import Table

MIND = "in the mind of"
"""Pseudo-column for the robot in whose reasoning a row holds. No real column has this name."""

ROBOT_COLUMNS = (MIND, "robot_name", "robot")
"""Columns that name the robot of a row, the most specific first."""

Path: TypeAlias = "tuple[str | int, ...]"
"""The path into a value: field names and list indices."""


class Pin(NamedTuple):
    """A number of rows ("" as column), or one value in one row.

    Of a question only rows for which it holds count.
    """

    predicate: str
    column: str = ""
    where: tuple[tuple[str, Value], ...] = ()
    path: Path = ()

    @property
    def is_question(self) -> bool:
        return not self.predicate.isidentifier()

    @property
    def name(self) -> str:
        """Its name without the robot, such as ``Robot.memory.phase`` or ``Near: rows``."""
        if self.is_question:
            return self.predicate
        if not self.column:
            return f"{self.predicate}: rows"
        return path_text(self.path, f"{self.predicate}.{self.column}")

    @property
    def words(self) -> str:
        """Its full description, such as ``Robot.memory for Ada``."""
        parts = (
            one if name in ROBOT_COLUMNS else f"{name} {one}"
            for name, value in self.where
            for one in [value if isinstance(value, str) else spell(value, is_rounded=True)]
        )
        return f"{self.name} for {', '.join(parts)}" if self.where else self.name

    def deeper(self, path: Path) -> Pin:
        return self._replace(path=self.path + path)


class Reading(NamedTuple):
    """The value of a pin at a tick."""

    value: Value = None
    problem: str = ""

    @property
    def number(self) -> float | None:
        """The value as a number, 0 or 1 for a Boolean; None if it is not a finite number."""
        if not isinstance(self.value, bool | int | float):
            return None
        try:
            number = float(self.value)
        except OverflowError:
            return None
        return number if math.isfinite(number) else None


def path_text(path: Path, what: str = "memory") -> str:
    return what + "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in path)


def pin_of_cell(
    predicate: str, columns: Sequence[str], rows: Sequence[Sequence[Value]], row: int, column: str
) -> Pin | None:
    """Return the pin of a value in a table, which finds its row again at other ticks.

    As few columns as needed identify the row. None if only the value itself distinguishes it.
    """
    mine = rows[row]
    others = [each for at, each in enumerate(rows) if at != row]
    where: list[tuple[str, Value]] = []
    names = [name for name in ROBOT_COLUMNS if name in columns]
    for name in (*names, *(name for name in columns if name not in ROBOT_COLUMNS)):
        place = columns.index(name)
        value = mine[place]
        left = [each for each in others if _is_same(each[place], value)]
        tells = name in ROBOT_COLUMNS or len(left) < len(others)
        if tells and name != column and isinstance(value, bool | int | float | str):
            where.append((name, value))
            others = left
    return None if others else Pin(predicate, column, tuple(where))


def read(pin: Pin, table: Table | QueryError) -> Reading:
    if isinstance(table, QueryError):
        return Reading(problem=str(table))
    for name in (*(name for name, _ in pin.where), pin.column):
        if table.rows and name not in (*table.columns, MIND, ""):
            return Reading(problem=f"{pin.predicate} has no column {name}.")
    rows = list(_matching(table, pin.where))
    if not pin.column:
        return Reading(len(rows))
    if len(rows) != 1:
        return Reading(problem=f"{len(rows)} rows." if rows else "No row.")
    return _inside(rows[0][table.columns.index(pin.column)], pin.path)


def _matching(table: Table, where: Iterable[tuple[str, Value]]) -> Iterator[tuple[Value, ...]]:
    tests = [
        (table.columns.index(name) if name in table.columns else None, value)
        for name, value in where
    ]
    for number, row in enumerate(table.rows):
        viewer = table.viewers[number] if table.viewers else None
        if all(
            _is_same(row[place], value) if place is not None else viewer in (None, value)
            for place, value in tests
        ):
            yield row


def _is_same(value: Value, wanted: Value) -> bool:
    """Return whether a value identifies the same row; angles may differ in the last digits."""
    if isinstance(value, float) and isinstance(wanted, float):
        return math.isclose(value, wanted, rel_tol=1e-6, abs_tol=1e-9)
    return value == wanted


def _inside(value: Value, path: Path) -> Reading:
    for step in path:
        if isinstance(step, str):
            if not isinstance(value, Mapping) or step not in value:
                return Reading(problem=f"There is no field {step}.")
            value = value[step]
        elif isinstance(value, Sequence) and not isinstance(value, str) and step < len(value):
            value = value[step]
        else:
            return Reading(problem=f"There is no item {step}.")
    return Reading(value)
