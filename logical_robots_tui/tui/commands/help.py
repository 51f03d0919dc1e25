"""Finding commands: the palette, and the help with all keys and signs."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import lru_cache, partial
from textwrap import wrap
from typing import Literal, TypeAlias

from textual import events, on
from textual.command import CommandPalette, DiscoveryHit, Hit, Hits, Provider
from textual.content import Content
from textual.widgets import Input

from logical_robots_tui.tui.app.ui import widget_at
from logical_robots_tui.tui.commands.command import Command, key_name
from logical_robots_tui.tui.commands.keymap import commands
from logical_robots_tui.tui.inspector.line_views import LinesView
from logical_robots_tui.tui.labyrinth.drawing.cells import hex_colour
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing, legend
from logical_robots_tui.tui.layout.dialogs import ClosedOnce, Dialog
from logical_robots_tui.tui.theme.themes import INK, palette_of
from logical_robots_tui.tui.timeline.widget import DIVERGENCE, SIGNS, TRACKS

_INSPECTOR_SIGNS = (
    ("◂", "an input: what the world gives the program"),
    ("•", "a predicate of the program, with its line"),
    ("◦", "a predicate of the prelude, which comes with the game"),
    ("ƒ", "a function: choose it to see its calls, with arguments and results"),
    ("▸", "folded; right unfolds it, left folds it"),
    ("✓", "a condition that holds; ✗ one that nothing satisfied"),
    ("→", "a call; enter makes it the root, backspace goes back"),
)
Subject: TypeAlias = Literal["map", "editing", "editor", "inspector", "timeline"]
"""What the help can start with."""

_ABOUT: dict[Subject, tuple[str, tuple[str, ...]]] = {
    "map": (
        "The map shows the world at the current tick. Arrow keys or dragging move the view, "
        "the wheel zooms, a click selects a robot. Single letters are commands here.",
        ("Running", "View", "On the map"),
    ),
    "editing": (
        "Edit the level with the mouse, or with a cursor that the arrow keys move, faster with "
        "shift. Enter or the mouse button applies the tool. Every change can be undone, and the "
        "robots may run meanwhile.",
        ("In the level editor", "Making levels", "On the map"),
    ),
    "editor": (
        "Edit the program here; letters are text, so commands have Ctrl or function keys. What "
        "you type is kept. A line with ✗ has an error, one with ! a warning; the message is below "
        "the text until you change the line.",
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
_PALETTE_WIDTH = 100  # as in the style sheet
_PALETTE_EDGES = 5  # left and right of a command, with the bar
_BESIDE_FROM = 84  # columns from which the sentence stands beside its title


class Help(Dialog[None]):
    """The help: the current pane first, then everything else, or the matches of a search."""

    DEFAULT_CSS = """
    Help > #box { width: 100%; max-width: 100; height: 100%; max-height: 100%; }
    Help { background: $background; }  /* nothing beneath is drawn meanwhile */
    Help LinesView { height: 1fr; scrollbar-gutter: stable; margin: 0; }
    """

    BINDINGS = [
        ("f1", "leave"),
        ("up", "scroll('up')"),
        ("down", "scroll('down')"),
        ("pageup", "scroll('page_up')"),
        ("pagedown", "scroll('page_down')"),
    ]

    keys = "letters filter   ↑↓ scroll   esc close"

    def __init__(self, drawing: Drawing, subject: Subject = "map") -> None:
        view = LinesView(id="help")
        view.can_focus = False
        super().__init__(f"Help · {subject}", Input(placeholder="Type to filter"), view)
        self._drawing, self._subject = drawing, subject

    def on_mount(self) -> None:
        self.query_one(LinesView).show_lines(self._lines)

    def action_scroll(self, where: str) -> None:
        getattr(self.query_one(LinesView), f"scroll_{where}")()

    @on(Input.Changed)
    def _write(self) -> None:
        self.query_one(LinesView).redraw()

    def _lines(self, width: int) -> list[Content]:
        palette = palette_of(self.app.current_theme)
        signs = [
            (sign, hex_colour(rgb), meaning)
            for sign, rgb, meaning in legend(self._drawing, palette)
        ]
        sections: dict[str, list[Content]] = {}
        for entry in commands():
            sections.setdefault(entry.group, []).append(_entry(entry, width))
        sections["On the map"] = _signs(signs, width)
        sections["In the timeline"] = _signs([*SIGNS.values(), DIVERGENCE, *TRACKS], width)
        inspector_signs = [(sign, INK.key, meaning) for sign, meaning in _INSPECTOR_SIGNS]
        sections["In the inspector"] = _signs(inspector_signs, width)
        sentence, headings = _ABOUT[self._subject]
        words = self.query_one(Input).value.casefold().split()
        content = [Content.styled(line, INK.text) for line in wrap(sentence, max(width, 1))]
        if words:
            content = []
        for heading in dict.fromkeys((*headings, *sections)):
            matches = [
                entry
                for entry in sections[heading]
                if all(word in " ".join(entry.plain.casefold().split()) for word in words)
            ]
            if matches:
                content += [Content.styled(f"\n{heading}", f"bold {INK.title}"), *matches]
        if not content:
            content = [Content.styled("No matches.", INK.dim)]
        return [line for part in content for line in part.split("\n", allow_blank=True)]


def _signs(signs: Iterable[tuple[str, str, str]], width: int) -> list[Content]:
    """Return a sign with its meaning in lines of a width."""
    contents = []
    for sign, style, meaning in signs:
        folded = ("\n" + " " * (4 + len(sign))).join(wrap(meaning, max(width, 40) - 4 - len(sign)))
        contents.append(Content.assemble("  ", (sign, style), "  ", (folded, INK.text)))
    return contents


@lru_cache(256)
def _entry(entry: Command, width: int) -> Content:
    keys = _keys(entry) if entry.keys else Content.styled("palette", INK.dim)
    head = Content("  ").append(keys)
    indent = 3 + _KEYS_WIDTH
    head = head.append(" " * max(indent - head.cell_length, 1))
    first = head.append(Content.styled(entry.title, INK.text))
    indent += _TITLE_WIDTH if width > _BESIDE_FROM else 2
    help_lines = [
        Content.styled(line, INK.dim) for line in wrap(entry.help, max(width, 40) - indent)
    ]
    if help_lines and width > _BESIDE_FROM:
        first = first.append(" " * (indent - first.cell_length)).append(help_lines.pop(0))
    return Content("\n").join([first, *(Content(" " * indent).append(line) for line in help_lines)])


def _keys(entry: Command) -> Content:
    separator = Content.styled(" · ", INK.faint)
    return separator.join(Content.styled(key_name(key), INK.key) for key in entry.keys)


class PaletteScreen(CommandPalette, ClosedOnce[None]):
    def on_click(self, event: events.Click) -> None:
        """Hide from Textual a click that is now outside of the screen, which has shrunk."""
        if widget_at(self, event.screen_x, event.screen_y) is None:
            event.prevent_default()


class CommandProvider(Provider):
    """Offers every command but those of the level editor."""

    def entries(self) -> list[Command]:
        return commands("screen", "text")

    async def discover(self) -> Hits:
        for entry in self.entries():
            if entry.id != "palette":
                yield DiscoveryHit(*self._offer(entry), text=entry.title, help=entry.help)

    async def search(self, query: str) -> Hits:
        words = query.casefold().split()
        for entry in self.entries():
            score = entry.match(words)
            if score > 0 and entry.id != "palette":
                yield Hit(score, *self._offer(entry), text=entry.title, help=entry.help)

    def _offer(self, entry: Command) -> tuple[Content, Callable[[], object]]:
        title, keys = Content(entry.title), _keys(entry)
        gap = min(self.app.size.width, _PALETTE_WIDTH) - _PALETTE_EDGES
        gap -= title.cell_length + keys.cell_length
        line = title.append(" " * max(gap, 2)).append(keys)
        return line, partial(self.screen.run_action, f"command('{entry.id}')")


class EditingProvider(CommandProvider):
    """Offers the commands of the level editor first, then all others."""

    def entries(self) -> list[Command]:
        return commands("level") + super().entries()
