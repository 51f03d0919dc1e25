"""The ghost: the player's best run, or a replay, beside the present one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.paths import write_atomically
from logical_robots_tui.world import load_level
from tests.short import AHEAD
from tests.tui.conftest import SHORT, Opened, opened

if TYPE_CHECKING:
    from pathlib import Path

SLOWER = AHEAD.replace("0.5", "0.1")


def ghosts(game: Opened) -> list[tuple[int, int]]:
    """Where the labyrinth shows ghosts, as (row, column)."""
    view = game.main.labyrinth.view
    rows = enumerate(view._cells.plain())
    signs = view.drawing.glyphs.ghosts
    return [(row, column) for row, line in rows for column, c in enumerate(line) if c in signs]


async def win(game: Opened, text: str = AHEAD) -> int:
    """Win with a program from the start, and return the tick."""
    await game.write(text)
    await game.until(lambda: game.session.state.applied == text)
    await game.press("escape", "r")
    game.session.run_until(1000)
    await game.sees("Again")
    await game.press("escape")
    await game.settled()
    return game.tick


async def command(game: Opened, words: str, title: str) -> None:
    await game.press("ctrl+p")
    await game.sees("Find a command")
    await game.press(*words)
    await game.sees(title)
    await game.press("enter")


async def run_to(game: Opened, tick: int) -> None:
    """Run to a tick, and wait until it is drawn."""
    game.session.run_until(tick)
    view = game.main.labyrinth.view
    await game.until(lambda: not game.session.busy and view._frame is game.session.frame)
    assert game.tick == tick


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_best_run_is_drawn_at_the_tick_that_is_shown(
    data_dir: Path, short: Path, size: tuple[int, int]
) -> None:
    async with opened(data_dir, level=short, text=AHEAD, size=size) as game:
        await game.ready()
        won = await win(game)
        await game.write(SLOWER)
        await game.until(lambda: game.session.state.applied == SLOWER)
        await game.press("escape", "r", "G")
        await game.sees(f"ghost: {won} ticks")
        assert not ghosts(game)  # the robot stands there
        await run_to(game, won // 2)
        ((_, halfway),) = ghosts(game)
        await run_to(game, won)
        ((_, there),) = ghosts(game)
        assert there > halfway
        await run_to(game, won + 5)
        assert [column for _, column in ghosts(game)] == [there]
        game.session.go_to(won // 2)
        await game.until(lambda: [column for _, column in ghosts(game)] == [halfway])
        await game.press("G")
        await game.sees("The ghost is off.")
        await game.sees_no("ghost: ")
        assert not ghosts(game)


async def test_reaching_an_area_is_compared_once_a_run(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        won = await win(game)
        await command(game, "bestrun"[:4], "Ghost")
        await game.sees("ghost: ")
        late = await win(game, SLOWER)
        words = f"Pip reached Door {late - won} ticks after your best run."
        await game.sees(words)
        await game.sees_no(words)
        await game.press("p", "n")
        await game.until(lambda: game.tick == late)
        await game.press("n")
        await game.until(lambda: game.tick == late + 1)
        assert not game.shows(words)
        await win(game)
        await game.sees("Pip reached Door in the same tick as your best run.")


async def test_a_better_run_replaces_the_ghost_and_a_worse_one_does_not(
    data_dir: Path, short: Path
) -> None:
    async with opened(data_dir, level=short, text=SLOWER) as game:
        await game.ready()
        slow = await win(game, SLOWER)
        await game.press("G")
        await game.sees(f"ghost: {slow} ticks")
        quick = await win(game)
        await game.sees(f"ghost: {quick} ticks")
        await win(game, SLOWER)
        await game.press("G", "G")
        await game.sees(f"ghost: {quick} ticks")


async def test_without_a_win_it_says_what_to_do(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await game.press("G")
        await game.sees("Win this level; then")
        assert game.main.labyrinth.view.ghost is None


async def test_a_damaged_best_run_is_told_and_nothing_is_lost(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await win(game)
        (path,) = (data_dir / "best-runs").iterdir()
        path.write_bytes(path.read_bytes()[:-1])
        await game.press("G")
        await game.sees("Your best run can't be read")
        await game.press("r")
        await win(game)
        await game.press("G")
        await game.sees("ghost: ")
        assert len(list((data_dir / "best-runs").iterdir())) == 2


async def test_a_changed_level_has_no_ghost(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await win(game)
        await game.press("G")
        await game.sees("ghost: ")
    write_atomically(short, SHORT.replace("x = 12", "x = 14"))
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await game.press("G")
        await game.sees("this level has changed since")
        assert game.main.labyrinth.view.ghost is None
        won = await win(game)
        await game.press("G")
        await game.sees(f"ghost: {won} ticks")


async def test_a_replay_is_raced(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await run_to(game, 20)
        await command(game, "savearep", "Save a replay")
        await game.sees("bytes).")
        await game.write(SLOWER)
        await game.until(lambda: game.session.state.applied == SLOWER)
        await game.press("escape", "r")
        await command(game, "racearep", "Race a replay")
        await game.sees("20 ticks")
        await game.press("enter")
        await game.sees("ghost: 20 ticks")
        late = await win(game, SLOWER)
        await game.sees("Pip reached Door, which the replay never did.")
        assert ghosts(game)
        assert late > 20


async def test_a_run_changed_by_hand_is_not_a_race(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await run_to(game, 3)
        game.session.put("Pip", (30.0, 12.0, 0.5))
        await run_to(game, 5)
        await command(game, "savearep", "Save a replay")
        await game.sees("bytes).")
        await command(game, "racearep", "Race a replay")
        await game.sees("5 ticks")
        await game.press("enter")
        await game.sees("can't be raced against")
        assert game.main.labyrinth.view.ghost is None


async def test_the_next_level_begins_without_a_ghost(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=AHEAD) as game:
        await game.ready()
        await win(game)
        await game.press("G")
        await game.sees("ghost: ")
        await game.main.library.open_level(load_level("01-first-steps"))
        await game.sees_no("ghost: ")
        assert game.main.labyrinth.view.ghost is None
