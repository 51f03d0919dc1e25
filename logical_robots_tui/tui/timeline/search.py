"""Searching the history for ticks in which a question holds."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.game import Superseded
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.theme.safe_text import one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game import Game, SearchResult
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.app.ui import Ui

__all__ = ["Search"]

_PATIENCE = 0.5  # seconds before the first message
_NO_PROGRAM = "There is no program yet."


class Search:
    """Goes to the next or previous tick in which a question holds.

    Args:
        session: The session.
        ui: The user interface.
        go_to: Goes to a tick.
    """

    def __init__(self, session: Session, ui: Ui, go_to: Callable[[int], None]) -> None:
        self._session, self._ui, self._go_to = session, ui, go_to
        self._question = ""

    async def ask(self) -> None:
        """Ask for a question, and go to the next tick in which it holds."""
        from logical_robots_tui.tui.timeline.prompts import QuestionPrompt

        program = self._session.program
        if program is None:
            self._ui.tell(_NO_PROGRAM)
            return
        prompt = QuestionPrompt("Go to the next tick in which…", self._question, program)
        found = await self._ui.ask(prompt)
        if found is not None:
            self._question = found
            await self.go(1)

    async def go(self, way: Literal[-1, 1]) -> None:
        """Go to the nearest tick in one direction in which the question holds.

        Args:
            way: 1 for later ticks, -1 for earlier ones.
        """
        session = self._session
        if not self._question:
            await self.ask()
            return
        session.pause()
        game = session.game
        if game is None:
            self._ui.tell(_NO_PROGRAM)
            return
        about, patience = self._about(game), _Patience(self._ui)

        def told(tick: int) -> None:
            if about != self._about(session.game):
                raise Superseded  # the player has moved on
            patience.told(tick)

        from logical_robots_tui.game import search_ticks

        try:
            sought = await search_ticks(game, self._question, way, told)
        except Superseded:
            return
        except ProgramError as error:
            message = error.diagnostics[0].message
            self._ui.warn(f"{self._question} can't be asked: {message}.")
            return
        if about != self._about(session.game):
            return
        if sought.tick is not None:
            self._go_to(sought.tick)
        else:
            self._say_there_is_none(sought, way)

    def _say_there_is_none(self, sought: SearchResult, way: Literal[-1, 1]) -> None:
        side = "after" if way > 0 else "before"
        tick = self._session.frame.tick
        question = one_line(self._question)
        here = "It holds here. " if sought.holds_here else ""
        words = f"{here}No {'other ' * bool(here)}tick {side} {tick} is known in which it holds"
        trouble = f" It failed in some: {one_line(sought.problem)}" if sought.problem else ""
        more = with_keys(" {search_ticks} asks for another question.")
        self._ui.tell(f"{words}: {question}.{trouble or more}")

    def _about(self, game: Game | None) -> object:
        """Return what a search depends on; if it changes, the result is void."""
        if game is None:
            return None
        return game, game.program, game.history.turns, game.frame.tick, self._question


class _Patience:
    """Reports once that a long search is still running."""

    def __init__(self, ui: Ui) -> None:
        self._ui = ui
        self._began = monotonic()
        self._has_told = False

    def told(self, tick: int) -> None:
        """Note the progress."""
        if not self._has_told and monotonic() > self._began + _PATIENCE:
            self._has_told = True
            self._ui.tell(f"Searching, at tick {tick}… Go to any tick to stop.")
