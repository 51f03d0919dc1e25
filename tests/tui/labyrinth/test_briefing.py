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
        await game.sees(TASK)
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
        await game.sees(TASK)
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
        await game.sees(TASK)
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
        await game.sees_no(TASK)
        await game.press("escape")
        await game.until(lambda: not game.main.editing.is_on and game.shows(TASK))


async def test_a_stuck_robot_is_told_and_marked(data_dir: Path, short: Path) -> None:
    ahead = STILL.replace("left_engine: 0.0", "left_engine: 1.0")
    backwards = ahead.replace("right_engine: 0.0", "right_engine: 1.0").replace(": 1.0", ": -1.0")
    async with opened(data_dir, level=short, text=backwards) as game:
        await game.ready()
        game.session.run_until(150)
        await game.sees("Pip is stuck: blocked for 100 ticks.")
        await game.until(lambda: game.tick == 150)
        history = game.session.history
        assert history is not None
        await game.press("left_curly_bracket")
        await game.sees("⊘ Pip is stuck")
        first = game.tick
        ticks = range(first - 99, first + 1)
        assert all(history.replay(tick)[1].moment.after.robots[0].blocked for tick in ticks)
        game.session.go_to(first - 50)
        await game.until(lambda: game.tick == first - 50)
        await game.write(backwards.replace("memory: 1", "memory: 2"))
        await game.until(lambda: "memory: 2" in (game.session.state.applied or ""))
        game.session.run_until(first + 20)
        await game.until(lambda: game.tick == first + 20)
        assert [mark.kind for mark in history.marks.at(first)].count("stuck") == 1


async def test_a_robot_that_goes_round_in_circles_is_told_and_marked(
    data_dir: Path, short: Path
) -> None:
    turning = STILL.replace("left_engine: 0.0", "left_engine: 0.5")
    async with opened(data_dir, level=short, text=turning) as game:
        await game.ready()
        game.session.run_until(900)
        await game.sees("Pip goes round in circles: 3 times the same way.")
        await game.until(lambda: game.tick == 900)
        await game.press("left_curly_bracket")
        await game.sees("↻ Pip goes in circles")
        history, first = game.session.history, game.tick
        assert history is not None
        await game.write(turning.replace("memory: 1", "memory: 2"))
        await game.until(lambda: "memory: 2" in (game.session.state.applied or ""))
        game.session.run_until(first + 50)
        await game.until(lambda: game.tick == first + 50)
        assert not history.marks.has("circling", first + 1, first + 50), "it has only begun"
