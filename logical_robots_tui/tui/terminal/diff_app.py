"""An app that sends only cells that differ from what its terminal shows.

Textual repaints whole regions, eight times as much. There is no hook, so ``App._display``
is overridden; a test compares a terminal with a full rendering. A `PaintTarget` paints a widget
without Textual's compositor, which renders all widgets between changed lines, a sixtieth of a
second later; it still sees the current state of the widget.
"""

from __future__ import annotations

import asyncio
import os
import signal
from collections import deque
from collections.abc import Iterator, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

from rich.console import COLOR_SYSTEMS, RenderableType
from rich.segment import Segment
from textual import constants, events
from textual._compositor import ChopsUpdate, CompositorUpdate, LayoutUpdate
from textual.content import Content
from textual.driver import Driver
from textual.geometry import Region
from textual.screen import Screen
from textual.strip import Strip
from textual.widget import Widget

from logical_robots_tui.errors import InputError
from logical_robots_tui.tui.labyrinth.drawing.cells import PAPER, Cells
from logical_robots_tui.tui.terminal.cell_diff import Cell, CellDiff
from logical_robots_tui.tui.terminal.crash_report import CrashSafeApp
from logical_robots_tui.tui.terminal.driver import ListeningDriver, TerminalDriver, drawn_size
from logical_robots_tui.tui.terminal.textual_internals import mark_rendered_stale

if TYPE_CHECKING:
    from logical_robots_tui.clock import Clock

ASK = "\x1b[6n"
"""Asks a terminal for its cursor position; it answers after everything sent before."""

_SYNC_BEGIN, _SYNC_END = "\x1b[?2026h", "\x1b[?2026l"
"""Around what is to appear at once."""

_PATIENCE = 2.0  # seconds after which an answer counts as lost

_ASK_EVERY = 10.0  # seconds; of a terminal that is watched
_SILENT = 12.0  # seconds without an answer after which nothing is drawn any more
_GONE = 40.0  # seconds without an answer after which a terminal is taken for gone

_QUEUE = 0.05  # seconds of data that may queue on the way
_LEAST = 1500  # bytes; less is not worth a query
_LITTLE = 500  # bytes that don't queue
_FIRST = 16_000  # bytes sent at once to an unknown terminal
_MOST = 256_000
_MOST_ASKED = 8  # queries in flight on a long line
_LONG = 1 / 15  # seconds; the longest time between pictures on a long line


class Line:
    """Decides when to send to a terminal, and how much; all times are seconds on one clock.

    Buffers hide how slow a line is, so each output ends in a query (`ASK`) and is in flight
    until the answer. Usually that is one output; with high latency but enough bandwidth, as
    many as fit into the latency. That is measured by a query alone, because even a small
    picture takes time. Before the first answer, answers are not relied upon.
    """

    def __init__(self) -> None:
        self._room = _FIRST
        self._queries: deque[tuple[float, int]] = deque()
        self._least: float | None = None
        self._window = 1
        self._is_measuring = self._is_measured = False

    @property
    def is_to_be_measured(self) -> bool:
        """Whether to measure the latency now, with a query that follows no output."""
        return self._least is not None and not self._is_measured and not self._queries

    @property
    def is_free(self) -> bool:
        return self._least is None or len(self._queries) < self._window

    @property
    def room(self) -> float:
        """The number of bytes to send at once."""
        return inf if self._least is None else self._room

    def note_output(self, size: int, time: float) -> None:
        """Note that `size` bytes and a query were sent; 0 bytes for a measurement."""
        self._is_measuring = not size and not self._queries
        self._queries.append((time, size))

    def note_answer(self, time: float) -> None:
        if not self._queries:
            return
        sent_at, size = self._queries.popleft()
        duration = max(time - sent_at, 0.001)
        self._is_measured = self._is_measured or (self._is_measuring and not self._queries)
        if self._least is None or duration < self._least:
            self._least = duration
        elif size <= _LITTLE and self._window == 1:
            # The latency has increased.
            self._least += (duration - self._least) / 10
        waited = duration - self._least
        if waited > _QUEUE:
            self._window = 1
            self._room = max(_LEAST, int(self._room * _QUEUE / waited))
            return
        if self._is_measured:
            self._window = min(_MOST_ASKED, 1 + int(self._least / _LONG))
        if 2 * size > self._room:
            self._room = min(_MOST, 2 * self._room)

    def forget(self, time: float) -> None:
        """Give up on overdue answers, and forget the measured latency."""
        while self._queries and time - self._queries[0][0] > _PATIENCE:
            self._queries.popleft()
            self._least = None
            self._window = 1
            self._is_measured = False


