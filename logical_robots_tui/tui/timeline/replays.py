"""Replays on the screen: opening one as a course of its own, and saving the present course."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Sequence
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Source, Superseded, compile_program, load_program
from logical_robots_tui.mind import ProgramError
from logical_robots_tui.world import Level, LevelError, load_level
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.game import Game
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.mind import Program
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs


def level_of(replay: Replay) -> Level:
    """Return a replay's first level; the shipped level if it is the same."""
    level = replay.levels[0]
    try:
        shipped = load_level(replay.name)
    except LevelError:
        return level
    return shipped if alike(shipped, level) else level


def sources_of(replay: Replay, own: Path) -> dict[str, Source]:
    """Return each team's last program ("" without teams), the player's or shipped if equal."""
    name = re.sub(r"[^\w.-]+", "-", replay.texts[-1].name, flags=re.ASCII)[:40] or "replay"
    texts = replay.programs[replay.texts[-1].tick]
    if "" in texts:
        teams = [team.name for team in replay.levels[-1].teams]
        texts = dict.fromkeys(teams or [""], texts[""])
    return {
        team: _source_of(f"{name}-{team}" if team else name, part, own)
        for team, part in texts.items()
    }


def _source_of(name: str, text: str, own: Path) -> Source:
    try:
        source = load_program(name, own)
        if source.text == text:
            return source
        name += "-in-replay"
    except InputError:
        pass
    return Source(name, text, own / f"{name}.l", shipped=False)


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
    from logical_robots_tui.writing import write_atomically

    content = replay.to_bytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, content)
    return len(content)
