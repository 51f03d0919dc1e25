"""The briefing: there at the start of a level, whenever that is on the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.tui.conftest import PAPER, STILL, opened

if TYPE_CHECKING:
    from pathlib import Path

TASK = "Bring Pip to the door."


async def test_the_briefing_comes_back_with_the_start(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=PAPER) as game:
        await game.ready()
        assert game.shows(TASK)
        view = game.main.labyrinth.view
        shown, size = view.view, view.size
        await game.press("space")
        await game.until(lambda: game.tick > 2 and not game.shows(TASK))
        assert (view.view, view.size) == (shown, size)
        await game.press("r")
        await game.until(lambda: game.tick == 0 and game.shows(TASK))
        assert (view.view, view.size) == (shown, size)
        await game.press("b")
        await game.until(lambda: not game.shows(TASK))
        await game.press("r")
        await game.until(lambda: game.shows(TASK))
        await game.press("n")
        await game.until(lambda: game.tick > 0 and not game.shows(TASK))
        await game.press("p")
        await game.until(lambda: game.tick == 0 and game.shows(TASK))
        await game.press("right_parenthesis")
        await game.until(lambda: game.tick > 0 and not game.shows(TASK))


async def test_the_briefing_can_be_read_under_way(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=STILL) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1 and not game.shows(TASK))
        await game.press("b")
        await game.until(lambda: game.shows(TASK))
        await game.press("b")
        await game.until(lambda: not game.shows(TASK))


async def test_the_briefing_stays_away_while_the_level_is_edited(
    data_dir: Path, short: Path
) -> None:
    async with opened(data_dir, level=short, text=STILL) as game:
        await game.ready()
        await game.press("n")
        await game.until(lambda: game.tick == 1)
        await game.press("M")
        await game.until(lambda: game.main.editing.is_on)
        game.session.go_to(0)
        await game.until(lambda: game.tick == 0)
        assert not game.shows(TASK)
        await game.press("escape")
        await game.until(lambda: not game.main.editing.is_on and game.shows(TASK))
