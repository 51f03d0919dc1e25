"""The page that watches: what is pinned, its value at the tick at hand, and how it went."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.content import Content
from textual.geometry import Region
from textual.message import Message

from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.inspector.widgets.cells import cell
from logical_robots_tui.tui.inspector.widgets.lines import LinesView
from logical_robots_tui.tui.inspector.widgets.sparkline import scale, sparkline
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.tui.theme.themes import INK, rich_style
from logical_robots_tui.tui.timeline.widget import Timeline

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.style import Style
    from textual import events

    from logical_robots_tui.game import Pin, Reading
    from logical_robots_tui.tui.inspector.widgets.samples import Samples

__all__ = ["WatchView"]

_NOTHING = (
    "Nothing is pinned. {pin} pins the predicate that is inspected, the value under the cursor, or "
    "the chosen robot's memory; in the tree of a value it pins a part."
)
_KEYS = "enter open  ← → to where it changes  del unpin"
_HERE = "on $here"
_INDENT = 2
_SCALE = 17  # columns for the lowest and the highest number
_LINES = 2  # of each pin


class WatchView(LinesView):
    """Two lines for each pin: its value, and how it was in the ticks around.

    Args:
        samples: What is known of these ticks.
    """

    DEFAULT_CSS = """
    WatchView { margin: 0 1; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("up", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("left", "change(-1)", show=False),
        Binding("right", "change(1)", show=False),
        Binding("enter", "open", show=False),
        Binding("delete,backspace", "remove", show=False),
    ]

    class Opened(Message):
        """The player wants to see the predicate of a pin.

        Attributes:
            predicate: Its name.
        """

        def __init__(self, predicate: str) -> None:
            super().__init__()
            self.predicate = predicate

    class Changed(Message):
        """There are other pins, or there is room for other ticks."""

    def __init__(self, samples: Samples) -> None:
        super().__init__(id="watch")
        self._samples = samples
        self._pins: list[Pin] = []
        self._readings: Mapping[Pin, Reading] = {}
        self._tick = 0
        self._at = 0
        self._plain = False

    @property
    def pins(self) -> tuple[Pin, ...]:
        """What is pinned, in the order in which it was."""
        return tuple(self._pins)

    @property
    def pointed(self) -> Pin | None:
        """The pin under the cursor."""
        return self._pins[self._at] if self._pins else None

    @property
    def ticks(self) -> range:
        """The ticks that the lines show."""
        return self._samples.window(max(1, self.columns - _INDENT - _SCALE))

    def toggle(self, pin: Pin) -> bool:
        """Pin something, or unpin it; whether it is pinned then."""
        is_new = pin not in self._pins
        if is_new:
            self._pins.append(pin)
        else:
            self._pins.remove(pin)
        self._at = min(self._at, max(0, len(self._pins) - 1))
        self._draw()
        self.post_message(self.Changed())
        return is_new

    def show(self, tick: int, readings: Mapping[Pin, Reading], *, plain: bool) -> None:
        """Show a tick.

        Args:
            tick: Which one.
            readings: What was read off the pins at it.
            plain: Whether to draw with characters that every terminal has.
        """
        self._tick, self._readings, self._plain = tick, readings, plain
        self._draw()

    def on_resize(self) -> None:
        """Use the width there is now; more ticks may have room in it."""
        self._draw()
        self.post_message(self.Changed())

    def on_focus(self) -> None:
        """Show the cursor."""
        self._draw()

    def on_blur(self) -> None:
        """Hide the cursor."""
        self._draw()

    def on_click(self, event: events.Click) -> None:
        """Go to a tick of a line, or put the cursor on a pin."""
        number, line = divmod(event.y + self.scroll_offset.y, _LINES)
        if number < len(self._pins):
            self.action_move(number - self._at)
            place = event.x - _INDENT
            if line and 0 <= place < len(self.ticks):
                self.post_message(Timeline.Pointed(self.ticks[place]))

    def action_move(self, down: int) -> None:
        """Move the cursor."""
        if self._pins:
            self._at = max(0, min(self._at + down, len(self._pins) - 1))
            self._draw()
            area = Region(0, self._at * _LINES, 1, _LINES)
            self.scroll_to_region(area, animate=False, force=True)

    def action_change(self, way: int) -> None:
        """Go to the next tick, or the one before, at which the pin has another value.

        Where nothing is known any more one stops, and more will be known then.
        """
        if not self._pins:
            return
        ticks = self.ticks
        samples = self._samples.of(self._pins[self._at], ticks)
        known = {tick: sample for tick, sample in zip(ticks, samples, strict=True) if sample}
        tick = self._tick
        while tick + way in known:
            tick += way
            if tick - 1 in known and known[tick] != known[tick - 1]:
                break
        if tick != self._tick:
            self.post_message(Timeline.Pointed(tick))

    def action_open(self) -> None:
        """Show the predicate of the pin under the cursor."""
        if self._pins:
            self.post_message(self.Opened(self._pins[self._at].predicate))

    def action_remove(self) -> None:
        """Unpin what is under the cursor."""
        if self._pins:
            self.toggle(self._pins[self._at])

    def fill(self, number: int) -> Style:
        """The style behind the end of a line."""
        is_here = self.has_focus and self._pins and number // _LINES == self._at
        return self.rich_style + rich_style(_HERE) if is_here else self.rich_style

    def _draw(self) -> None:
        if self.columns <= 0:
            return
        ticks = self.ticks
        lines: list[Content] = []
        for number, pin in enumerate(self._pins):
            pair = self._value(pin), self._course(pin, ticks)
            is_here = number == self._at and self.has_focus
            lines += [each.stylize_before(_HERE) for each in pair] if is_here else pair
        if lines:
            words = f"{_KEYS}  ticks {ticks[0]} to {ticks[-1]}"
            lines += [Content(""), Content.styled(clip(words, self.columns), INK.dim)]
        else:
            lines = Content.styled(with_keys(_NOTHING), INK.dim).wrap(self.columns)
        self.paint(lines)

    def _value(self, pin: Pin) -> Content:
        """The pin's name and, at the right end, its value at the tick at hand."""
        reading = self._readings.get(pin)
        if reading is None:
            value = Content("")
        elif reading.problem:
            value = Content.styled(clip(one_line(reading.problem), self.columns // 2), INK.warn)
        else:
            value = Content.styled(*cell(reading.value, self.columns // 2))
        room = max(1, self.columns - value.cell_length - 1)
        name = Content.styled(one_line(pin.words), INK.text).truncate(room, ellipsis=True)
        return name.pad_right(room + 1 - name.cell_length).append(value)

    def _course(self, pin: Pin, ticks: range) -> Content:
        """How the value was in the ticks around; the tick at hand is brought out."""
        samples, counts = self._samples.of(pin, ticks), not pin.column
        line = sparkline(samples, counts=counts, plain=self._plain)
        here = self._tick - ticks.start
        found = scale(samples, counts=counts)
        words = " to ".join(f"{number:.4g}" for number in dict.fromkeys(found or ()))
        return Content.assemble(
            " " * _INDENT,
            (line[:here], INK.number),
            (line[here : here + 1], f"{INK.key} reverse"),
            (f"{line[here + 1 :]} ", INK.number),
            (words, INK.dim),
        )
