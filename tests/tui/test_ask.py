"""Ask, in the game: any query is answered for the tick on the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.asking import QueryLine
from tests.short import AHEAD
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


def line(game: Opened) -> QueryLine:
    return game.main.query_one(QueryLine)


async def ask(game: Opened, query: str) -> None:
    if not line(game).has_focus:
        await game.press("slash")
        await game.until(lambda: line(game).has_focus)
    line(game).value = query
    await game.press("enter")


async def test_a_query_is_answered_and_follows_the_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.ready()
        await ask(game, "Sensor(sensor:), clock == 100 + sensor.clock")
        await game.until(lambda: game.shows("Ask · tick 0 · 1 row"))
        assert game.shows("100")
        await game.press("escape", "n")
        await game.until(lambda: game.shows("Ask · tick 1 · 1 row"))
        await game.until(lambda: game.shows("101"))


async def test_a_query_can_be_typed_before_the_page_for_it_is_loaded(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.press("slash", *"Robot", "enter")
        await game.until(lambda: game.shows("Ask · tick 0 · 1 row"))


async def test_a_mistake_is_shown_at_its_place_and_changes_nothing(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.ready()
        await ask(game, "Sensor(robot_nam:)")
        await game.until(lambda: game.shows("Sensor has no column robot_nam."))
        assert game.shows("       ^^^^^^^^^")
        assert game.shows("Did you mean robot_name?")
        assert game.tick == 0
        assert line(game).value == "Sensor(robot_nam:)"
        line(game).value = "Sensor(r"
        await game.until(lambda: not game.shows("Sensor has no column"))


async def test_a_query_that_fails_says_why(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.ready()
        await ask(game, 'x in ["a"], x.field == 2')
        await game.until(lambda: game.shows("neither a record nor a list"))


async def test_no_rows_are_no_rows(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.ready()
        await ask(game, "x in [1], x > 2")
        await game.until(lambda: game.shows("No rows."))


async def test_up_brings_earlier_queries_back(data_dir: Path) -> None:
    async with opened(data_dir, text=AHEAD) as game:
        await game.ready()
        await ask(game, "1 + 1")
        await game.until(lambda: game.shows("1 row"))
        await ask(game, "2 + 2")
        await game.until(lambda: game.shows("       4"))
        await game.press("up")
        await game.until(lambda: line(game).value == "2 + 2")
        await game.press("up")
        await game.until(lambda: line(game).value == "1 + 1")
        await game.press("down", "down")
        await game.until(lambda: line(game).value == "")


async def test_names_are_completed(data_dir: Path) -> None:
    async with opened(data_dir, text="Lighthouse(1);\n" + AHEAD) as game:
        await game.ready()
        await game.press("slash")
        await game.until(lambda: line(game).has_focus)
        await game.press(*"1 < 2, Lig")
        await game.until(lambda: line(game)._suggestion == "1 < 2, Lighthouse")
        await game.press("right")
        await game.until(lambda: line(game).value == "1 < 2, Lighthouse")
