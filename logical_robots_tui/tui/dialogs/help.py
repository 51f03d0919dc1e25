"""Help: all keys, and the signs in the labyrinth."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, ClassVar

from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.commands import EDITING, GROUPS, commands
from logical_robots_tui.tui.dialogs.dialog import Dialog
from logical_robots_tui.tui.drawing.glyphs import Drawing, legend
from logical_robots_tui.tui.theme import INK, hex_colour, palette_of
from logical_robots_tui.tui.timeline.drawing import PARTING, SIGNS, TRACKS

if TYPE_CHECKING:
    from textual.app import ComposeResult

__all__ = ["Help"]

_EDITOR_KEYS = (
    ("tab", "two spaces"),
    ("^space", "offer predicates, functions and fields that fit"),
    ("^Z, ^Y", "undo, redo"),
    ("^_", "make lines comments, or text again"),
    ("^X, ^C, ^V", "cut, copy, paste"),
    ("F6, F7", "select the line, select all"),
    ("^K, ^U, ^W", "delete to the end, to the start, the word before"),
)

_INSPECTOR_SIGNS = (
    ("◂", "what the world gives to the program"),
    ("•", "a predicate of the program, with the line where it begins"),
    ("◦", "a predicate that comes with the game"),
    ("ƒ", "a function of its arguments: it has no rows of its own"),
)
_KEYS_WIDTH, _TITLE_WIDTH = 12, 27
_BESIDE_FROM = 84  # columns from which on a sentence stands beside its title


class Help(Dialog[None]):
    """A text to scroll.

    Args:
        drawing: Whose signs to explain.
    """

    DEFAULT_CSS = """
    Help > #box { height: 90%; max-width: 100; }
    Help VerticalScroll { height: 1fr; scrollbar-gutter: stable; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("question_mark,f1,q", "leave", "Close", show=False),
    ]

    def __init__(self, drawing: Drawing) -> None:
        super().__init__()
        self._drawing = drawing

    def compose(self) -> ComposeResult:
        """One long text."""
        with Vertical(id="box") as box:
            box.border_title = "Help"
            with VerticalScroll():
                yield Static(id="help")
            yield Static("↑↓ scroll   esc close", id="keys", markup=False)

    def on_resize(self) -> None:
        """Break the lines anew."""
        self.call_after_refresh(self._write)

    def _write(self) -> None:
        width = self.query_one(VerticalScroll).scrollable_content_region.width
        self.query_one("#help", Static).update(self._content(width))

    def _content(self, width: int) -> Content:
        lines: list[Content] = []
        for group in GROUPS:
            lines.append(_heading(group))
            for entry in (*commands(), *EDITING):
                if entry.group == group:
                    lines += _entry(entry.key_names or "^P", entry.title, entry.help, width)
        lines.append(_heading("In the editor"))
        for keys, what in _EDITOR_KEYS:
            lines += _entry(keys, what, "", width)
        lines.append(_heading("In the labyrinth"))
        for sign, colour, meaning in legend(self._drawing, palette_of(self.app.current_theme)):
            style = hex_colour(colour)
            lines.append(Content.assemble("  ", (sign, style), "  ", (meaning, INK.text)))
        lines.append(_heading("In the timeline"))
        for sign, style, meaning in (*SIGNS.values(), PARTING, *TRACKS):
            lines.append(Content.assemble("  ", (sign, style), "  ", (meaning, INK.text)))
        lines.append(_heading("In the inspector"))
        for sign, meaning in _INSPECTOR_SIGNS:
            lines.append(Content.assemble("  ", (sign, INK.key), "  ", (meaning, INK.text)))
        return Content("\n").join(lines)


def _heading(text: str) -> Content:
    return Content.styled(f"\n{text}", f"bold {INK.title}")


def _entry(keys: str, title: str, text: str, width: int) -> list[Content]:
    """Keys, what they do, and a sentence about it, the latter broken under itself."""
    head = f"  {keys:<{_KEYS_WIDTH}} "
    first = Content.assemble((head, INK.key), (title, INK.text))
    indent = len(head) + (_TITLE_WIDTH if width > _BESIDE_FROM else 2)
    told = [Content.styled(line, INK.dim) for line in wrap(text, max(width, 40) - indent)]
    if told and width > _BESIDE_FROM:
        first = first.append(" " * (indent - first.cell_length)).append(told.pop(0))
    return [first, *(Content(" " * indent).append(line) for line in told)]
