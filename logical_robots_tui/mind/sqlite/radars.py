"""The table of all radar rays, updated only for radars that changed."""

from __future__ import annotations

from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.filling import RAYS
from logical_robots_tui.mind.sqlite.inserting import Filling
from logical_robots_tui.mind.sqlite.stored import to_input

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.mind.sqlite.database import Database
    from logical_robots_tui.mind.sqlite.moment import Moment

__all__ = ["Radars"]

_MOST_VALUES = 900  # per statement


class Radars:
    """The content of the table ``Ray`` of a database.

    Args:
        frozen: Whether nobody changes a sensor; then a radar that is the same object as before has
            the same rays, as for a stationary robot.
    """

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._numbers: tuple[str, int] | None = None  # the same where rows have the same numbers
        self._there: list[list[Any]] = []

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Replace the rays of radars that changed.

        Args:
            database: The same as before, unless `forget` was called.
            moment: The moment.
            columns: The columns to fill besides ``id``, in alphabetical order.

        Raises:
            ValueError: The radars don't all have as many rays as the first, or have too many.
            Exception: The exceptions of `Database.fill`, or a ray has another shape.
        """
        radars = [row["sensor"]["radar"] for row in moment.sensors]
        usual = len(radars[0])
        values = usual * (1 + len(columns))
        if any(len(radar) != usual for radar in radars) or not 0 < values < _MOST_VALUES:
            raise ValueError("radars of different size")
        insert, in_ray = _insert_rays(columns, usual)
        numbers = insert, len(radars)
        is_same = numbers == self._numbers
        there = self._there if is_same and self._frozen else [None] * len(radars)
        rows = []
        for number, (radar, before) in enumerate(zip(radars, there, strict=True)):
            if radar is not before:
                row: list[Any] = [number * RAYS]
                for value in in_ray:
                    row += map(value, radar)
                rows.append(row)
        self._numbers = None
        if rows:
            database.fill("Ray", (Filling(insert, rows),), () if is_same else None)
        self._numbers, self._there = numbers, radars

    def forget(self) -> None:
        """Start again with an empty table."""
        self._numbers, self._there = None, []


@cache
def _insert_rays(
    columns: tuple[str, ...], rays: int
) -> tuple[str, Sequence[Callable[[Mapping[str, Any]], Any]]]:
    """Return a statement for one radar, and the function that reads the columns from a ray.

    The statement takes the first number, then the values column by column.
    """
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    insert = f"REPLACE INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
    return insert, [to_input if name == "value" else itemgetter(name) for name in columns]
