"""A wide inspector shows the selected page and the robot side by side."""

from pathlib import Path

from logical_robots_tui.tui.inspector.pages.decision import DecisionPage
from logical_robots_tui.tui.inspector.pages.predicate import PredicatePage
from logical_robots_tui.tui.inspector.pages.robots import RobotsPage
from logical_robots_tui.tui.inspector.table import ValueTable
from tests.tui.conftest import Opened, opened
from tests.tui.inspector.test_pane import MORE, inspect

WIDE = (156, 50)


def pages(game: Opened) -> list[str]:
    shown = [page for page in game.inspector.query(".heading") if page.region]
    shown.sort(key=lambda heading: heading.region.x)
    return [type(heading.parent).__name__ for heading in shown]


ROBOTS, DECISION, ROWS = (page.__name__ for page in (RobotsPage, DecisionPage, PredicatePage))


async def test_a_page_and_the_robot_stand_side_by_side_where_there_is_room(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=MORE, size=WIDE, ready=True) as game:
        await game.press("n", "3", until=lambda: pages(game) == [ROBOTS, DECISION])
        await inspect(game, "Names", until=lambda: pages(game) == [ROWS, DECISION])
        await game.sees("Decision of P · tick 1", "Names · tick 1 · 3 rows")
        await game.press("n", sees=("Decision of P · tick 2", "Names · tick 2 · 3 rows"))

        # Another robot is shown beside the same rows; all robots beside the page of the decision.
        await game.press("1", "a", "a", sees="Decision of Q · tick 2")
        assert game.inspector.inspected == "Names"
        game.inspector.inspect("decision")
        await game.until(lambda: pages(game) == [ROBOTS, DECISION])

        # Keys are about the page with the focus.
        game.inspector.open("Names")
        await game.until(lambda: pages(game) == [ROWS, DECISION])
        await game.press("tab", "tab", until=lambda: game.inspector.inspected == "decision")
        await game.press("enter", until=lambda: game.app.screen is not game.main)
        await game.sees("Decision of Q")
        await game.press("escape", until=lambda: game.app.screen is game.main)
        await game.resize(120, 40)
        await game.until(lambda: pages(game) == [ROWS] and game.shows("Names · tick 2 · 3 rows"))
        await game.sees_no("Decision of")
        assert game.inspector.inspected == "Names"
        assert game.main.focused is not None
        assert game.main.focused.id == "choice"

        # The selection and the focus survive other sizes.
        await inspect(game, "Ray", sees="Ray · tick 2 · 93 rows")
        await game.press("enter", "down", "down")
        table = game.main.query_one("#rows", ValueTable)
        await game.until(lambda: table.pointed is not None and table.pointed[1] is not None)
        place = table.place
        for size, shown in [((80, 24), [ROWS]), (WIDE, [ROWS, DECISION]), ((120, 40), [ROWS])]:
            await game.resize(*size)
            await game.until(lambda shown=shown: pages(game) == shown)  # type: ignore[misc] # once a turn
            assert game.inspector.inspected == "Ray"
            assert table.has_focus
            assert table.place == place
