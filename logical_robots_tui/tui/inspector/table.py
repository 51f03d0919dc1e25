"""A table of values with a cursor, fast enough to replace many times a second."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import TYPE_CHECKING, Any, TypeAlias

from rich.cells import cell_len, set_cell_size
from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Region, Size
from textual.message import Message
from textual.scroll_view import ScrollView
from textual.strip import Strip

from logical_robots_tui.game import MIND, ROBOT_COLUMNS
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.plots import cell, format_value, is_number
from logical_robots_tui.tui.layout.command_bar import CommandChosen
from logical_robots_tui.tui.theme.themes import INK, rich_style
from logical_robots_tui.values import Value
from logical_robots_tui.wording import clip, count_of, visible

if TYPE_CHECKING:
    from logical_robots_tui.mind import ResultTable


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
        direction = "descending" if self.descending else "ascending"
        parts = [
            f"only {self.robot}" if self.robot else "",
            f"with “{self.search}”" if self.search else "",
            f"{direction} by {self.sort}" if self.sort else "",
        ]
        return ", ".join(part for part in parts if part)


@dataclass(frozen=True, slots=True)
class TableRows:
    """Columns and rows; `changed` are (row, column); `hidden_count` rows did not fit sideways."""

    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    changed: frozenset[tuple[int, int]] = frozenset()
    hidden_count: int = 0


def arrange(rows: TableRows, order: RowOrder) -> TableRows:
    columns = rows.columns
    numbers = list(range(len(rows.rows)))
    place = next((columns.index(name) for name in ROBOT_COLUMNS if name in columns), None)
    if order.robot and place is not None:
        numbers = [n for n in numbers if rows.rows[n][place] == order.robot]
    if text := order.search.casefold():
        numbers = [
            n for n in numbers if any(text in format_value(v).casefold() for v in rows.rows[n])
        ]
    if order.sort in columns:
        sort_column = columns.index(order.sort)
        numbers.sort(key=lambda n: _rank(rows.rows[n][sort_column]), reverse=order.descending)
    places = {number: index for index, number in enumerate(numbers)}
    changed = frozenset((places[row], column) for row, column in rows.changed if row in places)
    selection = TableRows(columns, tuple(rows.rows[number] for number in numbers), changed)
    return _transpose(selection) if order.sideways else selection


def changed_cells(rows: Sequence[Row], old_rows: Sequence[Row]) -> frozenset[tuple[int, int]]:
    """Row and column of each change; rows in both are unchanged, others compared in order."""
    texts, old_texts = [repr(row) for row in rows], [repr(row) for row in old_rows]
    old_set, new_set = set(old_texts), set(texts)
    left = [row for row, text in zip(old_rows, old_texts, strict=True) if text not in new_set]
    cells: set[tuple[int, int]] = set()
    for number, (row, text) in enumerate(zip(rows, texts, strict=True)):
        if text not in old_set:
            old_row = left.pop(0) if left else ()
            cells.update(
                (number, column)
                for column, value in enumerate(row)
                if column >= len(old_row) or value != old_row[column]
            )
    return frozenset(cells)


def as_csv(rows: TableRows) -> str:
    """Return the rows as CSV with a header; records and lists become JSON."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(rows.columns)
    for row in rows.rows:
        writer.writerow(
            json.dumps(value, ensure_ascii=False)
            if isinstance(value, Mapping | list | tuple)
            else value
            for value in row
        )
    return file.getvalue()


def as_json(rows: TableRows) -> str:
    records = [dict(zip(rows.columns, row, strict=True)) for row in rows.rows]
    return json.dumps(records, ensure_ascii=False, indent=1) + "\n"


def _transpose(rows: TableRows) -> TableRows:
    """Turn each column into a line, with the first rows side by side."""
    head = rows.rows[:_SIDEWAYS]
    lines = tuple((name, *(row[n] for row in head)) for n, name in enumerate(rows.columns))
    names = ("", *(str(number + 1) for number in range(len(head))))
    changed = ((column, row + 1) for row, column in rows.changed if row < _SIDEWAYS)
    return TableRows(names, lines, frozenset(changed), len(rows.rows) - len(head))


def _rank(value: Value) -> tuple[int, Any]:
    """Return a sort key for any value: null, Booleans and numbers, texts, the rest."""
    if value is None:
        return 0, 0
    if isinstance(value, bool | int | float):
        return 1, value
    return (2, value) if isinstance(value, str) else (3, format_value(value))


