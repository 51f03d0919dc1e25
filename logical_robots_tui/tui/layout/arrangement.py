"""The panes on the screen: which are shown, and how large."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, NamedTuple, Self

from rich.cells import cell_len
from textual import events
from textual.containers import Container
from textual.content import Content
from textual.geometry import Offset, Size
from textual.message import Message
from textual.widget import Widget
from textual.widgets import Static

from logical_robots_tui.tui.app.ui import widget_at
from logical_robots_tui.tui.commands.keymap import key_of
from logical_robots_tui.tui.labyrinth.drawing.viewport import CELL_ASPECT
from logical_robots_tui.wording import visible


class Pane(Container):
    """A part of the screen with a title; every layout uses the same instance."""

    DEFAULT_CSS = """
    Pane {
        border: round $frame; border-title-color: $ink-dim; border-subtitle-color: $ink-dim;
        border-title-style: none; background: $surface; width: 1fr; height: 1fr;
    }
    Pane > .note {
        dock: bottom; height: auto; padding: 0 1; background: $odd-strip; color: $foreground;
    }
    Pane:focus-within, Pane:focus { border: round $frame-here; border-title-color: $ink-title; }
    """

    command_id: ClassVar[str]

    class Retitled(Message):
        """The title has changed."""

    @dataclass
    class Pulled(Message):
        """An edge is dragged with the mouse, by columns and rows since the last message."""

        pane: Pane
        side: str
        moved: Offset

    @dataclass
    class Filled(Message):
        """A page has been chosen, or a run has ended; `rows` is the height for its content."""

        rows: int

    def __init__(self, *children: Widget, title: str) -> None:
        super().__init__(*children, id=self.command_id)
        self._held: tuple[str, Offset] | None = None
        self._heading = title
        self._note = ""
        self._bottom_line: Static | None = None
        self._set_border_title()

    @property
    def label(self) -> str:
        return f"{self._heading} · {self._note}" if self._note else self._heading

    def note(self, text: str) -> None:
        if text != self._note:
            self._note = visible(text)
            self._set_border_title()
            self.post_message(self.Retitled())

    def note_below(self, text: str) -> None:
        """Show a line at the bottom of the pane, or none."""
        if self._bottom_line is None and text:
            self._bottom_line = Static(classes="note", markup=False)
            self.mount(self._bottom_line)
        if self._bottom_line is not None:
            self._bottom_line.update(text)
            self._bottom_line.display = bool(text)

    def on_mouse_down(self, event: events.MouseDown) -> None:
        sides = {
            "left": event.x == 0,
            "right": event.x == self.outer_size.width - 1,
            "top": event.y == 0,
            "bottom": event.y == self.outer_size.height - 1,
        }
        side = next((side for side, is_there in sides.items() if is_there), None)
        # Events of children bubble up to the pane.
        if side is not None and widget_at(self.screen, *event.screen_offset) is self:
            self._held = (side, event.screen_offset)
            self.capture_mouse()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        if self._held is not None:
            side, previous_offset = self._held
            self._held = (side, event.screen_offset)
            self.post_message(self.Pulled(self, side, event.screen_offset - previous_offset))

    def on_mouse_up(self) -> None:
        if self._held is not None:
            self._held = None
            self.release_mouse()

    def enter(self) -> None:
        """Focus the main widget at once, because the next key belongs to it."""
        raise NotImplementedError

    def on_resize(self) -> None:
        self._set_border_title()

    def _set_border_title(self) -> None:
        """Put the pane's key for its heading where that would cut what is beside it."""
        title = self.label
        if self._note and cell_len(title) > self.outer_size.width - _TITLE_EDGES:
            title = f"{key_of(self.command_id)} · {self._note}"
        self.border_title = Content(title)


_TITLE_EDGES = 6  # columns of the border beside its title
LEAST_WIDTH, LEAST_HEIGHT = 40, 12
_WIDE_FROM = (100, 24)
_TALL_FROM = 46
_NARROWEST, _LOWEST = 30, 6  # the smallest columns and rows of a pane, with its border

_LEAST_TEXT, _WIDEST_TEXT = 70, 96
"""Columns of the program below which it leaves none to the labyrinth, and above which all."""
_LEAST_TABLE, HIGHEST_TABLE = 10, 26
"""Rows of the inspector below which it leaves none to the labyrinth, and above which all."""
_BESIDE_TEXT, _BELOW_TEXT = 9, 3  # line numbers, cursor, bar and border; help and border


