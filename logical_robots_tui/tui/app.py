"""The app: theme, the main screen, and an orderly end."""

from __future__ import annotations

import asyncio
import os
from time import monotonic
from typing import TYPE_CHECKING, ClassVar

from textual import events
from textual.binding import Binding

from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.journal import Journal
from logical_robots_tui.tui.screen import MainScreen
from logical_robots_tui.tui.sparing import SparingApp
from logical_robots_tui.tui.terminal import drawing_for
from logical_robots_tui.tui.theme import EXTRA_VARIABLES, NIGHT

if TYPE_CHECKING:
    from pathlib import Path

    from textual.binding import BindingType

    from logical_robots_tui.game import Source
    from logical_robots_tui.mind import Engine
    from logical_robots_tui.world import Level

__all__ = ["LogicalRobotsApp"]

_TWICE = 2.0  # seconds between two presses that are meant as one wish


class LogicalRobotsApp(SparingApp, inherit_bindings=False):
    """The game in a terminal.

    Args:
        level: Where to begin.
        source: The program to begin with.
        data_dir: Where drafts, the player's programs and progress are.
        journal: Where progress is kept, if that is open already.
        text: What the player made of the program, or None.
        welcome: Whether to begin with the tour.
        engine: What the robots think with.
    """

    TITLE = "Logical Robots"
    CSS_PATH = "screen.tcss"
    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c", "interrupt", "Leave", show=False, system=True),
    ]

    def __init__(
        self,
        level: Level,
        source: Source,
        *,
        data_dir: Path,
        journal: Journal | None = None,
        text: str | None = None,
        welcome: bool = False,
        engine: Engine = "sqlite",
    ) -> None:
        super().__init__()
        journal = journal or Journal(data_dir / FILE_NAME)
        self.main = MainScreen(
            level, source, data_dir, journal, text=text, welcome=welcome, engine=engine
        )
        self.animation_level = "none"
        self._interrupted_at = float("-inf")
        self._event_loop: asyncio.AbstractEventLoop | None = None

    def get_theme_variable_defaults(self) -> dict[str, str]:
        """Variables that our style sheets use in every theme."""
        return EXTRA_VARIABLES

    def get_default_screen(self) -> MainScreen:
        """The main screen."""
        return self.main

    def on_load(self) -> None:
        """Dress up before the first picture."""
        self._event_loop = asyncio.get_running_loop()
        self.register_theme(NIGHT)
        self.theme = NIGHT.name

    async def on_event(self, event: events.Event) -> None:
        """Handle an event; a key or a mouse button is to be answered before all else."""
        if isinstance(event, events.Key | events.MouseDown | events.Paste):
            self.main.session.pace.give_way()
        key = event.key if isinstance(event, events.Key) and self.screen is self.main else ""
        if not self.main.goes_there(key):
            await super().on_event(event)

    def suit_terminal(self) -> None:
        """Draw the labyrinth in the way that suits the terminal of this process."""
        self.main.labyrinth.view.drawing = drawing_for(
            os.environ,
            self.console.color_system,
            self.console.encoding,
            colourless=self.no_color,
        )

    def last_words(self) -> None:
        """Write what was typed to its draft."""
        self.main.keeper.flush()

    def leave_soon(self) -> None:
        """Ask the app to end; may be called on any thread or in a signal handler."""
        if self._event_loop is not None:
            self._event_loop.call_soon_threadsafe(self.exit)

    def action_interrupt(self) -> None:
        """Leave at the second ^C in a row; the first may have been meant for something else."""
        now = monotonic()
        if now - self._interrupted_at < _TWICE:
            self.exit()
        self._interrupted_at = now
        self.notify("Press ^C again to leave the game.", markup=False, timeout=_TWICE)
