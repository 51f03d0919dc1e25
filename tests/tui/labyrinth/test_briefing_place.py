"""The briefing never lies over the map that it explains."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.commands.keymap import KEY_MAP, KeyMap
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.briefing import Task
from logical_robots_tui.world import list_levels, load_level
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened


def shows_beside_the_map(game: Opened) -> bool:
    """Whether the whole briefing is on the screen, and no cell of it over the map."""
    briefing, view = game.main.briefing, game.main.labyrinth.view
    shown = [card.region for card in (briefing.beside, briefing.over) if card.display]
    return (
        len(shown) == 1
        and shown[0].area > 0
        and view.region.area > 0
        and not shown[0].overlaps(view.region)
        and game.main.region.contains_region(shown[0])
        and all(game.shows(words) for words in ("First steps", "mirrored labyrinth", "t lesson"))
    )


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (90, 50), (200, 60)])
async def test_the_briefing_finds_its_place_at_any_size(
    data_dir: Path, size: tuple[int, int]
) -> None:
    file = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=file, text=STILL, size=size) as game:
        await game.ready()
        await game.until(partial(shows_beside_the_map, game))
        for other in ((140, 45), (80, 24), (120, 40)):
            await game.pilot.resize_terminal(*other)
            await game.until(partial(shows_beside_the_map, game))
        await game.press("b")
        await game.until(lambda: not game.main.briefing.is_open and not game.shows("t lesson"))
        await game.press("b")
        await game.until(partial(shows_beside_the_map, game))
        await game.press("k")
        await game.until(partial(shows_beside_the_map, game))
        await game.press("k")
        await game.until(partial(shows_beside_the_map, game))


async def test_the_inspector_uncovers_itself_when_it_is_used(data_dir: Path, short: Path) -> None:
    async with opened(data_dir, level=short, text=STILL) as game:
        await game.ready()
        await game.until(lambda: game.main.briefing.over.display)
        await game.press("3")
        await game.until(lambda: not game.main.briefing.over.display)


@pytest.fixture
def key_map() -> None:
    KEY_MAP.set(KeyMap(COMMANDS))


@pytest.mark.parametrize("name", list_levels())
@pytest.mark.usefixtures("key_map")
def test_each_shipped_briefing_fits_in_its_smallest_place(name: str) -> None:
    task = Task.of(load_level(name))
    assert len(task.side_by_side(105, 9).split("\n", allow_blank=True)) <= 9
    assert len(task.stacked(36).split("\n", allow_blank=True)) <= 20
