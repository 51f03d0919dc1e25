"""A moment in the tables of a database, and queries over what a robot sees of it."""

from __future__ import annotations

import marshal
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite.database import Answer, Database, Scalar, TooMuchError
from logical_robots_tui.mind.sqlite.filling import Filling, Radars, fillings, whole_ray
from logical_robots_tui.mind.sqlite.layouts import (
    COLUMNS_LAYOUT,
    CROWD_LAYOUT,
    PLAIN_LAYOUT,
    WHOLE_RAY,
    Layout,
)
from logical_robots_tui.mind.sqlite.moment import Moment, View, Within
from logical_robots_tui.mind.sqlite.stored import to_input, to_sql

if TYPE_CHECKING:
    from logical_robots_tui.mind.program import Tuned


class UnfitError(Exception):
    """The sensors or memories don't have the shape or size that the columns need."""


class PlainTables:
    def __init__(self, limits: Limits) -> None:
        self._database = Database(limits, PLAIN_LAYOUT)
        self._loaded: tuple[Moment, View] | None = None

    def ask(
        self,
        sql: str,
        moment: Moment,
        view: View,
        within: Within,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Return a query's rows; raise as `Database.load` and `Database.ask` do."""
        self._load(moment, view)
        return self._database.ask(sql, parameters, most=within.rows + 1, within=within)

    def _load(self, moment: Moment, view: View) -> None:
        loaded = None if self._database.is_empty else self._loaded
        if loaded is None or loaded[0] is not moment or loaded[1] is not view:
            self._loaded = None
            first, last = view.sensors
            sensors = moment.sensors[first : last + 1]
            first, last = view.memories
            start = bisect_left(moment.memories, (first, ""))
            end = bisect_left(moment.memories, (last + 1, ""))
            names = [name for _, name in moment.memories[start:end]]
            self._database.load(
                [(row["robot_name"], to_input(row["sensor"])) for row in sensors],
                [(name, to_sql(moment.remembered.get(name))) for name in names],
            )
            self._loaded = (moment, view)

    def define(
        self,
        table: str,
        columns: Sequence[str],
        rows: Sequence[Sequence[Scalar]],
        moment: Moment,
        view: View,
    ) -> None:
        """Fill an additional table for queries over a view; raise TooMuchError."""
        self._load(moment, view)
        self._database.define(table, columns, rows)

    def offer(self, name: str, function: Callable[..., Any], arguments: int) -> None:
        self._database.offer(name, function, arguments)

    def close(self) -> None:
        self._database.close()


class TunedTables:
    """All rows of a moment, with the sensor fields and radar rays that are read as columns."""

    def __init__(
        self, limits: Limits, *, frozen: bool = False, few: Layout = COLUMNS_LAYOUT
    ) -> None:
        self._limits = limits
        self._few = few
        self._database = self._new_database(few)
        self._radars = Radars(frozen=frozen)
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
                self._change_size()
            self._forget_all_but_names(moment)
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
                    self._fill_memory(moment, names)
                else:
                    self._database.fill(table, fillings(table, moment, names))
                filled[table] = names
        except (TypeError, KeyError, AttributeError, ValueError, OverflowError) as error:
            raise UnfitError(str(error)) from None

    def _fill_memory(self, moment: Moment, names: tuple[str, ...]) -> None:
        items = fillings("Memory", moment, names)
        # Most programs keep their memory for many ticks.
        text = _exactly(items)
        if not text or text != self._memories:
            self._memories = b""
            self._database.fill("Memory", items)
            self._memories = text

    def _new_database(self, layout: Layout) -> Database:
        database = Database(self._limits, layout)
        database.offer(WHOLE_RAY, self._whole_ray)
        return database

    def _whole_ray(self, number: int | None) -> str | None:
        assert self._moment is not None
        return whole_ray(self._moment, number)

    def _change_size(self) -> None:
        self._is_crowd = not self._is_crowd
        self._database.close()
        self._database = self._new_database(CROWD_LAYOUT if self._is_crowd else self._few)
        self._reset()

    def _reset(self) -> None:
        self._radars.forget()
        self._moment = None
        self._memories = b""
        self._filled = {}

    def _forget_all_but_names(self, moment: Moment) -> None:
        """Delete the rows of the last moment except the names, which are often the same."""
        names = self._filled.get("Sensor")
        before = self._moment
        self._filled.clear()
        if names == _NAMES and before is not None and before.names == moment.names:
            self._filled["Sensor"] = _NAMES


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
