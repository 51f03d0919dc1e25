"""The page of the inspector that scans the whole run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.pages.diagnosis import DiagnosisPage
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

LATE = """\
Robot(robot_name:, desire: {left_engine: 0.2, right_engine: 0.2}, memory: "") :-
  Sensor(robot_name:);
Robot(robot_name:, desire: {left_engine: 0.1, right_engine: 0.1}, memory: "") :-
  Sensor(robot_name:, sensor:), sensor.clock > 2;
"""


def page(game: Opened) -> DiagnosisPage:
    return game.main.query_one(DiagnosisPage)


async def scanned(game: Opened) -> None:
    await game.ready()
    for tick in range(1, 5):
        await game.press("n")
        await game.until(lambda: game.tick == tick)  # noqa: B023 - waited for here
    game.main.action_command("diagnose")
    await game.until(lambda: page(game).view.has_focus)
    await game.sees("Scan the run up to tick 4")
    await game.sees("enter Scan")
    await game.press("enter")
    await game.until(lambda: page(game).found is not None)


async def test_the_run_is_scanned_and_a_finding_leads_to_its_tick(data_dir: Path) -> None:
    async with opened(data_dir, text=LATE) as game:
        await scanned(game)
        assert game.inspector.inspected == "diagnosis"
        await game.sees("Ticks 1 to 4, not won.")
        await game.sees("warning, line 3, tick 3")
        await game.press("down")
        await game.until(lambda: game.editor.selected_text.startswith("Robot(robot_name:, des"))
        await game.press("enter")
        await game.until(lambda: game.tick == 3)


async def test_it_is_offered_again_when_the_run_has_gone_on(data_dir: Path) -> None:
    async with opened(data_dir, text=LATE) as game:
        await scanned(game)
        await game.press("n")
        await game.sees("Scan again up to tick 5")


async def test_findings_about_an_earlier_program_or_run_say_so(data_dir: Path) -> None:
    async with opened(data_dir, text=LATE) as game:
        await scanned(game)
        await game.sees("Ticks 1 to 4, not won.")
        assert not game.shows("This is about")
        game.session.apply(f"{LATE}\n")
        await game.sees("This is about an earlier program. Ticks 1 to 4, not won.")
        await game.press("p")
        await game.until(lambda: game.tick == 3)
        await game.press("n")
        await game.until(lambda: game.tick == 4)
        game.session.apply(LATE)
        await game.sees("This is about an earlier run. Ticks 1 to 4, not won.")
        await game.press("home", "enter")
        await game.sees_no("This is about")


async def test_all_of_it_is_usable_on_a_small_screen(data_dir: Path) -> None:
    async with opened(data_dir, text=LATE, size=(80, 24)) as game:
        await scanned(game)
        await game.sees("warning, line 3, tick 3")
