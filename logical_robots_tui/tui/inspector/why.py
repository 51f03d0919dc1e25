"""Why, in the inspector: each rule part by part, to walk through with a cursor."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.content import Content
from textual.geometry import Region
from textual.message import Message

from logical_robots_tui.tui.inspector.cells import cell, written
from logical_robots_tui.tui.inspector.lines import LinesView
from logical_robots_tui.tui.plain import clip, one_line
from logical_robots_tui.tui.theme import INK, rich_style

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.style import Style
    from textual import events

    from logical_robots_tui.mind import Ask, Line
    from logical_robots_tui.values import Value

__all__ = ["WhyView"]

_MARKS = {True: ("✓ ", INK.good), False: ("✗ ", INK.bad), None: ("  ", INK.dim)}
_HERE = "on $here"
_DEEPER = " →"
_WIDEST_VALUE = 60


class WhyView(LinesView):
    """The lines of an explanation. Enter goes one step deeper, left comes back."""

    DEFAULT_CSS = """
    WhyView { margin: 0 1; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("up", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("pageup", "move(-10)", show=False),
        Binding("pagedown", "move(10)", show=False),
        Binding("home", "move(-100000)", show=False),
        Binding("end", "move(100000)", show=False),
        Binding("enter,right", "deeper", show=False),
        Binding("left,backspace", "back", show=False),
    ]

    class Pointed(Message):
        """The cursor is on another line.

        Attributes:
            line: The line.
        """

        def __init__(self, line: Line) -> None:
            super().__init__()
            self.line = line

    class Deeper(Message):
        """The player asks one step deeper.

        Attributes:
            asked: What is asked.
        """

        def __init__(self, asked: Ask) -> None:
            super().__init__()
            self.asked = asked

    class Back(Message):
        """The player wants the question before."""

    def __init__(self) -> None:
        super().__init__(id="why")
        self._told: tuple[Line, ...] = ()
        self._at = 0

    @property
    def lines(self) -> tuple[Line, ...]:
        """What is shown."""
        return self._told

    @property
    def pointed(self) -> Line | None:
        """The line under the cursor."""
        return self._told[self._at] if self._told else None

    def show(self, lines: Sequence[Line], *, anew: bool) -> None:
        """Show the lines of an explanation.

        Args:
            lines: The lines.
            anew: Whether this is another question, so that the cursor begins at the top.
        """
        self._told = tuple(lines)
        self._at = 0 if anew else max(0, min(self._at, len(lines) - 1))
        self._draw()
        if anew:
            self.scroll_to(y=0, animate=False)

    def on_resize(self) -> None:
        """Use the width there is now."""
        self._draw()

    def on_focus(self) -> None:
        """Show the cursor."""
        self._draw()
        self._tell()

    def on_blur(self) -> None:
        """Hide the cursor."""
        self._draw()

    def on_click(self, event: events.Click) -> None:
        """Put the cursor on a line; a second click goes deeper."""
        number = event.y + self.scroll_offset.y
        if number == self._at:
            self.action_deeper()
        else:
            self.action_move(number - self._at)

    def action_move(self, down: int) -> None:
        """Move the cursor."""
        if not self._told:
            return
        self._at = max(0, min(self._at + down, len(self._told) - 1))
        self._draw()
        self.scroll_to_region(Region(0, self._at, 1, 1), animate=False, force=True)
        self._tell()

    def action_deeper(self) -> None:
        """Ask about what the line under the cursor has asked."""
        pointed = self.pointed
        if pointed is not None and pointed.asked is not None:
            self.post_message(self.Deeper(pointed.asked))

    def action_back(self) -> None:
        """Return to the question before."""
        self.post_message(self.Back())

    def fill(self, number: int) -> Style:
        """The style behind the end of a line."""
        here = number == self._at and self.has_focus
        return self.rich_style + rich_style(_HERE) if here else self.rich_style

    def _tell(self) -> None:
        if self.pointed is not None:
            self.post_message(self.Pointed(self.pointed))

    def _draw(self) -> None:
        if self.columns > 0:
            lines = [_painted(each, self.columns) for each in self._told]
            if lines and self.has_focus:
                lines[self._at] = lines[self._at].stylize_before(_HERE)
            self.paint(lines)


def _painted(line: Line, width: int) -> Content:
    """A line in its colours, cut to a width; what is said about it is never cut off."""
    mark, colour = _MARKS[line.holds]
    before = Content.assemble("  " * line.depth, (mark, colour))
    after = Content("")
    if line.kind == "value":
        after = Content(" = ").join([Content(""), _values(line)])
    elif line.said:
        said = INK.bad if line.holds is False and line.kind != "within" else INK.dim
        after = Content.assemble("  ", (one_line(line.said), said))
    if line.asked is not None:
        after = after.append(Content.styled(_DEEPER, INK.key))
    if line.kind == "rule" and line.span is not None:
        before = before.append(Content.styled(f"{line.span.line}: ", INK.faint))
    room = max(8, width - before.cell_length - after.cell_length)
    text = clip(one_line(line.text), room)
    return before.append(Content.styled(text, _text_style(line))).append(after).truncate(width)


def _text_style(line: Line) -> str:
    if line.kind == "rule":
        return f"bold {INK.title}"
    if line.kind == "part":
        return INK.text
    return INK.dim if line.kind in ("within", "note") else INK.record


def _values(line: Line) -> Content:
    parts = [
        (_truth(value), INK.number) if line.is_truth else cell(value, _WIDEST_VALUE)
        for value in line.values
    ]
    return Content(" or ").join([Content.styled(text, colour) for text, colour in parts])


def _truth(value: Value) -> str:
    return written(None if value is None else bool(value))
