"""Why, in the game: each rule part by part, deeper and back, for the robot and tick at hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.tui.inspector.choice import WHY
from logical_robots_tui.tui.inspector.why import WhyView
from tests.short import AHEAD
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path

    from tests.tui.conftest import Opened

TWO_RULES = """\
Speed(d) = 0.5 :- d > 20;
Robot(robot_name:, desire: {left_engine: Speed(d), right_engine: 1}, memory: "far") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d > 20;
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "near") :-
  Sensor(robot_name:, sensor:), d == sensor.forward_distance, d <= 20;
"""


def view(game: Opened) -> WhyView:
    return game.main.query_one(WhyView)


def told(game: Opened) -> list[str]:
    return [line.text for line in view(game).lines]


async def asked_why(game: Opened) -> None:
    await game.ready()
    await game.press("n")
    await game.until(lambda: game.tick == 1)
    await game.press("w")
    await game.until(lambda: view(game).lines)


async def test_one_key_says_why(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await asked_why(game)
        assert game.inspector.inspected == WHY
        assert game.shows("Why · tick 1")
        rules = [line for line in view(game).lines if line.kind == "rule"]
        assert [rule.said for rule in rules] == ["gave 1 row", "gave no row"]
        assert game.shows("✓ 2: Robot(")
        failed = next(line for line in view(game).lines if line.text == "d <= 20")
        assert failed.said == "in no way"


async def test_deeper_and_back(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await asked_why(game)
        place = next(n for n, line in enumerate(view(game).lines) if line.asked is not None)
        view(game).action_move(place)
        await game.press("enter")
        await game.until(lambda: told(game)[:1] == ["Speed(d) = 0.5 :- d > 20"])
        assert game.shows("Speed(")
        assert game.shows("← Robot")
        await game.press("left")
        await game.until(lambda: told(game)[0].startswith("Robot("))


async def test_the_place_is_shown_in_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await asked_why(game)
        place = told(game).index("d <= 20")
        view(game).action_move(place)
        await game.until(lambda: game.editor.selected_text == "d <= 20")
        await game.press("e", "x")
        await game.until(lambda: game.editor.text == TWO_RULES.replace("d <= 20", "xd <= 20"))


async def test_it_follows_the_tick_and_the_program(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await asked_why(game)
        await game.press("p")
        await game.until(lambda: game.shows("Why · tick 0"))
        await game.write(AHEAD)
        await game.until(lambda: told(game)[:1] and "0.5, right_engine: 0.5" in told(game)[0])


async def test_it_is_about_the_robot_that_is_chosen(data_dir: Path) -> None:
    async with opened(data_dir, level="team_goal", text=TWO_RULES) as game:
        await asked_why(game)
        await game.until(lambda: game.shows("P: Robot"))
        game.main.inspector.choose("Q")
        await game.until(lambda: game.shows("Q: Robot"))
        assert any(line.values == ("Q",) for line in view(game).lines)


async def test_of_a_predicate_that_is_inspected(data_dir: Path) -> None:
    text = f"Near(robot_name:) :- Sensor(robot_name:, sensor:), sensor.clock > 5;\n{AHEAD}"
    async with opened(data_dir, text=text) as game:
        await game.ready()
        game.inspector.inspect("Near")
        await game.press("w")
        await game.until(lambda: "sensor.clock > 5" in told(game))


async def test_a_function_without_arguments_says_so_in_place(data_dir: Path) -> None:
    async with opened(data_dir, text=TWO_RULES) as game:
        await game.ready()
        game.inspector.inspect("Speed")
        await game.press("w")
        await game.until(lambda: game.shows("Speed is a function of col0: give a value for it."))


async def test_without_a_program_it_says_so(data_dir: Path) -> None:
    async with opened(data_dir, text="Robot(") as game:
        await game.ready()
        await game.press("w")
        await game.until(lambda: game.shows("There is no program yet that could be asked."))
