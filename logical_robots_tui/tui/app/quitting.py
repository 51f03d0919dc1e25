"""Leaving the game, but not without a word where that would lose what was typed or drawn."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.tui.theme.safe_text import clip, one_line

if TYPE_CHECKING:
    from logical_robots_tui.game.drafts import Draft
    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["leave"]


def leave(screen: MainScreen) -> None:
    """End the game; ask first if what is not saved can't be kept either."""
    screen.autosave.flush()
    screen.editing.flush()
    lost = screen.drafts.unwritten()
    if lost:
        screen.spawn(partial(_ask, screen, *lost[0]), "leaving", exclusive=True)
    else:
        screen.app.exit()


async def _ask(screen: MainScreen, draft: Draft, error: OSError) -> None:
    from logical_robots_tui.tui.layout.question import Question

    question = (
        f"What you changed in “{clip(one_line(draft.name), 40)}” is not saved and can't be "
        f"kept for the next time: {error.strerror or error}."
    )
    answers = [("stay", "Stay"), ("leave", "Leave without it")]
    answer = await screen.app.push_screen_wait(Question("Not saved", question, answers))
    if answer == "leave":
        screen.app.exit()
