"""The page of the inspector that scans the whole run."""

from pathlib import Path

from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from tests.tui.conftest import Opened, Size, at_both_sizes, opened

LATE = """\
Robot(robot_name:, desire: {left_engine: 0.2, right_engine: 0.2}, memory: "") :-
  Sensor(robot_name:);
Robot(robot_name:, desire: {left_engine: 0.1, right_engine: 0.1}, memory: "") :-
  Sensor(robot_name:, sensor:), sensor.clock > 2;
"""


def page(game: Opened) -> DiagnosisPage:
    return game.main.query_one(DiagnosisPage)


@at_both_sizes
async def test_a_run_is_scanned_and_a_finding_leads_to_its_tick(data_dir: Path, size: Size) -> None:
    async with opened(data_dir, text=LATE, size=size, ready=True) as game:
        await game.run_until(4)
        await game.command("diagnose", until=lambda: page(game).view.has_focus)
        await game.sees("Scan the run up to tick 4", "enter Scan")
        await game.press("enter", until=lambda: page(game).found is not None)
        assert game.inspector.inspected == "diagnosis"
        await game.sees("warning, line 3, tick 3", "Ticks 1 to 4, not won.")
        await game.press("down")
        await game.until(lambda: game.editor.selected_text.startswith("Robot(robot_name:, des"))
        await game.press("enter", tick=3)

        # It is offered again when the run has gone on.
        await game.press("n", "n", sees="Scan again up to tick 5")
        await game.press("p", tick=4)
        assert not game.shows("This is about")

        # Findings about an earlier program or run say so.
        game.session.apply(f"{LATE}\n")
        await game.sees("This is about an earlier program. Ticks 1 to 4, not won.")
        await game.press("p", tick=3)
        await game.press("n", tick=4)
        game.session.apply(LATE)
        await game.sees("This is about an earlier run. Ticks 1 to 4, not won.")
        await game.press("home", "enter", sees_no="This is about")
