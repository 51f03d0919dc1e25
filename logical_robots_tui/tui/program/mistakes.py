"""Errors: signs beside lines, underlined places, and a list of messages below the text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from rich.segment import Segment
from rich.style import Style as RichStyle
from textual import events
from textual.content import Content
from textual.strip import Strip
from textual.style import Style
from textual.widgets import Static

from logical_robots_tui.language.diagnostics import count_words
from logical_robots_tui.language.services.editing import width_of
from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic

_MOST_SHOWN = 3
_LONGEST = 400


class Underline(NamedTuple):
    """A wrong or odd place in a line, from its first column to before the last."""

    start: int
    stop: int
    is_wrong: bool


def underline_of(mistake: Diagnostic, line: str) -> Underline:
    return Underline(*width_of(mistake, line), mistake.severity == "error")


class MistakeStrip(Static):
    """How many errors there are, and messages of some; a click goes to one."""

    DEFAULT_CSS = """
    MistakeStrip {
        height: auto; max-height: 50%; padding: 0 1; display: none;
        background: $mistake-strip; color: $foreground;
    }
    MistakeStrip.-odd { background: $odd-strip; }
    """

    def __init__(self, go_to: Callable[[tuple[int, int]], None]) -> None:
        """`go_to` shows a place of the program, a line and column from 0."""
        super().__init__()
        self._go_to = go_to
        self._shown: tuple[Diagnostic, ...] = ()

    def show(self, mistakes: tuple[Diagnostic, ...], row: int) -> None:
        # The one at the cursor comes first, as there may be no room for all.
        mistakes = tuple(sorted(mistakes, key=lambda mistake: mistake.line != row + 1))
        if mistakes == self._shown:
            return
        self._shown = mistakes
        self.display = bool(mistakes)
        self.set_class(all(mistake.severity == "warning" for mistake in mistakes), "-odd")
        lines = [_describe(mistake) for mistake in mistakes[:_MOST_SHOWN]]
        if len(mistakes) > 1:
            ink = INK.warn if self.has_class("-odd") else INK.bad
            head = (count_words(mistakes), f"bold {ink}")
            hint = (f"   {command('error').key_name} goes to the next one", INK.dim)
            lines.insert(0, Content.assemble(head, hint))
        self.update(Content("\n").join(lines))

    def on_click(self, event: events.Click) -> None:
        if self._shown:
            self._go_to(event.style.meta.get("place", place_of(self._shown[0])))


def place_of(mistake: Diagnostic) -> tuple[int, int]:
    return mistake.line - 1, mistake.column - 1


def _describe(mistake: Diagnostic) -> Content:
    sign, ink = ("✗", INK.bad) if mistake.severity == "error" else ("!", INK.warn)
    place = f"{sign} line {mistake.line}, column {mistake.column}"
    content = Content.assemble(
        (place, f"bold {ink}"), "  ", clip(one_line(mistake.message), _LONGEST)
    )
    if mistake.hint:
        content = content.append("\n  ").append(
            Content.styled(clip(one_line(mistake.hint), _LONGEST), INK.warn)
        )
    return content.stylize(Style.from_meta({"place": place_of(mistake)}))


def sign(
    strip: Strip, row: int | None, gutter: int, styles: Mapping[str, RichStyle], *, is_wrong: bool
) -> Strip:
    """Put a sign into the gutter of a line; row None continues a wrapped line."""
    label, ink = ("✗", "mistake-gutter") if is_wrong else ("!", "odd-gutter")
    text = " " * gutter if row is None else f"{row + 1:>{gutter - 2}}{label} "
    return Strip([Segment(text, styles[ink]), *strip.crop(gutter)])
