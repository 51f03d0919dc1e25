"""A bookmark: where the game stood when its terminal went away, to be gone to again."""

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
    from logical_robots_tui.game import Source
    from logical_robots_tui.game.drafts import Drafts
    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["Bookmark"]


class Bookmark:
    """Keeps the tick of a session that is cut off, and offers it to the next one.

    Args:
        screen: Whose game.
        drafts: Where to keep it.
    """

    def __init__(self, screen: MainScreen, drafts: Drafts) -> None:
        self._screen = screen
        self._drafts = drafts

    def flush(self) -> None:
        """Write where the game stands. Safe in a signal handler; never raises."""
        session = self._screen.session
        if session.game is None:
            return
        place = place_of(session.game, session.opened, session.source)
        if place is not None:
            with contextlib.suppress(OSError):  # nobody is there to be told
                self._drafts.keep(Draft("place", place.title, place.level, place.as_text()))

    async def offer(self) -> None:
        """Offer to go where an earlier session was cut off, if one was."""
        with contextlib.suppress(OSError):  # no folder, no bookmark
            for draft in (await asyncio.to_thread(self._drafts.adopt, "place"))[:1]:
                with contextlib.suppress(ValueError):
                    await self._ask(Place.from_text(draft.text), draft)
                self._drafts.put_away(draft.key)

    async def _ask(self, place: Place, draft: Draft) -> None:
        screen, when = self._screen, draft.saved.astimezone()
        question = (
            f"“{clip(one_line(place.title), 40)}” was cut off at tick {place.tick}, "
            f"{when:%H:%M, %d %B}. Continue exactly there?"
        )
        answers = [("yes", "Yes, continue"), ("no", "No, from the start")]
        if await screen.offers.ask("Cut off", question, answers) == "yes":
            try:
                await self._go_to(place)
            except LogicalRobotsError as error:
                screen.warn(f"Can't continue at tick {place.tick}: {error}")

    async def _go_to(self, place: Place) -> None:
        """Go to a place; unsaved text that came back stays in the editor."""
        screen = self._screen
        if place.level != level_key(screen.session.level):
            await screen.library.open_level(await asyncio.to_thread(load_level, place.level))
        source = await asyncio.to_thread(self._source_of, place)
        is_unsaved = self._drafts.get(("program", str(source.path))) is not None
        screen.library.open_program(source, None if is_unsaved else place.programs[-1][1])
        screen.labyrinth.briefing.display = False
        await screen.session.replay(place)

    def _source_of(self, place: Place) -> Source:
        """Where the program of a place is from; the present one if its file is gone."""
        try:
            return load_program(place.program)
        except InputError:
            return self._screen.session.source
