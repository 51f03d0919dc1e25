"""The Watch page: pinned values at the current tick, and a plot of the ticks around it."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from textual.content import Content
from textual.worker import Worker

from logical_robots_tui.game import Frame, NoSuchTickError, Superseded
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.line_views import CursorView
from logical_robots_tui.tui.inspector.page import Page, PageEntry, Traced, traced_pin
from logical_robots_tui.tui.inspector.plots import PlotSample, ink_value, scale, sparkline
from logical_robots_tui.tui.inspector.questions import MOST_ROBOTS, InspectorQuestions
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.view import LabyrinthView
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.tui.timeline.widget import Timeline
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game import Pin, PinReading

_NOTHING = (
    "Nothing is pinned. {pin} pins the selected predicate, the value under the cursor, or the "
    "chosen robot's memory; in the tree of a value it pins a part."
)
_KEYS = "enter open  ← → to where it changes  {origin} why  del unpin"
_INDENT = 2
_SCALE = 17  # columns for the lowest and the highest number

_PAUSE = 0.03  # seconds between two past ticks while the robots run, which comes first
_REDRAW = 0.1  # seconds between two redraws while past ticks are read
_MOST_TICKS = 2000


class WatchView(CursorView):
    """Two lines per pin: its value, and a plot of its values at nearby ticks."""

    BINDINGS = [
        ("left", "change(-1)"),
        ("right", "change(1)"),
        ("enter", "open"),
        ("delete,backspace", "remove"),
    ]

    def __init__(self, page: WatchPage) -> None:
        super().__init__(id="watch")
        self.ticks = range(0)
        self._page, self._samples = page, page.samples
        self.pins: tuple[Pin, ...] = ()
        self._readings: Mapping[Pin, PinReading] = {}
        self._tick = 0
        self._plain = False

    @property
    def pointed(self) -> Pin | None:
        return self.pins[self._at] if self.pins else None

    @property
    def room(self) -> int:
        return max(1, self.columns - _INDENT - _SCALE)

    def toggle(self, pin: Pin) -> bool:
        is_new = pin not in self.pins
        pins = tuple(old_pin for old_pin in self.pins if old_pin != pin)
        self.pins = (*pins, pin) if is_new else pins
        self.redraw()
        return is_new

    def show(
        self, ticks: range, tick: int, readings: Mapping[Pin, PinReading], plain: bool
    ) -> None:
        self.ticks, self._tick, self._readings, self._plain = ticks, tick, readings, plain
        super().redraw()

    def redraw(self) -> None:
        """Draw at the current width, and request as many ticks as fit."""
        super().redraw()
        if self._page.display:
            self.post_message(Page.Changed())

    def clicked(self, x: int, line: int, *, again: bool) -> None:
        place = x - _INDENT
        if line and 0 <= place < len(self.ticks):
            self.post_message(Timeline.TickPointed(self.ticks[place]))

    def action_change(self, step: int) -> None:
        if self.pointed is None:
            return
        samples = self._samples.lookup(self.pointed, self.ticks)
        by_tick = {tick: sample for tick, sample in zip(self.ticks, samples, strict=True) if sample}
        tick = self._tick
        while tick + step in by_tick:
            tick += step
            if tick - 1 in by_tick and by_tick[tick] != by_tick[tick - 1]:
                break
        if tick != self._tick:
            self.post_message(Timeline.TickPointed(tick))

    def action_open(self) -> None:
        if self.pointed is not None:
            self.post_message(Page.LinkOpened(self.pointed.predicate))

    def action_remove(self) -> None:
        if self.pointed is not None:
            self.toggle(self.pointed)

    def draw(self) -> None:
        if self.pins and self.ticks:
            words = f"{with_keys(_KEYS)}  ticks {self.ticks[0]} to {self.ticks[-1]}"
            footer = [Content(""), Content.styled(clip(words, self.columns), INK.dim)]
        else:
            footer = Content.styled(with_keys(_NOTHING), INK.dim).wrap(self.columns)
        self.paint_items([(self._value(pin), self._plot(pin)) for pin in self.pins], footer)

    def _value(self, pin: Pin) -> Content:
        reading, half = self._readings.get(pin), self.columns // 2
        value = Content("")
        if reading is not None:
            problem = clip(one_line(reading.problem), half), INK.warn
            value = Content.styled(
                *(problem if reading.problem else ink_value(reading.value, half))
            )
        room = max(1, self.columns - value.cell_length - 1)
        name = Content.styled(one_line(pin.words), INK.text).truncate(room, ellipsis=True)
        return name.pad_right(room + 1 - name.cell_length).append(value)

    def _plot(self, pin: Pin) -> Content:
        samples, counts = self._samples.lookup(pin, self.ticks), not pin.column
        line = sparkline(samples, counts=counts, plain=self._plain)
        index = self._tick - self.ticks.start
        bounds = scale(samples, counts=counts)
        words = " to ".join(f"{number:.4g}" for number in dict.fromkeys(bounds or ()))
        return Content.assemble(
            " " * _INDENT,
            (line[:index], INK.number),
            (line[index : index + 1], f"{INK.key} reverse"),
            (f"{line[index + 1 :]} ", INK.number),
            (words, INK.dim),
        )


def _window(old_ticks: range, width: int, tick: int, last: int) -> range:
    """Return the ticks to plot; they stay the same while they include the current tick."""
    stop = max(old_ticks.stop, tick + 1)
    if tick < stop - width:
        stop = tick + width // 2
    stop = max(min(stop, last + 1), tick + 1)
    return range(max(0, stop - width), stop)


class _PinHistory:
    """Reads pins at ticks; caches the values until the program or the run changes."""

    def __init__(self, questions: InspectorQuestions) -> None:
        self._session, self._questions = questions.session, questions
        self._run_key: object = None
        self._ticks: dict[int, dict[Pin, PlotSample]] = {}

    def lookup(self, pin: Pin, ticks: range) -> list[PlotSample | None]:
        return [self._ticks.get(tick, {}).get(pin) for tick in ticks]

    def missing(self, pins: Sequence[Pin], ticks: range) -> tuple[int, list[Pin]] | None:
        game, current_tick = self._session.game, self._session.frame.tick
        if game is None or len(self._session.level.robots) > MOST_ROBOTS:
            return None
        for tick in sorted(ticks, key=lambda tick: abs(tick - current_tick)):
            stored_samples = self._ticks.get(tick, {})
            missing_pins = [pin for pin in pins if pin not in stored_samples]
            if missing_pins and game.history.first <= tick <= game.history.last:
                return tick, missing_pins
        return None

    async def read(self, pins: Iterable[Pin], frame: Frame) -> dict[Pin, PinReading]:
        """Read pins at a frame; raises Superseded without a program or after a newer call."""
        run_key = self._questions.run_key
        if run_key != self._run_key:
            self._run_key, self._ticks = run_key, {}
        inquiry, program = self._questions.context()
        readings = await inquiry.readings(program, frame, list(pins))
        if run_key == self._run_key:
            stored_samples = self._ticks.setdefault(frame.tick, {})
            for pin, reading in readings.items():
                likeness = None if reading.problem else hash(repr(reading.value))
                number = None if reading.problem else reading.number
                stored_samples[pin] = PlotSample(number, likeness)
            if len(self._ticks) > _MOST_TICKS:
                del self._ticks[next(iter(self._ticks))]
        return readings


class WatchPage(Page):
    """Reads the pins at the current tick first, then at nearby ticks."""

    view: WatchView

    def __init__(self, entry: PageEntry, questions: InspectorQuestions) -> None:
        self.samples = _PinHistory(questions)
        super().__init__(entry, questions, WatchView(self))
        self._shown: tuple[int, Mapping[Pin, PinReading]] = 0, {}
        self._is_reading = False
        self._filler: Worker[None] | None = None

    async def show(self, frame: Frame) -> None:
        self.head(frame.tick)
        self._is_reading = True
        try:
            self._shown = frame.tick, await self.samples.read(self.view.pins, frame)
        except Superseded:
            self._shown = frame.tick, {}
        finally:
            self._is_reading = False
        self._show()
        if self._filler is None or self._filler.is_finished:
            self._filler = in_background(self, self._read_around, "watch")

    def begin(self, subject: Pin) -> None:
        """Pin a value, or no longer."""
        if self.view.toggle(subject):
            hint = with_keys("{watch} shows what is pinned.")
            self.notify(f"Pinned: {one_line(subject.words)}. {hint}", markup=False)
        else:
            self.notify(f"No longer pinned: {one_line(subject.words)}.", markup=False)

    def pin_here(self) -> Pin | None:
        return self.view.pointed if self.view.has_focus else None

    def traced_here(self) -> Traced | None:
        return traced_pin(self.view.pointed, self.robot, self._session.frame.tick)

    async def _read_around(self) -> None:
        shown_at = self._session.clock.now()
        while self.display and (missing := self.samples.missing(self.view.pins, self.view.ticks)):
            (tick, pins), game = missing, self._session.game
            if game is not None and not self._is_reading:
                with suppress(Superseded, NoSuchTickError):
                    await self.samples.read(pins, game.frame_at(tick))
            if self._session.clock.now() > shown_at + _REDRAW:
                shown_at = self._session.clock.now()
                self._show()
            await asyncio.sleep(_PAUSE if self._session.running or self._is_reading else 0)
        self._show()

    def _show(self) -> None:
        views = self.screen.query(LabyrinthView)
        plain = any(view.drawing is Drawing.ASCII for view in views)
        game, (tick, readings) = self._session.game, self._shown
        last = tick if game is None else game.history.last
        ticks = _window(self.view.ticks, self.view.room, tick, last)
        self.view.show(ticks, tick, readings, plain)
