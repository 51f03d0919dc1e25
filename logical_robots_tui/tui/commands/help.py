"""Finding commands: the palette, and the help with all keys and signs."""

from __future__ import annotations

from functools import partial
from textwrap import wrap
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

from textual.binding import Binding
from textual.command import CommandPalette, DiscoveryHit, Hit, Provider
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from logical_robots_tui.tui.commands.keymap import commands
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, legend
from logical_robots_tui.tui.labyrinth.drawing.palette import hex_colour
from logical_robots_tui.tui.layout.dialogs import ClosedOnce, Dialog
from logical_robots_tui.tui.theme.themes import INK, palette_of
from logical_robots_tui.tui.timeline.widget import DIVERGENCE, SIGNS, TRACKS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from textual.app import ComposeResult
    from textual.command import Hits

    from logical_robots_tui.tui.commands.command import Command

__all__ = ["CommandProvider", "EditingProvider", "Help", "Palette", "Subject"]

_INSPECTOR_SIGNS = (
    ("◂", "an input: what the world gives the program"),
    ("•", "a predicate of the program, with its line"),
    ("◦", "a predicate of the prelude, which comes with the game"),
    ("ƒ", "a function: choose it to see its calls, with arguments and results"),
    ("▸", "folded; right unfolds it, left folds it"),
    ("✓", "a condition that holds; ✗ one that nothing satisfied"),
    ("→", "a call; enter makes it the root, backspace goes back"),
)
Subject: TypeAlias = Literal["labyrinth", "editing", "editor", "inspector", "timeline"]
"""What the help can start with."""

_ABOUT: dict[Subject, tuple[str, tuple[str, ...]]] = {
    "labyrinth": (
        "The labyrinth shows the world at the current tick. Arrow keys or dragging move the view, "
        "the wheel zooms, a click selects a robot. Single letters are commands here.",
        ("Running", "View", "In the labyrinth"),
    ),
    "editing": (
        "Edit the level with the mouse, or with a cursor that the arrow keys move, faster with "
        "shift. Enter or the mouse button applies the tool. Every change can be undone, and the "
        "robots may run meanwhile.",
        ("In the level editor", "Making levels", "In the labyrinth"),
    ),
    "editor": (
        "Edit the program here; letters are text, so commands have Ctrl or function keys. What "
        "you type is kept. A line with ✗ has a mistake, one with ! a warning; the message is at "
        "the end of the line, if there is room, and below the text.",
        ("In the program", "Program and level"),
    ),
    "inspector": (
        "The inspector shows what the program derived at the current tick. Choose a page or a "
        "predicate on the left; tab goes to its content, arrow keys move there.",
        ("In the inspector", "Rows and values"),
    ),
    "timeline": (
        "The timeline shows the ticks of the history. Arrow keys, page up, page down, home, end "
        "and the mouse move along it.",
        ("In the timeline", "Time"),
    ),
}
"""For each subject a few sentences, and the sections that come first."""

_KEYS_WIDTH, _TITLE_WIDTH = 12, 27
_BESIDE_FROM = 84  # columns from which the sentence stands beside its title


class Help(Dialog[None]):
    """A scrolling text: the pane in use first, then everything else.

    Args:
        drawing: The drawing style whose signs to explain.
        about: Where the player is; that comes first.
    """

    DEFAULT_CSS = """
    Help > #box { height: 90%; max-width: 100; }
    Help VerticalScroll { height: 1fr; scrollbar-gutter: stable; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("question_mark,f1,q", "leave", "Close", show=False),
    ]

    keys = "↑↓ scroll   esc close"

    def __init__(self, drawing: Drawing, about: Subject = "labyrinth") -> None:
        super().__init__(f"Help · {about}")
        self._drawing, self._about = drawing, about

    def content_widgets(self) -> ComposeResult:
        """One long text."""
        with VerticalScroll():
            yield Static(id="help")

    def on_resize(self) -> None:
        """Wrap the lines again."""
        self.call_after_refresh(self._write)

    def _write(self) -> None:
        width = self.query_one(VerticalScroll).scrollable_content_region.width
        self.query_one("#help", Static).update(self._content(width))

    def _content(self, width: int) -> Content:
        sections: dict[str, list[Content]] = {}
        for entry in commands():
            keys = entry.key_names or entry.key_name
            lines = _entry(keys, entry.title, entry.help, width)
            sections.setdefault(entry.group, []).extend(lines)
        palette = palette_of(self.app.current_theme)
        signs = [
            (sign, hex_colour(rgb), said) for sign, rgb, said in legend(self._drawing, palette)
        ]
        sections["In the labyrinth"] = _signs(signs)
        sections["In the timeline"] = _signs([*SIGNS.values(), DIVERGENCE, *TRACKS])
        sections["In the inspector"] = _signs([(s, INK.key, said) for s, said in _INSPECTOR_SIGNS])
        sentence, first = _ABOUT[self._about]
        content = [
            Content(""),
            *(Content.styled(line, INK.text) for line in wrap(sentence, max(width, 1))),
        ]
        for heading in dict.fromkeys((*first, *sections)):
            content += [_heading(heading), *sections[heading]]
        return Content("\n").join(content)


def _signs(signs: Iterable[tuple[str, str, str]]) -> list[Content]:
    """Signs, each with its style and what it means."""
    return [
        Content.assemble("  ", (sign, style), "  ", (said, INK.text)) for sign, style, said in signs
    ]


def _heading(text: str) -> Content:
    return Content.styled(f"\n{text}", f"bold {INK.title}")


def _entry(keys: str, title: str, text: str, width: int) -> list[Content]:
    """Keys, title and help of a command, the help wrapped in a column of its own."""
    head = f"  {keys:<{_KEYS_WIDTH}} "
    first = Content.assemble((head, INK.key), (title, INK.text))
    indent = len(head) + (_TITLE_WIDTH if width > _BESIDE_FROM else 2)
    told = [Content.styled(line, INK.dim) for line in wrap(text, max(width, 40) - indent)]
    if told and width > _BESIDE_FROM:
        first = first.append(" " * (indent - first.cell_length)).append(told.pop(0))
    return [first, *(Content(" " * indent).append(line) for line in told)]


class Palette(CommandPalette, ClosedOnce[None]):
    """A line to type in, and what can be had by that."""


class CommandProvider(Provider):
    """Offers every command but those of the level editor."""

    def offered(self) -> list[Command]:
        """The commands, in the order in which they are shown."""
        return commands("screen", "text")

    async def discover(self) -> Hits:
        """All commands, before anything is typed."""
        for entry in self.offered():
            if entry.id != "palette":
                yield DiscoveryHit(
                    _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    async def search(self, query: str) -> Hits:
        """The commands whose title or help matches."""
        matcher = self.matcher(query)
        for entry in self.offered():
            score = max(matcher.match(entry.title), matcher.match(entry.help) * 0.5)
            if score > 0 and entry.id != "palette":
                yield Hit(
                    score, _title(entry), self._caller(entry), text=entry.title, help=entry.help
                )

    def _caller(self, entry: Command) -> Callable[[], object]:
        return partial(self.screen.run_action, f"command('{entry.id}')")


class EditingProvider(CommandProvider):
    """Offers the commands of the level editor first, then all others."""

    def offered(self) -> list[Command]:
        """The commands, in the order in which they are shown."""
        return commands("level") + super().offered()


def _title(entry: Command) -> str:
    return f"{entry.title}   {entry.key_names}" if entry.keys else entry.title
