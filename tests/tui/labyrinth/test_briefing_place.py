"""The briefing hides no robot and no goal where there is room elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from textual.content import Content
from textual.geometry import Region

from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.tui.labyrinth.briefing import least_covering
from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport
from logical_robots_tui.world import list_levels, load_level
from tests.tui.conftest import STILL, opened

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.world import Level
    from tests.tui.conftest import Opened

CROWDED = "12-swarm"
SMALL, LARGE = [(80, 20), (65, 24)], (109, 38)
"""The picture in terminals of 80x24, 120x40 and 200x60."""


def hidden(level: Level, viewport: Viewport, region: Region) -> list[str]:
    """The robots and goals whose middle is under a region of a picture."""
    things = [(robot.name, robot.x, robot.y) for robot in level.robots]
    things += [(area.name, area.x, area.y) for area in level.areas if area.victory_robots]
    cells = {name: viewport.cell(x, y) for name, x, y in things}
    return [name for name, cell in cells.items() if cell and region.contains(cell[1], cell[0])]


@pytest.mark.parametrize(
    ("name", "pane"),
    [
        *((name, LARGE) for name in list_levels() if name != CROWDED),
        *((name, pane) for name in list_levels()[:3] for pane in SMALL),
    ],
)
def test_no_shipped_briefing_hides_a_robot_or_a_goal(name: str, pane: tuple[int, int]) -> None:
    level = load_level(name)
    viewport = Viewport.fit(level.width, level.height, *pane)
    text = Content(level.briefing + "keys\nkeys")
    content, region = least_covering(level, viewport, text, text)
    assert content is text
    assert Region(0, 0, *pane).contains_region(region)
    assert hidden(level, viewport, region) == []


def shown(game: Opened) -> tuple[list[str], Region]:
    """What the briefing hides, and its cells within the picture."""
    pane = game.main.labyrinth
    assert pane.view.view is not None
    region = pane.briefing.region.translate(-pane.view.region.offset)
    return hidden(game.session.level, pane.view.view, region), region


@pytest.mark.parametrize("size", [(80, 24), (120, 40), (200, 60)])
async def test_the_briefing_finds_its_place_at_any_size(
    data_dir: Path, size: tuple[int, int]
) -> None:
    file = shipped_folder("levels") / "01-first-steps.toml"
    async with opened(data_dir, level=file, text=STILL, size=size) as game:
        await game.ready()
        await game.until(lambda: game.shows("Bring Ada into") and game.shows("t lesson"))
        assert shown(game)[0] == []
        before = shown(game)[1]
        await game.pilot.resize_terminal(140, 45)
        await game.until(lambda: shown(game)[1] != before and game.shows("t lesson"))
        assert shown(game)[0] == []
        await game.press("b")
        await game.until(lambda: not game.main.labyrinth.briefing.display)
        await game.press("b")
        await game.sees("t lesson")
