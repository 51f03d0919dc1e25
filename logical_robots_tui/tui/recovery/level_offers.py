"""Levels that were edited and not saved when a session ended badly."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_file
from logical_robots_tui.tui.theme.safe_text import clip, one_line
from logical_robots_tui.world import load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.native import read_native

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Sequence

    from logical_robots_tui.game.drafts import Draft, Drafts
    from logical_robots_tui.tui.recovery.offers import Offers
    from logical_robots_tui.world import Level

__all__ = ["offer"]


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
