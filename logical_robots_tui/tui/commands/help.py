"""Help: all keys, and the signs in the labyrinth."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

from textual.binding import Binding
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.commands.editing import WHILE_EDITING
from logical_robots_tui.tui.commands.table import GROUPS, commands, editing_commands
from logical_robots_tui.tui.commands.writing import WRITING, WRITING_GROUP
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, legend
from logical_robots_tui.tui.layout.dialog import Dialog
from logical_robots_tui.tui.theme.themes import INK, hex_colour, palette_of
from logical_robots_tui.tui.timeline.drawing import PARTING, SIGNS, TRACKS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from textual.app import ComposeResult

__all__ = ["Help", "Subject"]

_INSPECTOR_SIGNS = (
    ("◂", "what the world gives to the program"),
    ("•", "a predicate of the program, with the line where it begins"),
    ("◦", "a predicate that comes with the game"),
    ("ƒ", "a function: choose it to see with what it was called, and what it gave"),
    ("▸", "what is folded; right opens it, left closes it"),
    ("✓", "what holds; ✗ what nothing satisfied"),
    ("→", "a predicate that is asked; enter makes it the root, backspace comes back"),
)
Subject: TypeAlias = Literal["labyrinth", "editing", "editor", "inspector", "timeline"]
"""What the help can begin with."""

_ABOUT: dict[Subject, tuple[str, tuple[str, ...]]] = {
    "labyrinth": (
        "The labyrinth shows the world at the tick on the screen. Arrows or a drag move the view, "
        "the wheel zooms, a click chooses a robot. Single letters are commands here.",
        ("Running", "Looking", "In the labyrinth"),
    ),
    "editing": (
        "The level is edited here, by mouse or with a cursor that arrows move, further with shift. "
        "A tool acts at a press of enter or of the mouse button; what changes is undone by one "
        "key. The robots may run meanwhile.",
        (WHILE_EDITING, "Making levels", "In the labyrinth"),
    ),
    "editor": (
        "The program is edited here; letters are text, so commands have Ctrl or function keys. "
        "What you type is kept. A line with ✗ holds a mistake, one with ! looks odd; behind it, "
        "where there is room, and below the text stands why.",
        (WRITING_GROUP, "Program and level"),
    ),
    "inspector": (
        "The inspector shows what the program found at the tick on the screen. Choose a page or "
        "a predicate on the left; tab goes to what it shows, arrows move there.",
        ("In the inspector", "Rows and values"),
    ),
    "timeline": (
        "The timeline holds the ticks that are known. Arrows, page up and down, home and end move "
        "along it, and so does the mouse.",
        ("In the timeline", "Time"),
    ),
}
"""A sentence or two about each subject, and the sections that come first then."""

_KEYS_WIDTH, _TITLE_WIDTH = 12, 27
_BESIDE_FROM = 84  # columns from which on a sentence stands beside its title


class Help(Dialog[None]):
    """A text to scroll: about the pane that is worked in, then about all else.

    Args:
        drawing: Whose signs to explain.
        about: Where the player works; that is explained first.
    """

    DEFAULT_CSS = """
    Help > #box { height: 90%; max-width: 100; }
    Help VerticalScroll { height: 1fr; scrollbar-gutter: stable; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("question_mark,f1,q", "leave", "Close", show=False),
    ]

    def __init__(self, drawing: Drawing, about: Subject = "labyrinth") -> None:
        super().__init__()
        self._drawing, self._about = drawing, about

    def compose(self) -> ComposeResult:
        """One long text."""
        with Vertical(id="box") as box:
            box.border_title = f"Help · {self._about}"
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
        sections = {group: _commands_of(group, width) for group in GROUPS}
        sections[WRITING_GROUP] = _commands_of(WRITING_GROUP, width)
        palette = palette_of(self.app.current_theme)
        signs = [
            (sign, hex_colour(rgb), said) for sign, rgb, said in legend(self._drawing, palette)
        ]
        sections["In the labyrinth"] = _signs(signs)
        sections["In the timeline"] = _signs([*SIGNS.values(), PARTING, *TRACKS])
        sections["In the inspector"] = _signs([(s, INK.key, said) for s, said in _INSPECTOR_SIGNS])
        sentence, first = _ABOUT[self._about]
        lines = [
            Content(""),
            *(Content.styled(line, INK.text) for line in wrap(sentence, max(width, 1))),
        ]
        for heading in dict.fromkeys((*first, *sections)):
            lines += [_heading(heading), *sections[heading]]
        return Content("\n").join(lines)


def _commands_of(group: str, width: int) -> list[Content]:
    known = (*commands(), *editing_commands().values(), *WRITING)
    found = [entry for entry in known if entry.group == group]
    return [
        line
        for entry in found
        for line in _entry(entry.key_names or entry.key_name, entry.title, entry.help, width)
    ]


def _signs(signs: Iterable[tuple[str, str, str]]) -> list[Content]:
    """Signs, each with its style and what it means."""
    return [
        Content.assemble("  ", (sign, style), "  ", (said, INK.text)) for sign, style, said in signs
    ]


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
