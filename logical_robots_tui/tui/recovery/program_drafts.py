"""The keeper: writes what is typed to a draft, soon after every edit."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from logical_robots_tui.game.drafts import Draft, Drafts, fingerprint

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from logical_robots_tui.game import Source

__all__ = ["Keeper"]

_DELAY = 0.25  # seconds from an edit to its draft on disk


class Keeper:
    """Keeps the text of the editor safe.

    Args:
        folder: Where drafts are.
        text: Gives the text in the editor.
        source: Gives the program that the text began with.
        failed: Called once with a sentence when drafts can't be written.
    """

    def __init__(
        self,
        folder: Path,
        *,
        text: Callable[[], str],
        source: Callable[[], Source],
        failed: Callable[[str], None],
    ) -> None:
        self.drafts = Drafts(folder)
        self._text = text
        self._source = source
        self._failed = failed
        self._has_failed = False
        self._pending: asyncio.Task[None] | None = None

    def edited(self) -> None:
        """The text has changed; a draft follows in a moment, or the one there is goes."""
        if self._pending is None or self._pending.done():
            self._pending = asyncio.create_task(self._keep_soon())

    def flush(self) -> None:
        """Write the draft now. Safe in a signal handler; never raises."""
        try:
            self._keep(self._draft())
        except OSError as error:
            self._say(error)

    def adopt(self) -> list[Draft]:
        """Drafts of sessions that ended badly, newest first, as far as they hold unsaved text."""
        try:
            return self.drafts.adopt()
        except OSError as error:
            self._say(error)
            return []

    def close(self) -> None:
        """Write the draft and end the session."""
        if self._pending is not None:
            self._pending.cancel()
        self.flush()
        self.drafts.close()

    async def _keep_soon(self) -> None:
        await asyncio.sleep(_DELAY)
        draft = self._draft()
        self._pending = None
        try:
            await asyncio.to_thread(self._keep, draft)
        except OSError as error:
            self._say(error)

    def _draft(self) -> Draft:
        source = self._source()
        return Draft(source.name, str(source.path), self._text(), fingerprint(source.text))

    def _keep(self, draft: Draft) -> None:
        if fingerprint(draft.text) == draft.base:
            self.drafts.drop(draft.path)
        else:
            self.drafts.keep(draft)

    def _say(self, error: OSError) -> None:
        if not self._has_failed:
            self._has_failed = True
            reason = error.strerror or str(error)
            self._failed(f"What you type can't be kept on disk: {reason}. Save it elsewhere.")
