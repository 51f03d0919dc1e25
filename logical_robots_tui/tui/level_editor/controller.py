"""The door to editing: what the screen asks of it, whether a level is edited or not.

The editor itself is loaded when it is first asked for, so that the game begins sooner.
"""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.game.drafts import Drafts
    from logical_robots_tui.tui.app.main_screen import MainScreen
    from logical_robots_tui.tui.level_editor.mode import EditMode
    from logical_robots_tui.world import Level

__all__ = ["EditingDoor"]


class EditingDoor:
    """Goes into editing and out of it.

    Args:
        screen: Where levels are edited.
        own: Folder of the player's levels.
        drafts: Where a level is kept while it is not saved.
    """

    def __init__(self, screen: MainScreen, own: Path, drafts: Drafts) -> None:
        self._screen = screen
        self.own = own
        self.drafts = drafts
        self._mode: EditMode | None = None

    @property
    def is_on(self) -> bool:
        """Whether keys and mouse edit the level."""
        return self._mode is not None and self._mode.is_on

    def open(self, key: str = "") -> None:
        """Edit the level at hand, or go on editing it.

        Args:
            key: Under which its draft was kept in a session that ended badly, if it was.
        """
        from logical_robots_tui.tui.level_editor.mode import EditMode

        if self._mode is None:
            self._mode = EditMode(self._screen, self.own, self.drafts, key)
        self._mode.enter()

    def obeys(self, key: str) -> bool:
        """Do what a key means while a level is edited; whether it means anything."""
        return self._mode is not None and self._mode.obeys(key)

    def do(self, command_id: str) -> None:
        """Do a command of editing."""
        if self._mode is not None:
            self._mode.do(command_id)

    def shown(self, level: Level) -> Level:
        """The level to draw: the one of the game, unless a newer one is being painted."""
        return level if self._mode is None else self._mode.shown(level)

    def level_left(self) -> None:
        """The player has gone to another level; changes not saved stay in a draft."""
        if self._mode is not None:
            self._mode.end()
            self._mode = None

    def close(self) -> None:
        """Write the draft and nothing after it."""
        if self._mode is not None:
            self._mode.autosave.stop()

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        if self._mode is not None:
            self._mode.autosave.flush()

    async def offer(self) -> None:
        """Offer the level that an earlier session left unsaved, if there is one."""
        try:
            drafts = await self._screen.offers.at_hand(
                partial(asyncio.to_thread, self.drafts.adopt, "level")
            )
        except OSError:
            return  # what is edited now can't be kept either, and that is told then
        if drafts:
            from logical_robots_tui.tui.recovery.level_offers import offer

            await offer(self._screen, self, drafts)
