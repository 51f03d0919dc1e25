"""The level editor as the rest of the game sees it, whether a level is edited or not.

What edits is loaded when it is first asked for, so that the game begins sooner.
"""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.app.session_listener import SessionListener

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from logical_robots_tui.game.drafts import Draft, Drafts
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.app.ui import Ui
    from logical_robots_tui.tui.level_editor.mode import EditMode, EditView
    from logical_robots_tui.tui.recovery.offers import Offers
    from logical_robots_tui.world import Level

__all__ = ["LevelEditing"]


class LevelEditing(SessionListener):
    """Goes into editing and out of it.

    Args:
        session: Whose level.
        ui: Where to say and ask.
        own: Folder of the player's levels.
        drafts: Where a level is kept while it is not saved.
        open_level: Goes to a level.
        view: Makes what shows a level that is edited, and takes the player's keys and mouse.
    """

    def __init__(
        self,
        session: Session,
        ui: Ui,
        own: Path,
        drafts: Drafts,
        open_level: Callable[[Level], Awaitable[None]],
        view: Callable[[EditMode], EditView],
    ) -> None:
        self._session, self._ui, self._open_level, self._view = session, ui, open_level, view
        self._own, self._drafts = own, drafts
        self.mode: EditMode | None = None
        """The level that is edited, or None before that."""

    @property
    def is_on(self) -> bool:
        """Whether keys and mouse edit the level."""
        return self.mode is not None and self.mode.is_on

    @property
    def level(self) -> Level:
        """The level to draw: that of the frame on the screen, or what becomes of it."""
        levels = self._session.levels
        return levels.edited if self.is_on else levels.shown

    def open(self, key: str = "") -> None:
        """Edit the level at hand, or go on editing it.

        Args:
            key: Under which its draft was kept in a session that ended badly, if it was.
        """
        from logical_robots_tui.tui.level_editor.mode import EditMode

        if self.mode is None:
            self.mode = EditMode(self._session, self._ui, self._own, self._drafts, self._view, key)
        self.mode.enter()

    async def make_level(self) -> None:
        """Ask for a new level, go there and edit it."""
        from logical_robots_tui.tui.level_editor.new_level import ask_for_level

        made = await ask_for_level(self._ui, self._session.level.name, self._own)
        if made is not None:
            await self._open_level(made)
            self.open()

    def obeys(self, key: str) -> bool:
        """Do what a key means while a level is edited; whether it means anything."""
        return self.mode is not None and self.mode.view.obeys(key)

    def do(self, command_id: str) -> None:
        """Do a command of editing."""
        if self.mode is not None:
            self.mode.view.do(command_id)

    def level_opened(self, level: Level) -> None:
        """The player has gone to another level; changes not saved stay in a draft."""
        if self.mode is not None:
            self.mode.end()
            self.mode = None

    def level_changed(self) -> None:
        """The game is in another version of the level, such as that of an earlier tick."""
        if self.mode is not None and self.mode.is_on:
            self.mode.follow_game()

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        if self.mode is not None:
            self.mode.autosave.flush()

    def close(self) -> None:
        """Write the draft and nothing after it."""
        if self.mode is not None:
            self.mode.autosave.stop()

    async def offer(self, offers: Offers) -> None:
        """Offer the level that an earlier session left unsaved, if there is one."""
        try:
            drafts = await offers.at_hand(partial(asyncio.to_thread, self._drafts.adopt, "level"))
        except OSError:
            return  # what is edited now can't be kept either, and that is told then
        if drafts:
            from logical_robots_tui.tui.recovery.offers import offer

            await offer(offers, drafts, self._drafts, self._go_on)

    async def _go_on(self, level: Level, draft: Draft) -> None:
        await self._open_level(level)
        self.open(draft.path)
