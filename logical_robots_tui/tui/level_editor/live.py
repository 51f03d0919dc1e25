"""Bringing what is edited into the game that runs."""

from __future__ import annotations

import asyncio
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.app.ui import Spawn
    from logical_robots_tui.tui.level_editor.editor import LevelEditor

__all__ = ["Live"]

_LEAST_WAIT = 0.01  # seconds in which a stroke is painted first
_AGAIN_AFTER = 0.04  # seconds between two changes of the game, at least
_SHARE = 3  # of what a change takes, before the next one


class Live:
    """Keeps the game in the level that is edited.

    While walls are painted the picture is ahead of the game, which follows as fast as it can:
    a large level takes a moment.

    Args:
        session: Whose game.
        editor: What is edited.
        spawn: Starts work in the background.
    """

    def __init__(self, session: Session, editor: LevelEditor, spawn: Spawn) -> None:
        self._session, self._editor, self._spawn = session, editor, spawn
        self._levels = session.levels
        self._next_at = 0.0
        self._is_due = self._is_over = False

    def edited(self) -> None:
        """The level has changed; the game follows at once, or soon if only walls did."""
        before, after = self._levels.shown, self._levels.edited
        only_walls = (
            before.robots is after.robots
            and before.beacons is after.beacons
            and before.areas is after.areas
            and before.walls.shape == after.walls.shape
        )
        if not only_walls:
            self.flush()
        elif not self._is_due:
            self._is_due = True
            self._spawn(self._flush_soon, "live", exclusive=False)

    def flush(self) -> None:
        """Bring the game up to date now."""
        before, after = self._levels.shown, self._levels.edited
        if after is before or self._is_over:
            return
        began = perf_counter()
        self._session.change_level(after, self._editor.poses.between(before, after))
        now = perf_counter()
        self._next_at = now + max(_AGAIN_AFTER, _SHARE * (now - began))

    def stop(self) -> None:
        """The game is another one: bring nothing into it."""
        self._is_over = True

    async def _flush_soon(self) -> None:
        await asyncio.sleep(max(self._next_at - perf_counter(), _LEAST_WAIT))
        self._is_due = False
        self.flush()