_GAP = 2
_MEASURED_ROWS = 200
_NARROWEST, _WIDEST = 4, 60

_HEAD = f"bold {INK.title}"
_HERE = "$here-ink on $here"
_ROW = "on $row"
_CHANGED = Style(underline=True, bold=True)


class ValueTable(ScrollView, can_focus=True):
    DEFAULT_CSS = """
    ValueTable { background: $surface; height: 1fr; overflow: auto auto; margin: 0 1; }
    """

    bar_keys = (
        *(("enter", "Why"), ("pin", "Pin"), ("break_here", "Break"), ("open_value", "Open")),
        *(("sort", "Sort"), ("search_rows", "Search"), ("copy_rows", "Copy")),
    )

    BINDINGS = [
        ("up", "go(-1, 0)"),
        ("down", "go(1, 0)"),
        ("left", "go(0, -1)"),
        ("right", "go(0, 1)"),
        ("pageup", "go(-10, 0)"),
        ("pagedown", "go(10, 0)"),
        ("home", "go(-1000000, 0)"),
        ("end", "go(1000000, 0)"),
        ("enter", "why"),
    ]

    class CellPointed(Message):
        """The cursor is on another value, or the value under it has been replaced."""

    class Rearranged(Message):
        """The player has filtered, sorted or transposed the rows."""

    def __init__(self, id: str = "rows") -> None:  # noqa: A002 - the name that widgets have
        super().__init__(id=id)
        self.all = TableRows((), ())
        self.shown = self.all
        self._are_all = True
        self.row_order = RowOrder()
        self._widths: list[int] = []
        self._at = (0, 0)

    @property
    def missing(self) -> str:
        if self.shown.hidden_count:
            note = f"and {self.shown.hidden_count:,} more rows side by side"
            return with_keys(f"{note}; {{transpose}} shows them one below the other")
        if self._are_all:
            return ""
        first = f"there are more rows than these first {len(self.all.rows):,}"
        return with_keys(f"{first}; {{ask}} asks for those with some value")

    @property
    def column(self) -> str:
        pointed = self.pointed
        return pointed[0] if pointed is not None and not self.row_order.sideways else ""

    @property
    def pointed(self) -> tuple[str, Value] | None:
        (row, column), rows = self._at, self.shown
        if not rows.rows or not rows.columns:
            return None
        name = rows.rows[row][0] if self.row_order.sideways else rows.columns[column]
        return str(name), rows.rows[row][column]

    @property
    def place(self) -> tuple[int, str] | None:
        row = self.shown.rows[self._at[0]] if self.column else None
        number = next((n for n, candidate in enumerate(self.all.rows) if candidate is row), None)
        return None if number is None else (number, self.column)

    def show(self, table: ResultTable | None, previous: ResultTable | None = None) -> None:
        """Replace the rows, marking differences from the tick before; the cursor stays."""
        columns, rows = _named_rows(table) if table is not None else ((), ())
        self._are_all = table is None or not table.truncated
        changed = frozenset[tuple[int, int]]()
        if previous is not None:
            changed = changed_cells(rows, _named_rows(previous)[1])
        if columns != self.all.columns:
            self._at = (self._at[0], 0)
        self.all = TableRows(columns, rows, changed)
        self._arrange()

    def rearrange(self, order: RowOrder) -> None:
        self.row_order = order
        self._arrange()
        self.post_message(self.Rearranged())

    def toggle_robot(self, robot: str) -> None:
        self.rearrange(replace(self.row_order, robot="" if self.row_order.robot else robot))

    def transpose(self) -> None:
        self.rearrange(replace(self.row_order, sideways=not self.row_order.sideways))

    def sort(self) -> None:
        """Sort by the cursor's column: ascending, then descending, then not at all."""
        order, column = self.row_order, self.column
        if not column:
            message = "Put the cursor on a column of a table that is not transposed."
            self.notify(message, markup=False)
        elif order.sort == column and order.descending:
            self.rearrange(replace(order, sort="", descending=False))
        else:
            self.rearrange(replace(order, sort=column, descending=order.sort == column))

    def _arrange(self) -> None:
        self.shown = arrange(self.all, self.row_order)
        self._measure()
        self.action_go(0, 0)
        self.refresh()

    def on_resize(self) -> None:
        self.redraw()

    def redraw(self) -> None:
        self._measure()
        self.refresh()

    def on_click(self, event: events.Click) -> None:
        row = event.y + self.scroll_offset.y - 1
        ends = accumulate(width + _GAP for width in self._widths)
        x = event.x + self.scroll_offset.x
        column = next((number for number, end in enumerate(ends) if x < end), len(self._widths) - 1)
        self._at = (row, column)
        self.action_go(0, 0)

    def action_go(self, down: int, right: int) -> None:
        row = max(0, min(self._at[0] + down, len(self.shown.rows) - 1))
        column = max(0, min(self._at[1] + right, len(self.shown.columns) - 1))
        self._at = (row, column)
        if self._widths:
            x = sum(self._widths[:column]) + _GAP * column
            # One line more on top, because the head covers the first visible one.
            is_last = row == len(self.shown.rows) - 1
            height = 2 + (is_last and bool(self.missing))
            area = Region(x, row, self._widths[column] + _GAP, height)
            self.scroll_to_region(area, animate=False, force=True)
        self.refresh()
        self.post_message(self.CellPointed())

    def action_why(self) -> None:
        self.post_message(CommandChosen("why"))

    def render_line(self, y: int) -> Strip:
        offset, top = self.scroll_offset
        base, number, count = self.rich_style, top + y - 1, len(self.shown.rows)
        if not self.shown.columns:
            return Strip.blank(self.size.width, base)
        fill, segments = base, []
        if y == 0:
            segments = self._head(base)
        elif number < count:
            if number == self._at[0] and self.has_focus:
                fill = base + rich_style(_ROW)
            segments = self._row(number, fill)
        elif number == count and self.missing:
            segments = [Segment(f"… {self.missing}", base + rich_style(INK.warn))]
        width = max(self.size.width, self.virtual_size.width)
        strip = Strip(segments).extend_cell_length(width, fill)
        return strip.crop(offset, offset + self.size.width)

    def _head(self, base: Style) -> list[Segment]:
        """Return the names of the columns, each aligned as the first value below it."""
        names = self.shown.columns
        first = self.shown.rows[0] if self.shown.rows else (None,) * len(names)
        return [
            Segment(_fit(visible(name), width, value) + " " * _GAP, base + rich_style(_HEAD))
            for value, name, width in zip(first, names, self._widths, strict=True)
        ]

    def _row(self, number: int, row_style: Style) -> list[Segment]:
        segments = []
        columns = zip(self.shown.rows[number], self._widths, strict=True)
        for column, (value, width) in enumerate(columns):
            text, colour = cell(value, width)
            style = row_style + rich_style(colour)
            if (number, column) in self.shown.changed:
                style += _CHANGED
            if (number, column) == self._at and self.has_focus:
                style = self.rich_style + rich_style(_HERE)
            segments += [Segment(_fit(text, width, value), style), Segment(" " * _GAP, row_style)]
        return segments

    def _measure(self) -> None:
        """Give each column the width it needs, or a fair share if there is too little room."""
        sample = self.shown.rows[:_MEASURED_ROWS]
        widths = [
            max(
                _NARROWEST,
                len(clip(visible(name), _WIDEST)),
                *(cell_len(cell(row[number], _WIDEST)[0]) for row in sample),
            )
            for number, name in enumerate(self.shown.columns)
        ]
        spare = self.size.width - _GAP * len(widths)
        while widths and sum(widths) > spare and max(widths) > 12:
            widest = widths.index(max(widths))
            widths[widest] = max(12, widths[widest] - (sum(widths) - spare))
        self._widths = widths
        lines = len(self.shown.rows) + 1 + bool(self.missing)
        self.virtual_size = Size(sum(widths) + _GAP * len(widths), lines)


def _fit(text: str, width: int, value: Value) -> str:
    """Cut or pad a text; it stands at the right if the value is a number."""
    text = set_cell_size(text, width) if cell_len(text) > width else text
    missing = " " * (width - cell_len(text))
    return missing + text if is_number(value) else text + missing


def _named_rows(table: ResultTable) -> tuple[tuple[str, ...], tuple[Row, ...]]:
    """Return columns and rows; rows that belong to several robots get a column for these."""
    if len(set(table.viewers)) < 2:
        return table.columns, table.rows
    rows = tuple((who, *row) for who, row in zip(table.viewers, table.rows, strict=True))
    return (MIND, *table.columns), rows


def row_count(table: ResultTable, noun: str = "row", suffix: str = "") -> str:
    count = len(table.rows)
    if table.truncated:
        return with_keys(f"first {count:,} {noun}s{suffix}, there are more: {{ask}} narrows down")
    return count_of(count, noun) + suffix
