"""Offers of what an earlier session left: unsaved texts and levels, and its place."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_file
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.world import load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.native import read_native

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Sequence

    from textual import events

    from logical_robots_tui.game.drafts import Draft, Drafts
    from logical_robots_tui.tui.app.ui import Ui
    from logical_robots_tui.tui.layout.dialogs import Question
    from logical_robots_tui.world import Level

__all__ = ["Offering", "Offers", "offer"]

Found = TypeVar("Found")

_NOTICING = 0.7
"""Seconds in which a player sees that there is a question; a key before was meant for the game.

To see something new and hold back a key that is on its way takes half a second or so.
"""


class Offering(Protocol):
    """Has something that an earlier session left."""

    async def offer(self, offers: Offers) -> None:
        """Offer it, if there is anything."""


class Offers:
    """Asks when nothing else lies over the game, and leaves the game's keys alone.

    Args:
        ui: Where to ask.
        is_free: Tells whether nothing lies over the game.
    """

    def __init__(self, ui: Ui, is_free: Callable[[], bool]) -> None:
        self._ui, self._is_free = ui, is_free
        self._resumed = asyncio.Event()
        self._asked: Question | None = None

    async def make(self, *offerings: Offering) -> None:
        """Offer all that there is, one after the other."""
        for each in offerings:
            await each.offer(self)

    def resumed(self) -> None:
        """Nothing lies over the game any more."""
        self._resumed.set()

    async def at_hand(self, find: Callable[[], Awaitable[Found]]) -> Found:
        """Return what is to be offered, as it is when nothing lies over the game."""
        while True:
            await self._free()
            found = await find()
            if self._is_free():
                return found

    async def ask(
        self, title: str, question: str, answers: Sequence[tuple[str, str]], *, text: str = ""
    ) -> str | None:
        """Ask, and return the name of the answer; None if there is none.

        Args:
            title: What it is about.
            question: The question.
            answers: Pairs of name and label.
            text: A text to show when asked, under the answer ``show``.
        """
        from logical_robots_tui.tui.layout.dialogs import Question

        await self._free()
        self._asked = Question(title, question, answers, text=text, noticing=_NOTICING)
        return await self._ui.ask(self._asked)

    def overhears(self, event: events.Key | events.Paste) -> bool:
        """Whether a key comes to a question that the player can't have seen when pressing it."""
        asked = self._asked
        return asked is not None and asked.is_active and event.time < asked.answered_from

    async def _free(self) -> None:
        while not self._is_free():
            self._resumed.clear()
            await self._resumed.wait()


async def offer(
    offers: Offers,
    drafts: Sequence[Draft],
    store: Drafts,
    go_on: Callable[[Level, Draft], Awaitable[None]],
) -> None:
    """Offer the newest level that can be gone on with; others are offered the next time.

    Args:
        offers: Asks.
        drafts: What was left, the newest first.
        store: Where that is.
        go_on: Goes on with a level.
    """
    for draft in drafts:
        found = await asyncio.to_thread(_read, draft)
        if found is None:
            await asyncio.to_thread(store.put_away, draft.key)
            continue
        when = draft.saved.astimezone()
        name = clip(one_line(draft.name), 40)
        question = f"Go on editing the level “{name}” from {when:%H:%M, %d %B}?"
        answers = [("yes", "Yes, go on"), ("no", "No, put it away")]
        answer = await offers.ask("Unsaved level", question, answers)
        if answer == "yes":
            await go_on(found, draft)
        elif answer == "no":
            await asyncio.to_thread(store.put_away, draft.key)
        return


def _read(draft: Draft) -> Level | None:
    """The level as it is in its file, or as it was edited if it has none any more.

    None if there is nothing to go on with.
    """
    try:
        path = Path(draft.path)
        if path.is_absolute() and is_file(path):
            base = load_level(path)
            level = read_native(draft.text, base.name, base.source)
            return None if alike(base, level) else base
        name = draft.path.removeprefix("new ").rpartition(" ")[0]
        return read_native(draft.text, name or path.stem, "")
    except InputError:
        return None
