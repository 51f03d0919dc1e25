"""Panes that take the size of what they hold, and keep it while robots run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

LARGE = (200, 60)
MANY_ROWS = """\
Robot(robot_name:, desire: {left_engine: 1.0, right_engine: 1.0}, memory: 1) :-
  Sensor(robot_name:, sensor:);
Many(n) :- n in Range(20);
"""


def heights(game: Opened) -> list[int]:
    return [pane.outer_size.height for pane in game.main.arrangement.panes]


async def settled(game: Opened) -> list[int]:
    await game.settled()
    return heights(game)


async def test_the_inspector_is_as_high_as_its_list_at_first(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE) as game:
        await game.ready()
        labyrinth, program, inspector = await settled(game)
        assert inspector == 6 + 2 + 2 + 2, "pages, inputs, predicates, border"
        assert labyrinth == program == 60 - 3 - inspector


async def test_a_page_that_needs_more_gets_it_and_keeps_it(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE, text=MANY_ROWS) as game:
        await game.ready()
        before = (await settled(game))[2]
        await game.press("n", "3", "end")
        await game.until(lambda: game.inspector.inspected == "Many")
        await game.until(lambda: heights(game)[2] > before)
        large = await settled(game)
        assert game.inspector.page.view.size.height >= 20
        await game.press("home")
        await game.until(lambda: game.inspector.inspected == "robots")
        assert await settled(game) == large


async def test_nothing_moves_while_robots_run_or_step(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE) as game:
        await game.ready()
        before = await settled(game)
        await game.press("n", "n")
        await game.until(lambda: game.tick == 2)
        assert await settled(game) == before
        await game.press("space")
        await game.until(lambda: game.tick > 20)
        assert heights(game) == before


async def test_sizes_that_the_player_chose_stay(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE, text=MANY_ROWS) as game:
        await game.ready()
        before = (await settled(game))[2]
        await game.press("I")
        await game.until(lambda: heights(game)[2] > before)
        chosen = await settled(game)
        await game.press("3", "end")
        await game.until(lambda: game.inspector.inspected == "Many")
        assert await settled(game) == chosen
        await game.press("1", "greater_than_sign")
        await game.until(lambda: game.session.level.name == "01-first-steps")
        await game.ready()
        assert await settled(game) == chosen


async def test_another_level_has_its_own_sizes(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE, text=MANY_ROWS) as game:
        await game.ready()
        await game.press("3", "end")
        await game.until(lambda: heights(game)[2] > 20)
        await game.press("1", "greater_than_sign")
        await game.until(lambda: game.session.level.name == "01-first-steps")
        await game.ready()
        await game.until(lambda: heights(game)[2] == 11)
        view = game.main.labyrinth.view
        assert view.size.width == 200 - 70 - 2


async def test_a_proof_gets_as_much_room_as_there_may_be(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE) as game:
        await game.ready()
        await game.press("n", "w")
        await game.until(lambda: heights(game)[2] >= 18)
