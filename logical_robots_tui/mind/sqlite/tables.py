"""A mind's inputs in the tables of a database, and queries over what a robot sees of them."""

from __future__ import annotations

import marshal
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.sqlite import layouts
from logical_robots_tui.mind.sqlite.budget import QueryBudget
from logical_robots_tui.mind.sqlite.database import Answer, Database, Scalar, TooMuchError
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.mind.sqlite.layouts import Insertion, SqlLayout, insertions
from logical_robots_tui.mind.sqlite.stored import to_input, to_sql

if TYPE_CHECKING:
    from logical_robots_tui.mind.program import Tuned


class UnfitError(Exception):
    """The sensors or memories don't have the shape or size that the columns need."""


class PlainTables(Database):
    """The tables as programs know them, with what one robot sees."""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits, layouts.PLAIN_LAYOUT)
        self._loaded: tuple[Inputs, View] | None = None

    def ask_of(
        self,
        sql: str,
        inputs: Inputs,
        view: View,
        budget: QueryBudget,
        parameters: Sequence[Scalar] = (),
    ) -> Answer:
        """Return a query's rows; raise as `load` and `ask` do."""
        self.load_view(inputs, view)
        return self.ask(sql, parameters, max_rows=budget.rows + 1, budget=budget)

    def load_view(self, inputs: Inputs, view: View) -> None:
        """Load the rows of a view, unless they are there; raise TooMuchError."""
        loaded = None if self.is_empty else self._loaded
        if loaded is None or loaded[0] is not inputs or loaded[1] is not view:
            self._loaded = None
            first, last = view.sensors
            sensors = inputs.sensor_rows[first : last + 1]
            first, last = view.memories
            start = bisect_left(inputs.memory_rows, (first, ""))
            end = bisect_left(inputs.memory_rows, (last + 1, ""))
            names = [name for _, name in inputs.memory_rows[start:end]]
            self.load(
                [(row["robot_name"], to_input(row["sensor"])) for row in sensors],
                [(name, to_sql(inputs.memory_values.get(name))) for name in names],
            )
            self._loaded = (inputs, view)


class TunedTables:
    """All rows of a mind's inputs, with sensor fields and radar rays in columns."""

    def __init__(
        self,
        limits: Limits,
        *,
        frozen: bool = False,
        small_layout: SqlLayout = layouts.COLUMNS_LAYOUT,
    ) -> None:
        self._limits = limits
        self._small_layout = small_layout
        self._database = self._new_database(small_layout)
        self._radars = _RadarTable(frozen=frozen)
        self._is_crowd = False
        self._inputs: Inputs | None = None
        self._memories = b""  # the content of ``Memory``, or empty if unknown
        self._filled_columns: dict[str, tuple[str, ...]] = {}
        # By table, the columns read of these inputs and of the previous ones, to fill a table once
        # for all readers.
        self._columns_read: list[Mapping[str, tuple[str, ...]]] = []
        self._columns_read_previously: list[Mapping[str, tuple[str, ...]]] = []
        # Columns that these inputs do not fit: no other view need try.
        self._unfit: tuple[Inputs | None, list[Mapping[str, tuple[str, ...]]]] = None, []

    def ask(self, tuned: Tuned, inputs: Inputs, view: View, budget: QueryBudget) -> Answer:
        """Return a query's rows; raise as `Database` does, or UnfitError for unusual data."""
        bounds = (*view.sensors, *view.memories)[: tuned.bounds]
        tuned = self.variant_for(tuned, inputs)
        return self._ask(tuned.sql, bounds, budget.rows + 1, tuned, inputs, budget)

    def ask_together(
        self, tuned: Tuned, inputs: Inputs, budget: QueryBudget, max_rows: int
    ) -> Answer:
        """Return at most `max_rows` rows for all views; raise as `ask` does."""
        last = len(inputs.sensor_rows) - 1
        tuned = self.variant_for(tuned, inputs)
        sql, bounds = tuned.for_all(alike=inputs.stride == 0)
        numbers = (0, last, 0, last, inputs.stride)[:bounds]
        return self._ask(sql, numbers, max_rows, tuned, inputs, budget)

    @staticmethod
    def variant_for(tuned: Tuned, inputs: Inputs) -> Tuned:
        return tuned.for_crowd() if _is_crowd(inputs) else tuned

    def close(self) -> None:
        self._database.close()

    def _ask(
        self,
        sql: str,
        bounds: tuple[int, ...],
        max_rows: int,
        tuned: Tuned,
        inputs: Inputs,
        budget: QueryBudget,
    ) -> Answer:
        if self._unfit[0] is not inputs:
            self._unfit = inputs, []
        unfit = self._unfit[1]
        if any(columns is tuned.columns for columns in unfit):
            raise UnfitError("these inputs did not fit these columns")
        try:
            self._fill(inputs, tuned.columns)
        except (UnfitError, TooMuchError):
            unfit.append(tuned.columns)
            raise
        return self._database.ask(sql, bounds, max_rows=max_rows, budget=budget)

    def _fill(self, inputs: Inputs, columns: Mapping[str, tuple[str, ...]]) -> None:
        if self._database.is_empty:
            self._reset()
        if self._inputs is not inputs:
            if _is_crowd(inputs) != self._is_crowd:
                self._is_crowd = not self._is_crowd
                self._database.close()
                self._database = self._new_database(
                    layouts.CROWD_LAYOUT if self._is_crowd else self._small_layout
                )
                self._reset()
            # Of the previous inputs only the names are kept, which are often the same.
            previous = self._inputs
            has_names = (
                self._filled_columns.get("Sensor") == _NAMES
                and previous
                and previous.names == inputs.names
            )
            self._filled_columns = {"Sensor": _NAMES} if has_names else {}
            self._inputs = inputs
            self._columns_read_previously, self._columns_read = self._columns_read, [columns]
        elif not any(columns_read is columns for columns_read in self._columns_read):
            self._columns_read.append(columns)
        filled_columns = self._filled_columns
        columns_read_previously = self._columns_read_previously
        try:
            for table, names in columns.items():
                filled_names = filled_columns.get(table)
                if filled_names is not None:
                    if filled_names is names or set(names) <= set(filled_names):
                        continue
                    names = _union(filled_names, names)
                    del filled_columns[table]
                else:
                    for columns_read in columns_read_previously:
                        if columns_read is not columns:
                            names = _union(names, columns_read.get(table, names))
                if table == "Ray":
                    self._radars.fill(self._database, inputs, names)
                elif table == "Memory":
                    statements = insertions("Memory", inputs, names)
                    content = _content_of(
                        statements
                    )  # most programs keep their memory for many ticks
                    if not content or content != self._memories:
                        self._memories = b""
                        self._database.fill("Memory", statements)
                        self._memories = content
                else:
                    self._database.fill(table, insertions(table, inputs, names))
                filled_columns[table] = names
        except (TypeError, KeyError, AttributeError, ValueError, OverflowError) as error:
            raise UnfitError(str(error)) from None

    def _new_database(self, layout: SqlLayout) -> Database:
        database = Database(self._limits, layout)
        database.register(layouts.WHOLE_RAY, self._whole_ray)
        return database

    def _whole_ray(self, number: int | None) -> str | None:
        """Return a ray as JSON; IndexError, KeyError or TypeError if there is none."""
        if number is None:
            return None
        assert self._inputs is not None
        robot, ray = divmod(number, layouts.RAYS)
        return to_input(self._inputs.sensor_rows[robot]["sensor"]["radar"][ray])

    def _reset(self) -> None:
        self._radars.forget()
        self._inputs = None
        self._memories = b""
        self._filled_columns = {}


