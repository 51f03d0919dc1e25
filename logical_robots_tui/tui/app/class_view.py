"""The class at work on the teacher's screen."""

from __future__ import annotations

import asyncio
import os

from textual.app import ComposeResult
from textual.binding import Binding
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.clock import CLOCK
from logical_robots_tui.errors import InputError
from logical_robots_tui.player.settings import read_settings, settings_path
from logical_robots_tui.progress.board import Board
from logical_robots_tui.progress.class_view import HEADINGS, Pupil, pupils
from logical_robots_tui.tui.terminal.capabilities import may_use_mouse
from logical_robots_tui.tui.terminal.diff_app import DiffApp
from logical_robots_tui.tui.theme.themes import INK, colours_in, use_theme
from logical_robots_tui.wording import align, visible

_SECONDS = 1.0  # between two looks at the board


class ClassApp(DiffApp, inherit_bindings=False):
    """A line for each player; what the selected one does stands below, and their program."""

    TITLE = "Class"
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Screen { background: $background; }
    #headings { color: $ink-title; padding: 0; height: 1; text-wrap: nowrap; }
    #players {
        height: 1fr; border: none; background: $surface; padding: 0;
        text-wrap: nowrap; text-overflow: ellipsis;
    }
    #players > .option-list--option-highlighted { color: $here-ink; background: $here; }
    #details { height: 1fr; border-top: solid $frame; padding: 0 1; }
    #keys { height: 1; background: $bar; color: $ink-dim; padding: 0 1; }
    """
    BINDINGS = [
        Binding("q,ctrl+c,ctrl+q", "quit", "Leave", priority=True),
        Binding("tab", "app.focus_next"),
    ]

    def __init__(self, board: Board, theme: str) -> None:
        super().__init__(CLOCK)
        self._board, self._theme_name = board, theme
        self._pupils: list[Pupil] = []
        self._problem = ""

    def get_theme_variable_defaults(self) -> dict[str, str]:
        return colours_in(self.current_theme)

    def on_load(self) -> None:
        use_theme(self, self._theme_name)

    def compose(self) -> ComposeResult:
        yield Static(id="headings", markup=False)
        yield OptionList(id="players", markup=False)
        with VerticalScroll(id="details"):
            yield Static(id="player", markup=False)
        yield Static(id="keys", markup=False)

    def on_mount(self) -> None:
        self.animation_level = "none"
        self._show([])
        self.run_worker(self._watch())

    async def _watch(self) -> None:
        while True:
            try:
                current = await asyncio.to_thread(pupils, self._board)
                problem = ""
            except InputError as error:
                current, problem = self._pupils, str(error)
            if (current, problem) != (self._pupils, self._problem):
                self._problem = problem
                self._show(current)
            await asyncio.sleep(_SECONDS)

    def _show(self, current: list[Pupil]) -> None:
        players = self.query_one("#players", OptionList)
        selected = self._selected
        self._pupils = current
        headings, *lines = align([HEADINGS, *(pupil.cells() for pupil in current)])
        self.query_one("#headings", Static).update(headings)
        players.set_options(
            Option(Content.styled(line, _ink(pupil)))
            for line, pupil in zip(lines, current, strict=True)
        )
        names = [pupil.activity.player for pupil in current]
        if names:
            name = selected.activity.player if selected is not None else ""
            players.highlighted = names.index(name) if name in names else 0
        self._show_selected()
        count = sum(pupil.activity.is_open for pupil in current)
        keys = self._problem or f"{count} at work   ↑↓ choose   tab program   q leave"
        self.query_one("#keys", Static).update(visible(keys))

    @property
    def _selected(self) -> Pupil | None:
        row = self.query_one("#players", OptionList).highlighted
        return self._pupils[row] if row is not None and row < len(self._pupils) else None

    def on_option_list_option_highlighted(self) -> None:
        self._show_selected()

    def _show_selected(self) -> None:
        pupil = self._selected
        if pupil is None:
            text = "Nobody has played yet."
        else:
            lines = [visible(line) for line in (pupil.program or "").splitlines()]
            text = "\n".join([pupil.sentence(), *([""] if lines else []), *lines])
        self.query_one("#player", Static).update(Content(text))


def _ink(pupil: Pupil) -> str:
    if not pupil.activity.is_open:
        return INK.dim
    return INK.warn if pupil.activity.asks_for_help else INK.text


def watch_class(board: Board) -> None:
    """Show the class until the teacher leaves; a bug is raised when the terminal is restored."""
    settings = read_settings(settings_path(), lambda _keys, _complain: {})
    app = ClassApp(board, settings.theme or "")
    app.run(mouse=may_use_mouse(os.environ))
    if app.mistake is not None:
        raise app.mistake
