"""The guided tour: once, past every part of the screen, and never in the way."""

from pathlib import Path

import pytest

from logical_robots_tui.player.recorder import TOUR
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.tui.learning.tour import STOPS, Tour
from tests.tui.conftest import Opened, Size, opened


def is_shown(game: Opened) -> bool:
    return bool(game.main.query(Tour))


def is_seen(data_dir: Path) -> bool:
    return Progress(data_dir / FILE_NAME).fact(TOUR) is not None


@pytest.mark.sampled
@pytest.mark.parametrize("size", [(120, 40), (80, 24), (46, 12)])
async def test_it_passes_every_part_of_the_screen(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, welcome=True, size=size) as game:
        await game.until(lambda: is_shown(game))
        for number, stop in enumerate(STOPS, start=1):
            await game.sees(f"{stop.title} · {number} of {len(STOPS)}")
            await game.later(0.1)
            assert game.main.region.contains_region(game.main.query_one(Tour).region)
            assert game.main.query_one(f"#{stop.place}").region.area
            assert game.shows("skip the tour")
            await game.press("enter")
        await game.until(lambda: not is_shown(game))
        assert game.main.focused is game.main.labyrinth
        assert not game.main.query(".-pointed")
    assert is_seen(data_dir)


async def test_one_goes_back_and_on_and_other_keys_do_what_they_always_do(data_dir: Path) -> None:
    async with opened(data_dir, welcome=True) as game:
        await game.sees("1 of 4")
        await game.click(Tour, sees="2 of 4")
        await game.press("left", "left", sees="1 of 4")
        await game.press("enter")
        await game.resize(80, 24)
        await game.until(lambda: game.main.region.contains_region(game.main.query_one(Tour).region))
        await game.ready()
        await game.press("n", tick=1)
        assert is_shown(game)
        await game.press("2", "x", until=lambda: game.editor.text.startswith("x"))
        assert not is_shown(game)
    assert is_seen(data_dir)


async def test_it_is_shown_when_asked_for_and_skipped_even_before_it_stands(data_dir: Path) -> None:
    async with opened(data_dir, ready=True) as game:
        assert not is_shown(game)
        await game.press("ctrl+p", sees="Find a command")
        await game.press(*"guided", "enter", sees="1 of 4")
        assert not is_seen(data_dir)
        await game.press("escape", until=lambda: not is_shown(game))
        assert game.main.focused is game.main.labyrinth
        game.main.tour.begin()
        assert game.main.query(Tour)
        game.main.tour.end()
        await game.until(lambda: not is_shown(game))
        await game.press("n", tick=1)
        assert game.main.focused is game.main.labyrinth
        game.main.tour.begin()
        await game.sees("1 of 4")
        await game.resize(20, 5, until=lambda: not is_shown(game))
    assert is_seen(data_dir)
