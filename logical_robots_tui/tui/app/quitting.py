"""Leaving the game, with a question if that would lose work."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Protocol

from logical_robots_tui.tui.theme.safe_text import clip, one_line

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.game.drafts import Draft, Drafts
    from logical_robots_tui.tui.app.ui import Ui

__all__ = ["Unsaved", "leave"]


class Unsaved(Protocol):
    """Can save unsaved work."""

    def flush(self) -> None:
        """Save it now."""


def leave(ui: Ui, end: Callable[[], None], drafts: Drafts, *unsaved: Unsaved) -> None:
    """End the game; ask first if unsaved work can't be kept.

    Args:
        ui: The user interface.
        end: Ends the game.
        drafts: The drafts of unsaved work.
        unsaved: Those who write the drafts.
    """
    for each in unsaved:
        each.flush()
    lost = drafts.unwritten()
    if lost:
        ui.spawn(partial(_ask, ui, end, *lost[0]), "leaving", exclusive=True)
    else:
        end()


async def _ask(ui: Ui, end: Callable[[], None], draft: Draft, error: OSError) -> None:
    from logical_robots_tui.tui.layout.dialogs import Question

    question = (
        f"What you changed in “{clip(one_line(draft.name), 40)}” is not saved and can't be "
        f"kept for next time: {error.strerror or error}."
    )
    answers = [("stay", "Stay"), ("leave", "Leave without it")]
    if await ui.ask(Question("Not saved", question, answers)) == "leave":
        end()