class ScreenLayout(Enum):
    """Layouts; the values are CSS classes of the screen."""

    WIDE = "-wide"
    """All panes at once: the program beside the labyrinth, the inspector below."""
    TALL = "-tall"
    """All panes at once, stacked."""
    NARROW = "-narrow"
    """One pane at a time, under tabs."""
    TINY = "-tiny"
    """No pane, only a request for a larger terminal."""

    @property
    def is_roomy(self) -> bool:
        return self in (ScreenLayout.WIDE, ScreenLayout.TALL)


class Needs(NamedTuple):
    """What the panes hold when a level or a program is opened.

    `aspect` is the width of the map by its height, `lines` are the lengths of the program's lines,
    `code` that of the longest one which is not a comment. `rows` are what the inspector shows, most
    of all pages since then.
    """

    aspect: float = math.inf
    lines: tuple[int, ...] = ()
    code: int = _WIDEST_TEXT
    rows: int = HIGHEST_TABLE

    @classmethod
    def of(cls, aspect: float, text: str, rows: int) -> Self:
        lines = text.split("\n")
        code = (len(line) for line in lines if not line.lstrip().startswith("#"))
        return cls(aspect, tuple(map(len, lines)), max(code, default=0), rows)

    def program_rows(self, columns: int) -> int:
        room = max(columns - _BESIDE_TEXT, 1)
        return sum(max(math.ceil(length / room), 1) for length in self.lines) + _BELOW_TEXT

    def map_rows(self, columns: int) -> int:
        """Rows of the labyrinth above which the map has nothing to fill them with."""
        return math.ceil((columns - 2) / (CELL_ASPECT * self.aspect)) + 2


class Shares(NamedTuple):
    """The player's additional columns of the program, and rows of the inspector.

    The rows are also those of the program where it is below the labyrinth.
    """

    columns: int = 0
    rows: int = 0


class Grid(NamedTuple):
    """Sizes of panes in cells; the labyrinth gets the rest.

    `program` is columns beside the labyrinth, otherwise rows; `inspector` is rows.
    """

    program: int
    inspector: int
    shares: Shares


def layout_for(width: int, height: int) -> ScreenLayout:
    if width < LEAST_WIDTH or height < LEAST_HEIGHT:
        return ScreenLayout.TINY
    if width >= _WIDE_FROM[0] and height >= _WIDE_FROM[1]:
        return ScreenLayout.WIDE
    return ScreenLayout.TALL if height >= _TALL_FROM else ScreenLayout.NARROW


