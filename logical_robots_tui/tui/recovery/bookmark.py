"""The bookmark: where the game was when its terminal went away, to be restored later."""

from __future__ import annotations

import asyncio
import contextlib
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.game import Place, level_key, load_program, place_of
from logical_robots_tui.game.drafts import Draft
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.world import load_level

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game import Source
    from logical_robots_tui.game.drafts import Drafts
    from logical_robots_tui.tui.app.session import Session
    from logical_robots_tui.tui.app.ui import Ui
    from logical_robots_tui.tui.library.controller import LibraryController
    from logical_robots_tui.tui.recovery.offers import Offers

__all__ = ["Bookmark"]


class Bookmark:
    """Saves the place of a session that is cut off, and offers it to the next one.

    Args:
        session: The session.
        drafts: Where it is saved.
        ui: The user interface.
        library: Opens levels and programs.
        moved: Called before the robots go there.
    """

    def __init__(
        self,
        session: Session,
        drafts: Drafts,
        ui: Ui,
        library: LibraryController,
        moved: Callable[[], None],
    ) -> None:
        self._session, self._ui, self._library, self._moved = session, ui, library, moved
        self._drafts = drafts

    def flush(self) -> None:
        """Write the current place. Safe in a signal handler; never raises."""
        session = self._session
        if session.game is None:
            return
        place = place_of(session.game, session.opened, session.source)
        if place is not None:
            with contextlib.suppress(OSError):  # nobody is there to be told
                self._drafts.keep(Draft("place", place.title, place.level, place.as_text()))

    async def offer(self, offers: Offers) -> None:
        """Offer to go where an earlier session was cut off, if one was."""
        with contextlib.suppress(OSError):  # no folder, no bookmark
            for draft in (await asyncio.to_thread(self._drafts.adopt, "place"))[:1]:
                with contextlib.suppress(ValueError):
                    await self._ask(offers, Place.from_text(draft.text), draft)
                self._drafts.put_away(draft.key)

    async def _ask(self, offers: Offers, place: Place, draft: Draft) -> None:
        when = draft.saved.astimezone()
        question = (
            f"“{clip(one_line(place.title), 40)}” was cut off at tick {place.tick}, "
            f"{when:%H:%M, %d %B}. Continue exactly there?"
        )
        answers = [("yes", "Yes, continue"), ("no", "No, from the start")]
        if await offers.ask("Cut off", question, answers) == "yes":
            try:
                await self._go_to(place)
            except LogicalRobotsError as error:
                self._ui.warn(f"Can't continue at tick {place.tick}: {error}")

    async def _go_to(self, place: Place) -> None:
        """Go to a place; restored unsaved text stays in the editor."""
        if place.level != level_key(self._session.level):
            await self._library.open_level(await asyncio.to_thread(load_level, place.level))
        source = await asyncio.to_thread(self._source_of, place)
        is_unsaved = self._drafts.get(("program", str(source.path))) is not None
        self._library.open_program(source, None if is_unsaved else place.programs[-1][1])
        self._moved()
        await self._session.replay(place)

    def _source_of(self, place: Place) -> Source:
        """Return the program's source of a place; the current one if its file is gone."""
        try:
            return load_program(place.program)
        except InputError:
            return self._session.source
