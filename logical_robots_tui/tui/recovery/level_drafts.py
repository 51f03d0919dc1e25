"""Autosave: writes a level that is edited to a draft, soon after every change."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.editing.native_text import write_native
from logical_robots_tui.game.drafts import Draft
from logical_robots_tui.world.native import read_native

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game.drafts import Drafts
    from logical_robots_tui.world import Level

__all__ = ["Autosave"]

_DELAY = 1.0  # seconds from a change to its draft on disk


class Autosave:
    """Keeps what is edited safe; a hangup loses a second of it at most.

    Args:
        drafts: Where to.
        key: Says which level it is: the path of its file.
        title: Its name, to show.
        level: Gives the level, or None if it is as in its file.
        failed: Called once with a sentence when drafts can't be written.
    """

    def __init__(
        self,
        drafts: Drafts,
        key: str,
        title: str,
        level: Callable[[], Level | None],
        failed: Callable[[str], None],
    ) -> None:
        self._drafts = drafts
        self._key = key
        self._title = title
        self._level = level
        self._failed = failed
        self._has_failed = False
        self._written: Level | None = None
        self._pending: asyncio.Task[None] | None = None

    def edited(self) -> None:
        """The level has changed; a draft follows in a moment, or the one there is goes."""
        if self._pending is None or self._pending.done():
            self._pending = asyncio.create_task(self._keep_soon())

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        try:
            self._keep(self._level(), self._draft())
        except OSError as error:
            self._say(error)

    def stop(self) -> None:
        """Write the draft and nothing after it."""
        if self._pending is not None:
            self._pending.cancel()
        self.flush()

    def drop(self) -> None:
        """Forget the draft: the level is saved, or not wanted."""
        if self._pending is not None:
            self._pending.cancel()
        self._written = None
        self._drafts.drop(self._key)

    def read(self, base: Level) -> Level | None:
        """What was made of a level and not saved, in this session or one that is over, or None.

        Args:
            base: The level as it is in its file; its name and source are those of the other.

        Raises:
            LevelError: The draft is no level.
        """
        draft = self._drafts.get(self._key) or self._drafts.take(self._key)
        return None if draft is None else read_native(draft.text, base.name, base.source)

    def rename(self, key: str, title: str) -> None:
        """Keep drafts under another name from now on."""
        self._key, self._title = key, title

    async def _keep_soon(self) -> None:
        level = self._written
        while self._level() is not level:
            await asyncio.sleep(_DELAY)
            level = self._level()
            try:
                await asyncio.to_thread(self._keep, level, self._draft())
            except OSError as error:
                self._say(error)
                return

    def _draft(self) -> Draft:
        """A draft without its text; of two, the one that was made later stays."""
        return Draft(self._title, self._key, "", "")

    def _keep(self, level: Level | None, draft: Draft) -> None:
        if level is None:
            self._drafts.drop(self._key)
        elif level is not self._written:
            self._drafts.keep(replace(draft, text=write_native(level)))
        self._written = level

    def _say(self, error: OSError) -> None:
        if not self._has_failed:
            self._has_failed = True
            reason = error.strerror or str(error)
            self._failed(f"What you edit can't be kept on disk: {reason}. Save it elsewhere.")
