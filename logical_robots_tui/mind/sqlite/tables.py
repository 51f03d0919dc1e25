"""A moment in the tables of a database, and queries over what a robot sees of it."""

from __future__ import annotations

import marshal
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite import layouts
from logical_robots_tui.mind.sqlite.budget import Within
from logical_robots_tui.mind.sqlite.database import Answer, Database, Scalar, TooMuchError
from logical_robots_tui.mind.sqlite.layouts import Filling, Layout, fillings
from logical_robots_tui.mind.sqlite.moment import Moment, View
from logical_robots_tui.mind.sqlite.stored import to_input, to_sql

if TYPE_CHECKING:
    from logical_robots_tui.mind.program import Tuned


class UnfitError(Exception):
    """The sensors or memories don't have the shape or size that the columns need."""


class PlainTables(Database):
    """The tables as programs know them, with what one robot sees of a moment."""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits, layouts.PLAIN_LAYOUT)
        self._loaded: tuple[Moment, View] | None = None

    def ask_of(
        self,
        sql: str,
        moment: Moment,
        view: View,
        within: Within,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Return a query's rows; raise as `load` and `ask` do."""
        self.see(moment, view)
        return self.ask(sql, parameters, most=within.rows + 1, within=within)

    def see(self, moment: Moment, view: View) -> None:
        """Load the rows of a view, unless they are there; raise TooMuchError."""
        loaded = None if self.is_empty else self._loaded
        if loaded is None or loaded[0] is not moment or loaded[1] is not view:
            self._loaded = None
            first, last = view.sensors
            sensors = moment.sensors[first : last + 1]
            first, last = view.memories
            start = bisect_left(moment.memories, (first, ""))
            end = bisect_left(moment.memories, (last + 1, ""))
            names = [name for _, name in moment.memories[start:end]]
            self.load(
                [(row["robot_name"], to_input(row["sensor"])) for row in sensors],
                [(name, to_sql(moment.remembered.get(name))) for name in names],
            )
            self._loaded = (moment, view)


class TunedTables:
    """All rows of a moment, with the sensor fields and radar rays that are read as columns."""

    def __init__(
        self, limits: Limits, *, frozen: bool = False, few: Layout = layouts.COLUMNS_LAYOUT
    ) -> None:
        self._limits = limits
        self._few = few
        self._database = self._new_database(few)
        self._radars = _Radars(frozen=frozen)
        self._is_crowd = False
        self._moment: Moment | None = None
        self._memories = b""  # the content of ``Memory``, or empty if unknown
        self._filled: dict[str, tuple[str, ...]] = {}
        # By table, the columns that were read of this moment and of the previous one, to fill a
        # table once for all readers.
        self._read: list[Mapping[str, tuple[str, ...]]] = []
        self._read_before: list[Mapping[str, tuple[str, ...]]] = []
        # Columns into which this moment did not fit: no other view need try.
        self._unfit: tuple[Moment | None, list[Mapping[str, tuple[str, ...]]]] = None, []

    def ask(self, tuned: Tuned, moment: Moment, view: View, within: Within) -> Answer:
        """Return a query's rows; raise as `Database` does, or UnfitError for unusual data."""
        bounds = (*view.sensors, *view.memories)[: tuned.bounds]
        tuned = self.fitting(tuned, moment)
        return self._ask(tuned.sql, bounds, within.rows + 1, tuned, moment, within)

    def ask_together(self, tuned: Tuned, moment: Moment, within: Within, most: int) -> Answer:
        """Return at most `most` rows for all views of a moment; raise as `ask` does."""
        last = len(moment.sensors) - 1
        tuned = self.fitting(tuned, moment)
        sql, bounds = tuned.for_all(alike=moment.stride == 0)
        numbers = (0, last, 0, last, moment.stride)[:bounds]
        return self._ask(sql, numbers, most, tuned, moment, within)

    @staticmethod
    def fitting(tuned: Tuned, moment: Moment) -> Tuned:
        return tuned.for_crowd() if _is_crowd(moment) else tuned

    def close(self) -> None:
        self._database.close()

    def _ask(
        self,
        sql: str,
        bounds: tuple[int, ...],
        most: int,
        tuned: Tuned,
        moment: Moment,
        within: Within,
    ) -> Answer:
        if self._unfit[0] is not moment:
            self._unfit = moment, []
        unfit = self._unfit[1]
        if any(columns is tuned.columns for columns in unfit):
            raise UnfitError("as before")
        try:
            self._fill(moment, tuned.columns)
        except (UnfitError, TooMuchError):
            unfit.append(tuned.columns)
            raise
        return self._database.ask(sql, bounds, most=most, within=within)

    def _fill(self, moment: Moment, wanted: Mapping[str, tuple[str, ...]]) -> None:
        if self._database.is_empty:
            self._reset()
        if self._moment is not moment:
            if _is_crowd(moment) != self._is_crowd:
                self._is_crowd = not self._is_crowd
                self._database.close()
                self._database = self._new_database(
                    layouts.CROWD_LAYOUT if self._is_crowd else self._few
                )
                self._reset()
            # Of the last moment only the names are left, which are often the same.
            last = self._moment
            has_names = self._filled.get("Sensor") == _NAMES and last and last.names == moment.names
            self._filled = {"Sensor": _NAMES} if has_names else {}
            self._moment = moment
            self._read_before, self._read = self._read, [wanted]
        elif not any(read is wanted for read in self._read):
            self._read.append(wanted)
        filled = self._filled
        before = self._read_before
        try:
            for table, names in wanted.items():
                there = filled.get(table)
                if there is not None:
                    if there is names or set(names) <= set(there):
                        continue
                    names = _both(there, names)
                    del filled[table]
                else:
                    for read in before:
                        if read is not wanted:
                            names = _both(names, read.get(table, names))
                if table == "Ray":
                    self._radars.fill(self._database, moment, names)
                elif table == "Memory":
                    items = fillings("Memory", moment, names)
                    content = _exactly(items)  # most programs keep their memory for many ticks
                    if not content or content != self._memories:
                        self._memories = b""
                        self._database.fill("Memory", items)
                        self._memories = content
                else:
                    self._database.fill(table, fillings(table, moment, names))
                filled[table] = names
        except (TypeError, KeyError, AttributeError, ValueError, OverflowError) as error:
            raise UnfitError(str(error)) from None

    def _new_database(self, layout: Layout) -> Database:
        database = Database(self._limits, layout)
        database.offer(layouts.WHOLE_RAY, self._whole_ray)
        return database

    def _whole_ray(self, number: int | None) -> str | None:
        """Return a ray as JSON; IndexError, KeyError or TypeError if there is none."""
        if number is None:
            return None
        assert self._moment is not None
        robot, ray = divmod(number, layouts.RAYS)
        return to_input(self._moment.sensors[robot]["sensor"]["radar"][ray])

    def _reset(self) -> None:
        self._radars.forget()
        self._moment = None
        self._memories = b""
        self._filled = {}


def _both(some: tuple[str, ...], others: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names in either; the same object if one contains all."""
    if some is others or set(others) <= set(some):
        return some
    return others if set(some) <= set(others) else tuple(sorted({*some, *others}))


def _is_crowd(moment: Moment) -> bool:
    return len(moment.sensors) >= _CROWD


def _exactly(items: Sequence[Filling]) -> bytes:
    try:
        return marshal.dumps([[insert, rows] for insert, rows in items], _WITHOUT_REFERENCES)
    except ValueError:
        return b""


_WITHOUT_REFERENCES = 2  # a format version that writes identical objects like equal ones

_NAMES = ("robot_name",)

_CROWD = 32  # robots from which on SQLite's automatic indexes pay off


_MOST_VALUES = 900  # per statement


class _Radars:
    """The table ``Ray``; if `frozen`, a radar that is the same object keeps its rays."""

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._numbers: tuple[str, int] | None = None  # the same where rows have the same numbers
        self._there: list[list[Any]] = []

    def fill(self, database: Database, moment: Moment, columns: tuple[str, ...]) -> None:
        """Replace the rays of changed radars; ValueError if their numbers of rays differ."""
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
                row: list[Any] = [number * layouts.RAYS]
                for value in in_ray:
                    row += map(value, radar)
                rows.append(row)
        self._numbers = None
        if rows:
            database.fill("Ray", ((insert, rows),), clear=not is_same)
        self._numbers, self._there = numbers, radars

    def forget(self) -> None:
        self._numbers, self._there = None, []


@cache
def _insert_rays(
    columns: tuple[str, ...], rays: int
) -> tuple[str, Sequence[Callable[[Mapping[str, Any]], Any]]]:
    """Return a statement for a radar (first number, then values by column) and a ray's reader."""
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    insert = f"REPLACE INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
    return insert, [to_input if name == "value" else itemgetter(name) for name in columns]