class DiffApp(CrashSafeApp):
    """Sends only changes, and no more than its terminal can take.

    While output is in flight the content changes; the next output leads to the latest.
    """

    _sent: CellDiff | None = None
    _cursor_sent: tuple[int, int] | None = None
    _is_waiting = False
    _is_watching = False
    _is_synchronized = False

    def __init__(self, clock: Clock) -> None:
        super().__init__()
        self.clock = clock
        self._line = Line()

    def get_driver_class(self) -> type[Driver]:
        """Return the driver that TEXTUAL_DRIVER names, or that of a terminal.

        Raises InputError if it names none.
        """
        if constants.DRIVER is None:
            return TerminalDriver
        from textual.drivers.web_driver import WebDriver

        from logical_robots_tui.tui.terminal.browser import BrowserDriver

        try:
            driver_class = super().get_driver_class()
        except (ImportError, AttributeError, ValueError, RuntimeError):
            name = f"TEXTUAL_DRIVER={constants.DRIVER}"
            hint = "Unset it to play in this terminal."
            raise InputError("This is not a driver of Textual", place=name, hint=hint) from None
        return BrowserDriver if issubclass(driver_class, WebDriver) else driver_class

    def watch_title(self, title: str) -> None:
        self.tell_page("title", title=title)

    def tell_page(self, kind: str, **content: str) -> bool:
        """Send what is not on the screen; return whether the game is in a page of its own."""
        driver: Any = self._driver
        return self.is_web and bool(driver.tell_page(kind, **content))

    def redraw(self) -> None:
        """Send everything again, because the terminal may show something else."""
        if self._sent is not None:
            self._sent.forget()
            self._send()

    def watch_terminal(self) -> None:
        """End as after a hangup when a terminal that used to answer is silent for long.

        sshd notices a client that hangs only after minutes.
        """
        self._is_watching = True
        self.set_interval(_ASK_EVERY, self._ask_terminal)

    def _ask_terminal(self) -> None:
        driver = self._driver
        if not isinstance(driver, ListeningDriver):
            return
        if driver.silence > _GONE:
            os.kill(os.getpid(), signal.SIGHUP)
        else:
            driver.ask(ASK)
            self._line.note_output(0, self.clock.now())

    def terminal(self) -> CellDiff | None:
        """The terminal's state, whose changes are sent soon; None if a full repaint is due."""
        if (
            self._sent is None
            or (self._sent.columns, self._sent.rows) != self.size
            or not self._can_send
        ):
            return None
        asyncio.get_running_loop().call_soon(self._send)
        return self._sent

    def moving_picture(self) -> Region | None:
        """The region that changes by itself, which is sent last."""
        return None

    def on_terminal_supports_synchronized_output(self) -> None:
        self._is_synchronized = True

    async def on_event(self, event: events.Event) -> None:
        """Handle an event; after a resize or resume, the terminal's content is unknown."""
        if isinstance(event, events.CursorPosition):
            self._line.note_answer(event.time)
            self._send()
            return
        if isinstance(event, Driver.SignalResume):
            self._line = Line()
        if isinstance(event, events.Resize | Driver.SignalResume):
            self.redraw()
        if isinstance(event, events.Resize):
            size = drawn_size(event.size)
            event = events.Resize(size, size)
        await super().on_event(event)

    def _display(self, screen: Screen[Any], renderable: RenderableType | None) -> None:
        if not isinstance(renderable, LayoutUpdate | ChopsUpdate) or not self._can_send:
            if isinstance(renderable, CompositorUpdate):
                self._sent = None
            super()._display(screen, renderable)
            return
        columns, rows = self.size
        if self._sent is None or (self._sent.columns, self._sent.rows) != (columns, rows):
            colours = COLOR_SYSTEMS.get(self.console.color_system or "")
            self._sent = CellDiff(columns, rows, colours)
            self._cursor_sent = None
        self._sent.take(_pieces(renderable))
        self._send()
        self.post_display_hook()

    @property
    def _can_send(self) -> bool:
        return self.is_running and isinstance(self._driver, ListeningDriver)

    def _send(self) -> None:
        """Send the difference if the line is free; otherwise the next answer calls this again."""
        driver = self._driver
        if self._sent is None or not self.is_running or not isinstance(driver, ListeningDriver):
            return
        if (self._sent.columns, self._sent.rows) != self.size:
            return  # a full repaint is due
        if self._is_watching and driver.silence > _SILENT:
            return  # the next answer calls this again
        if self._line.is_to_be_measured:
            driver.ask(ASK)
            self._line.note_output(0, self.clock.now())
        if not self._line.is_free:
            if not self._is_waiting:
                self._is_waiting = True
                self.set_timer(_PATIENCE, self._stop_waiting)
            return
        text = self._sent.sequence(self._line.room, self.moving_picture())
        cursor = self.screen.outer_size.clamp_offset(self.cursor_position)
        if text or cursor != self._cursor_sent:
            self._cursor_sent = cursor
            begin, end = (_SYNC_BEGIN, _SYNC_END) if self._is_synchronized else ("", "")
            driver.write(f"{begin}{text}\x1b[{cursor[1] + 1};{cursor[0] + 1}H{end}")
            driver.ask(ASK)
            self._line.note_output(len(text.encode()), self.clock.now())

    def _stop_waiting(self) -> None:
        self._is_waiting = False
        self._line.forget(self.clock.now())
        self._send()