def grid_for(layout: ScreenLayout, width: int, height: int, shares: Shares, needs: Needs) -> Grid:
    """Return the sizes of panes; cells that the map has no use for go to the others."""
    room = height - 3  # status, timeline and command bar
    table_rows = max(needs.rows + 2, _LEAST_TABLE)
    inspector = min(table_rows, max(round(0.3 * height), _LEAST_TABLE), HIGHEST_TABLE)
    if layout is not ScreenLayout.WIDE:
        map_rows = needs.map_rows(width)
        used = max(map_rows + needs.program_rows(width), 2 * _LOWEST)
        inspector = max(inspector, min(table_rows, room - used))
        higher = _clamp(inspector + shares.rows, _LOWEST, room - 2 * _LOWEST)
        left = room - higher
        program = max(left // 2, left - map_rows)
        return Grid(program, higher, Shares(shares.columns, higher - inspector))
    usual = min(round(width * 4 / 9), _WIDEST_TEXT)
    least_columns = _clamp(needs.code + _BESIDE_TEXT, min(_LEAST_TEXT, usual), usual)
    beside = width - CELL_ASPECT * needs.aspect * (room - inspector - 2) - 2  # what the map leaves
    program = int(min(max(beside, least_columns), _WIDEST_TEXT, width - _NARROWEST))
    used = max(needs.map_rows(width - program), needs.program_rows(program), _LOWEST)
    inspector = max(inspector, min(table_rows, room - used))
    wider = _clamp(program + shares.columns, _NARROWEST, width - _NARROWEST)
    higher = _clamp(inspector + shares.rows, _LOWEST, room - _LOWEST)
    return Grid(wider, higher, Shares(wider - program, higher - inspector))


def _clamp(number: int, low: int, high: int) -> int:
    return min(max(number, low), max(high, low))


class Arrangement:
    def __init__(self, panes: tuple[Pane, Pane, Pane]) -> None:
        self.container = Container(*panes, id="panes")
        """The container of the panes."""
        self.panes = panes
        """All panes, including hidden ones."""
        self.active: Pane = panes[0]
        """The active pane; it is never hidden."""
        self.layout = ScreenLayout.WIDE
        """The layout for the terminal's size."""
        self.is_one_large = False
        """Whether the active pane fills the screen."""
        self._size = Size()
        self._hidden: set[Pane] = set()
        self._shares = Shares()
        self._needs = Needs()

    @property
    def is_tiny(self) -> bool:
        return self.layout is ScreenLayout.TINY

    def covers(self, pane: Pane) -> bool:
        return self.layout is ScreenLayout.NARROW and self.active is not pane

    def fit(self, size: Size) -> None:
        self._size = size
        self.layout = layout_for(*size)
        self.show()

    def suit(self, needs: Needs) -> None:
        """Take sizes that suit a level and its program, but for those that the player chose."""
        previous_needs = self._needs
        if self._shares.rows:
            needs = needs._replace(rows=previous_needs.rows)
        if self._shares.columns:
            needs = previous_needs._replace(rows=needs.rows)
        self._needs = needs
        self.show()

    def grow(self, rows: int) -> None:
        """Give the inspector as many rows if the others can spare them; it keeps them."""
        if rows > self._needs.rows and not self._shares.rows:
            self._needs = self._needs._replace(rows=rows)
            self.show()

    def show(self) -> None:
        self._hidden.discard(self.active)
        for pane in self.panes:
            if self.layout.is_roomy and not self.is_one_large:
                pane.display = pane not in self._hidden
            else:
                pane.display = not self.is_tiny and pane is self.active
        if self.layout.is_roomy:
            self._lay_out(self._grid)

    @property
    def _grid(self) -> Grid:
        return grid_for(self.layout, *self._size, self._shares, self._needs)

    def beside_active(self, steps: int) -> Pane:
        """Return the pane some places after the active one, wrapping around."""
        return self.panes[(self.panes.index(self.active) + steps) % len(self.panes)]

    def focused(self) -> bool:
        for pane in self.panes:
            if pane.has_focus_within:
                self.active = pane
                return True
        return False

    def note(self, text: str) -> None:
        """Show a line in the active pane, until the next one or "" takes its place."""
        for pane in self.panes:
            pane.note_below(text if pane is self.active else "")

    def toggle_large(self) -> None:
        self.is_one_large = not self.is_one_large
        self.show()

    def hide(self, pane: Pane) -> Pane:
        """Hide a pane and return the pane to focus; if one is already hidden, show all instead."""
        if self._hidden:
            self._hidden.clear()
            return pane
        self._hidden.add(pane)
        # Not the program: the next key would be typed into it.
        labyrinth, _, inspector = self.panes
        return inspector if pane is labyrinth else labyrinth

    def change(self, columns: int, rows: int) -> None:
        self._shares = Shares(self._shares.columns + columns, self._shares.rows + rows)
        if self.layout.is_roomy:
            self._shares = self._grid.shares
        self.show()

    def pull(self, pane: Pane, side: str, columns: int, rows: int) -> None:
        """Move an edge of a pane, and what is beyond it; outer edges stay.

        `columns` count to the right, `rows` down.
        """
        labyrinth, program, inspector = self.panes
        beside = self.layout is ScreenLayout.WIDE
        if beside and (pane, side) in ((labyrinth, "right"), (program, "left")):
            self.change(-columns, 0)
        above = (labyrinth, program) if beside else (program,)
        if (pane, side) == (inspector, "top") or (pane in above and side == "bottom"):
            self.change(0, -rows)

    def _lay_out(self, grid: Grid) -> None:
        labyrinth, program, inspector = self.panes
        beside = self.layout is ScreenLayout.WIDE and labyrinth.display and program.display
        rows = ["1fr"] if labyrinth.display or program.display else []
        if labyrinth.display and program.display and not beside:
            rows.append(str(grid.program))
        if inspector.display:
            rows.append(str(grid.inspector) if rows else "1fr")
        styles = self.container.styles
        styles.grid_size_columns = 2 if beside else 1
        styles.grid_size_rows = len(rows)
        styles.grid_columns = f"1fr {grid.program}" if beside else "1fr"
        styles.grid_rows = " ".join(rows)
        inspector.styles.column_span = 2 if beside else 1