def _union(left: tuple[str, ...], right: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names in either; the same object if one contains all."""
    if left is right or set(right) <= set(left):
        return left
    return right if set(left) <= set(right) else tuple(sorted({*left, *right}))


def _is_crowd(inputs: Inputs) -> bool:
    return len(inputs.sensor_rows) >= _CROWD


def _content_of(statements: Sequence[Insertion]) -> bytes:
    try:
        return marshal.dumps([[insert, rows] for insert, rows in statements], _WITHOUT_REFERENCES)
    except ValueError:
        return b""


_WITHOUT_REFERENCES = 2  # a format version that writes identical objects like equal ones

_NAMES = ("robot_name",)

_CROWD = 32  # robots from which on SQLite's automatic indexes pay off


_MAX_VALUES = 900  # per statement


class _RadarTable:
    """The table ``Ray``; if `frozen`, a radar that is the same object keeps its rays."""

    def __init__(self, *, frozen: bool) -> None:
        self._frozen = frozen
        self._shape: tuple[str, int] | None = None  # the same where rows have the same numbers
        self._radars: list[list[Any]] = []

    def fill(self, database: Database, inputs: Inputs, columns: tuple[str, ...]) -> None:
        """Replace the rays of changed radars; ValueError if their numbers of rays differ."""
        radars = [row["sensor"]["radar"] for row in inputs.sensor_rows]
        ray_count = len(radars[0])
        values = ray_count * (1 + len(columns))
        if any(len(radar) != ray_count for radar in radars) or not 0 < values < _MAX_VALUES:
            raise ValueError("radars of different size")
        insert, readers = _insert_rays(columns, ray_count)
        shape = insert, len(radars)
        is_same = shape == self._shape
        stored_radars = self._radars if is_same and self._frozen else [None] * len(radars)
        rows = []
        for number, (radar, stored_radar) in enumerate(zip(radars, stored_radars, strict=True)):
            if radar is not stored_radar:
                row: list[Any] = [number * layouts.RAYS]
                for read in readers:
                    row += map(read, radar)
                rows.append(row)
        self._shape = None
        if rows:
            database.fill("Ray", ((insert, rows),), clear=not is_same)
        self._shape, self._radars = shape, radars

    def forget(self) -> None:
        self._shape, self._radars = None, []


@cache
def _insert_rays(
    columns: tuple[str, ...], rays: int
) -> tuple[str, Sequence[Callable[[Mapping[str, Any]], Any]]]:
    """Return a statement for a radar (first number, then values by column) and readers of a ray."""
    rows = (
        ", ".join((f"?1 + {ray}", *(f"?{i * rays + ray + 2}" for i in range(len(columns)))))
        for ray in range(rays)
    )
    names = ", ".join(("id", *columns))
    values = ", ".join(f"({row})" for row in rows)
    insert = f"REPLACE INTO Ray({names}) VALUES {values}"  # noqa: S608 - our own names
    return insert, [to_input if name == "value" else itemgetter(name) for name in columns]
