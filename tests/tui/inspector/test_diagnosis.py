"""The page of the inspector that scans the whole run."""

from pathlib import Path

import pytest

from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from tests.tui.conftest import Opened
from tests.tui.inspector.steps import pressed, run_until, sees_all, started

LATE = """\
Robot(robot_name:, desire: {left_engine: 0.2, right_engine: 0.2}, memory: "") :-
  Sensor(robot_name:);
Robot(robot_name:, desire: {left_engine: 0.1, right_engine: 0.1}, memory: "") :-
  Sensor(robot_name:, sensor:), sensor.clock > 2;
"""


def page(game: Opened) -> DiagnosisPage:
    return game.main.query_one(DiagnosisPage)


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.slow)])
async def test_the_run_is_scanned_and_a_finding_leads_to_its_tick(
    data_dir: Path, size: tuple[int, int]
) -> None:
    async with started(data_dir, text=LATE, size=size) as game:
        await run_until(game, 4)
        game.main.action_command("diagnose")
        await game.until(lambda: page(game).view.has_focus)
        await sees_all(game, "Scan the run up to tick 4", "enter Scan")
        await pressed(game, "enter", until=lambda: page(game).found is not None)
        assert game.inspector.inspected == "diagnosis"
        await sees_all(game, "warning, line 3, tick 3", "Ticks 1 to 4, not won.")
        await game.press("down")
        await game.until(lambda: game.editor.selected_text.startswith("Robot(robot_name:, des"))
        await pressed(game, "enter", tick=3)

        # It is offered again when the run has gone on.
        await pressed(game, "n", "n", sees="Scan again up to tick 5")
        await pressed(game, "p", tick=4)
        assert not game.shows("This is about")

        # Findings about an earlier program or run say so.
        game.session.apply(f"{LATE}\n")
        await game.sees("This is about an earlier program. Ticks 1 to 4, not won.")
        await pressed(game, "p", tick=3)
        await pressed(game, "n", tick=4)
        game.session.apply(LATE)
        await game.sees("This is about an earlier run. Ticks 1 to 4, not won.")
        await game.press("home", "enter", sees_no="This is about")