def _pieces(update: LayoutUpdate | ChopsUpdate) -> Iterator[tuple[int, int, Sequence[Segment]]]:
    """Yield the (row, first column, segments) that a Textual update paints."""
    if isinstance(update, LayoutUpdate):
        for y, strips in enumerate(update.strips, update.region.y):
            yield y, update.region.x, [segment for strip in strips for segment in strip]
        return
    for y, first, stop in update.spans:
        for end, (x, strip) in zip(update.chop_ends[y], update.chops[y].items(), strict=False):
            # Parts of a line beyond the span are up to date.
            if strip is not None and x < stop and end > first:
                yield y, x, list(strip)


class PaintTarget:
    """A widget's place on the terminal, with borders, in cells, and what covers it."""

    def __init__(self, terminal: CellDiff, region: Region, over: Sequence[Region]) -> None:
        self._terminal = terminal
        self._region = region
        self._over = over

    def put(self, cells: Cells, spans: Sequence[tuple[int, int, int]]) -> None:
        """Show changed spans, (row, first column, column after the last), of a widget's cells."""
        looks = self._terminal.looks
        for row, first, stop in spans:
            for start, end in self._free(row, first, stop):
                line: list[Cell] = [
                    # A blank looks the same in any foreground colour.
                    (text, looks[style if text != " " else style & PAPER])
                    for text, style in cells.row(row, start, end)
                ]
                if cells.is_cut(row, start):
                    line[0] = " ", line[0][1]
                if cells.is_cut(row, end):
                    line[-1] = " ", line[-1][1]
                self._terminal.put(self._region.y + row, self._region.x + start, line)

    def paint(self, widget: OneLine) -> bool:
        """Show the whole widget; return False if something covers it."""
        if self._over:
            return False
        region = self._region.size.region
        mark_rendered_stale(widget, [region])
        (line,) = widget.render_lines(region)
        self._terminal.take([(self._region.y, self._region.x, list(line))])
        return True

    def _free(self, row: int, first: int, stop: int) -> Iterator[tuple[int, int]]:
        x, y = self._region.offset
        for region in sorted(self._over):
            if region.y <= y + row < region.bottom:
                if first < min(stop, region.x - x):
                    yield first, min(stop, region.x - x)
                first = max(first, region.right - x)
        if first < stop:
            yield first, stop


def paint_target_of(widget: Widget) -> PaintTarget | None:
    """Return a widget's place; None if it is partly hidden."""
    app = widget.app
    if not isinstance(app, DiffApp) or not widget.is_attached or widget.screen is not app.screen:
        return None
    if (terminal := app.terminal()) is None:
        return None
    covers: list[Region] = []
    for node, (region, clip) in widget.screen._compositor.visible_widgets.items():
        if node is widget:
            covers = [overlap for cover in covers if (overlap := cover.intersection(region))]
            return PaintTarget(terminal, region, covers) if clip.contains_region(region) else None
        covers.append(region.intersection(clip))
    return None


class OneLine(Widget):
    """A widget of one line, which is painted directly where it can be."""

    def render(self) -> Content:
        return Content("")

    def render_line(self, y: int) -> Strip:
        """Return the line directly; Textual would search it for line breaks."""
        del y
        strip = Strip(self.render().render_segments(self.visual_style))
        return strip.adjust_cell_length(self.size.width, self.rich_style)

    def repaint(self) -> None:
        spot = paint_target_of(self)
        if spot is None or not spot.paint(self):
            self.refresh()
