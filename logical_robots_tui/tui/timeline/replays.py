"""Replays on the screen: opening one as a course of its own, and saving the present course."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Superseded, compile_program
from logical_robots_tui.mind import ProgramError

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs


class Replays:
    def __init__(self, session: Session, ui: Dialogs, folder: Path) -> None:
        self._session, self._ui, self._folder = session, ui, folder

    async def open(self, replay: Replay) -> None:
        """Replay in the current game, which must be at the replay's level; stop at its end."""
        try:
            programs = [await compile_program(texts) for texts in replay.programs.values()]
        except ProgramError as error:
            mistake = error.diagnostics[0]
            self._ui.warn(f"A program of this replay no longer compiles: {mistake.message}")
            return
        self._session.go_through(programs[0], partial(self._follow, replay, programs))

    async def _follow(self, replay: Replay, programs: Sequence[Program], game: Game) -> None:
        from logical_robots_tui.game.replay import play_into

        verifier = await play_into(game, replay, programs, self._session.use)
        if verifier.difference is not None:
            tick, reason = verifier.difference
            self._ui.warn(
                f"The robots do what they did when this was recorded; now tick {tick:,} would be "
                f"different: {reason}"
            )
        else:
            self._ui.tell(f"Replay of {replay.last - replay.first:,} ticks: go to any of them.")

    async def save(self) -> None:
        from logical_robots_tui.editing.level_text import write_native
        from logical_robots_tui.game.replay import SUFFIX, gather

        session = self._session
        session.pause()
        history = session.history
        if history is None or not history.last:
            self._ui.warn("Run the robots first: there is nothing to save before the first tick.")
            return
        name = session.source.name
        path = self._folder / f"{session.level.name}-{datetime.now():%Y%m%d-%H%M%S}{SUFFIX}"
        try:
            replay = await gather(history, write_native, lambda _program: name)
            size = await asyncio.to_thread(_write, path, replay)
        except Superseded:
            self._ui.warn("The robots went another way meanwhile: no replay was saved.")
        except InputError as error:
            self._ui.warn(str(error))
        except OSError as error:
            self._ui.warn(f"The replay could not be saved: {error.strerror or error}.")
        else:
            self._ui.tell(f"Saved {path} ({size:,} bytes).")


def _write(path: Path, replay: Replay) -> int:
    """Write a replay and return its bytes, or raise OSError."""
    from logical_robots_tui.paths import write_atomically

    content = replay.to_bytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, content)
    return len(content)
