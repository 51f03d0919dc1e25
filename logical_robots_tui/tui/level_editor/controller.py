"""The level editor's interface to the rest, which loads the editor when first used."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.player.session_state import SessionListener
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.player.drafts import Draft, Drafts
    from logical_robots_tui.player.recovery import Offers
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.level_editor.mode import EditMode, EditView


class LevelEditing(SessionListener):
    def __init__(
        self,
        session: Session,
        ui: Dialogs,
        own: Path,
        drafts: Drafts,
        open_level: Callable[[Level], Awaitable[None]],
        view: Callable[[EditMode], EditView],
    ) -> None:
        self._session, self._ui, self._open_level, self._view = session, ui, open_level, view
        self._own, self._drafts = own, drafts
        self.mode: EditMode | None = None
        """The edited level, or None before that."""

    @property
    def is_on(self) -> bool:
        """Whether keys and mouse edit the level."""
        return self.mode is not None and self.mode.is_on

    @property
    def level(self) -> Level:
        """The level to draw: that of the visible frame, or its edited version."""
        levels = self._session.levels
        return levels.edited if self.is_on else levels.shown

    def open(self, key: str = "") -> None:
        """Edit the current level, with its draft's key from a crashed session, if any."""
        from logical_robots_tui.tui.level_editor.mode import EditMode

        if self.mode is None:
            self.mode = EditMode(self._session, self._ui, self._own, self._drafts, self._view, key)
        self.mode.enter()

    async def make_level(self) -> None:
        from logical_robots_tui.tui.level_editor.forms import ask_for_level

        made = await ask_for_level(self._ui, self._session.level.name, self._own)
        if made is not None:
            await self._open_level(made)
            self.open()

    def handles(self, key: str) -> bool:
        """Run the editing command of a key; return whether there is one."""
        return self.mode is not None and self.mode.view.handles(key)

    def do(self, command_id: str) -> None:
        if self.mode is not None:
            self.mode.view.do(command_id)

    def level_opened(self, level: Level) -> None:
        """End editing for another level; unsaved changes stay in a draft."""
        if self.mode is not None:
            self.mode.end()
            self.mode = None

    def level_changed(self) -> None:
        if self.mode is not None and self.mode.is_on:
            self.mode.follow_game()

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        if self.mode is not None:
            self.mode.autosave.flush()

    def close(self) -> None:
        if self.mode is not None:
            self.mode.autosave.stop()

    async def offer(self, offers: Offers) -> None:
        try:
            drafts = await offers.at_hand(partial(asyncio.to_thread, self._drafts.adopt, "level"))
        except OSError:
            return  # current edits can't be kept either, which is reported then
        if drafts:
            from logical_robots_tui.player.recovery import offer

            await offer(offers, drafts, self._drafts, self._go_on)

    async def _go_on(self, level: Level, draft: Draft) -> None:
        await self._open_level(level)
        self.open(draft.path)
