"""Panes that take the size of what they hold, and keep it while robots run."""

from pathlib import Path

from logical_robots_tui.tui.inspector.pane import PredicateList
from tests.tui.conftest import Opened, opened

LARGE = (200, 60)
MANY_ROWS = """\
Robot(robot_name:, desire: {left_engine: 1.0, right_engine: 1.0}, memory: 1) :-
  Sensor(robot_name:, sensor:);
Many(n) :- n in Range(20);
"""
BORDER = 2


def heights(game: Opened) -> list[int]:
    return [pane.outer_size.height for pane in game.main.arrangement.panes]


async def settled(game: Opened) -> list[int]:
    await game.settled()
    return heights(game)


def listed(game: Opened) -> int:
    return game.inspector.query_one(PredicateList).virtual_size.height


async def test_the_inspector_is_as_high_as_its_list_until_a_page_needs_more(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE, ready=True) as game:
        before = labyrinth, program, inspector = await settled(game)
        assert labyrinth == program == LARGE[1] - 3 - inspector
        await game.press("n", "n", tick=2)
        assert await settled(game) == before, "nothing moves while robots step"
        await game.press("space", until=lambda: game.tick > 20)
        assert heights(game) == before, "or run"
        await game.press("space", "3", until=lambda: game.inspector.inspected == "robots")
        assert (await settled(game), inspector) == (before, listed(game) + BORDER)
        await game.press("w", until=lambda: heights(game)[2] >= 18)
        await game.press("3", "home", until=lambda: game.inspector.inspected == "robots")
        x = round(game.session.frame.after.robots[0].x)
        assert not game.shows(f"x {x}   y "), "the table has room for it"
        await game.resize(80, 24, sees=f"x {x}   y ")


async def test_a_page_keeps_its_room_and_a_level_has_its_own_unless_chosen(data_dir: Path) -> None:
    async with opened(data_dir, size=LARGE, text=MANY_ROWS) as game:

        async def open_next(level: str) -> None:
            await game.press("1", "greater_than_sign")
            await game.until(lambda: game.session.level.name == level)
            await game.ready()

        await game.ready()
        before = (await settled(game))[2]
        await game.press("n", "3", sees="Many :3")
        await game.press("end", until=lambda: game.inspector.inspected == "Many")
        await game.until(lambda: heights(game)[2] > before)
        large = await settled(game)
        assert game.inspector.page.view.size.height >= 20
        await game.press("home", until=lambda: game.inspector.inspected == "robots")
        assert await settled(game) == large

        await open_next("01-first-steps")
        await game.until(lambda: heights(game)[2] == listed(game) + BORDER)
        before = heights(game)[2]
        assert game.main.labyrinth.view.size.width == LARGE[0] - 70 - BORDER

        await game.apply(MANY_ROWS)
        await game.press("escape", "I", until=lambda: heights(game)[2] > before)
        chosen = await settled(game)
        await game.press("3", sees="Many :3")
        await game.press("end", until=lambda: game.inspector.inspected == "Many")
        assert await settled(game) == chosen
        await open_next("02-open-space")
        assert await settled(game) == chosen
