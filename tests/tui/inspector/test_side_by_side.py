"""A wide inspector shows the selected page and the robot side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.tui.inspector.pages.decision import DecisionPage
from logical_robots_tui.tui.inspector.pages.predicate import PredicatePage
from logical_robots_tui.tui.inspector.pages.robots import RobotsPage
from logical_robots_tui.tui.inspector.table import ValueTable
from tests.tui.conftest import opened
from tests.tui.inspector.test_pane import MORE, inspect

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

WIDE = (200, 60)


def pages(game: Opened) -> list[str]:
    """The pages on the screen, from left to right."""
    shown = [page for page in game.inspector.query(".heading") if page.region]
    shown.sort(key=lambda heading: heading.region.x)
    return [type(heading.parent).__name__ for heading in shown]


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("size", "beside"), [((80, 24), []), ((120, 40), []), (WIDE, [DecisionPage.__name__])]
)
async def test_rows_and_robot_stand_side_by_side_where_there_is_room(
    data_dir: Path, size: tuple[int, int], beside: list[str]
) -> None:
    async with opened(data_dir, level="team_goal", text=MORE, size=size) as game:
        await game.ready()
        await game.press("n", "3")
        await game.until(lambda: pages(game) == [RobotsPage.__name__, *beside])
        await inspect(game, "Names")
        await game.until(lambda: pages(game) == [PredicatePage.__name__, *beside])
        await game.sees("Names · tick 1 · 3 rows")
        if beside:
            await game.sees("Decision of P · tick 1")
        else:
            await game.sees_no("Decision of P · tick 1")
        await game.press("n")
        await game.sees("Names · tick 2 · 3 rows")
        await game.until(lambda: game.shows("Decision of P · tick 2") == bool(beside))


async def test_another_robot_is_shown_beside_the_same_rows(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=MORE, size=WIDE) as game:
        await game.ready()
        await inspect(game, "Names")
        await game.until(lambda: pages(game) == [PredicatePage.__name__, DecisionPage.__name__])
        await game.press("1", "a", "a")
        await game.sees("Decision of Q · tick 0")
        assert game.inspector.inspected == "Names"


async def test_the_page_of_the_decision_has_all_robots_beside_it(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE, size=WIDE) as game:
        await game.ready()
        await inspect(game, "Names")
        await game.until(lambda: pages(game) == [PredicatePage.__name__, DecisionPage.__name__])
        game.inspector.inspect("decision")
        await game.until(lambda: pages(game) == [RobotsPage.__name__, DecisionPage.__name__])


async def test_the_selection_and_the_focus_survive_other_sizes(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE, size=WIDE) as game:
        await game.ready()
        await game.press("3")
        await inspect(game, "Ray")
        await game.sees("Ray · tick 0 · 31 rows")
        await game.press("enter", "down", "down")
        table = game.main.query_one("#rows", ValueTable)
        await game.until(lambda: table.pointed is not None and table.pointed[1] is not None)
        place = table.place
        for size, shown in [
            ((120, 40), [PredicatePage.__name__]),
            ((80, 24), [PredicatePage.__name__]),
            (WIDE, [PredicatePage.__name__, DecisionPage.__name__]),
        ]:
            await game.pilot.resize_terminal(*size)
            await game.until(lambda shown=shown: pages(game) == shown)  # type: ignore[misc] # once a turn
            assert game.inspector.inspected == "Ray"
            assert table.has_focus
            assert table.place == place


async def test_keys_are_about_the_page_with_the_focus(data_dir: Path) -> None:
    async with opened(data_dir, text=MORE, size=WIDE) as game:
        await game.ready()
        await game.press("n", "3")
        await inspect(game, "Names")
        await game.sees("Names · tick 1 · 1 row")
        await game.press("tab", "tab")
        await game.until(lambda: game.inspector.inspected == "decision")
        await game.press("enter")
        await game.until(lambda: game.app.screen is not game.main)
        await game.sees("Decision of Solo")
        await game.press("escape")
        await game.until(lambda: game.app.screen is game.main)
        await game.pilot.resize_terminal(120, 40)
        await game.until(lambda: pages(game) == [PredicatePage.__name__])
        assert game.inspector.inspected == "Names"
        assert game.main.focused is not None
        assert game.main.focused.id == "choice"
