"""The questions of a lesson, answered in the game."""

from pathlib import Path

import pytest

from logical_robots_tui.paths import write_atomically
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.tui.inspector.pages.ask import QueryLine
from logical_robots_tui.tui.inspector.table import ValueTable
from tests.short import QUESTIONS
from tests.tui.conftest import SHORT, Opened, Size, at_both_sizes, opened


@pytest.fixture
def asking(short: Path) -> Path:
    short.write_text(QUESTIONS + SHORT, "utf-8")
    return short


async def answer(game: Opened, query: str, *told: str) -> None:
    game.app.screen.query_one(QueryLine).value = query
    await game.press("enter")
    await game.sees(*told)


async def begin(game: Opened) -> None:
    await game.press("t", sees="enter questions (0 of 2)")
    await game.press("enter", sees="1 of 2  Who is there?")


@at_both_sizes
async def test_a_lesson_leads_to_questions(data_dir: Path, asking: Path, size: Size) -> None:
    async with opened(data_dir, level=asking, size=size, ready=True) as game:
        await begin(game)
        await game.sees("Questions · A short way · 0 of 2 answered", "FreedomMotion, Robot.")
        query = f"Here(robot_name:) :- Sensor(robot_name:), {'1 < 2, ' * 10}Sensr(x:)"
        await answer(game, query, "you mean Sensor?")
        lines = game.screen().splitlines()
        (place,) = (n for n, line in enumerate(lines) if "^^^^^" in line)
        assert lines[place - 1].index("Sensr") == lines[place].index("^^^^^")
        await answer(game, 'Here(n: "A");', "At tick 0 your only row is wrong; 1 row is expected")
        assert game.app.screen.query_one(ValueTable).all.rows == (("A",),)
        await answer(game, "Sensor(robot_name:", "      ^", "is never closed")
        await answer(
            game,
            "Sensor(robot_name:)",
            "Right at ticks 0 and 2; these rows are from tick 2.",
            "1 of 2 answered",
        )
        await game.sees("1 of 2 ✓  Who is there?")
        await game.press("enter", sees="2 of 2  How far?")
        await answer(game, "Way(43);", "Right at tick 0, but at tick 5 your only row is wrong")
        await game.press("tab", sees="1 of 2 ✓  Who is there?")
        assert game.app.screen.query_one(QueryLine).value == "Sensor(robot_name:)"
        await game.press("shift+tab", "escape", until=lambda: game.app.screen is game.main)
        assert game.tick == 0, "the game at hand is left alone"
    progress = Progress(data_dir / FILE_NAME)
    assert progress.record(str(asking)).answers == (("Who is there?", "Sensor(robot_name:)"),)
    progress.close()


async def test_answers_outlive_sessions_and_rows_are_scrolled(data_dir: Path, asking: Path) -> None:
    progress = Progress(data_dir / FILE_NAME)
    progress.answer(str(asking), "Who is there?", "Sensor(robot_name:)")
    progress.answer(str(asking), "What was asked before?", "Robot")
    progress.close()
    async with opened(data_dir, level=asking, size=(80, 24), ready=True) as game:
        recorder: ProgressRecorder = game.main.recorder
        await game.until(lambda: recorder.record.answers)
        await game.command("questions", sees=("1 of 2 answered", "2 of 2  How far?"))
        rays = "Ray(ray.angle) :- Sensor(sensor:), ray in sensor.radar"
        await answer(game, rays, "all its 31 rows are wrong")
        table = game.app.screen.query_one(ValueTable)
        await game.press("pagedown", "pagedown", until=lambda: table.scroll_offset.y)
        await game.press("pageup", "pageup", until=lambda: not table.scroll_offset.y)
        assert isinstance(game.app.focused, QueryLine)


async def test_a_program_that_is_missing_is_named(data_dir: Path, short: Path) -> None:
    about_nothing = QUESTIONS.replace("ticks = ", 'program = "nowhere", ticks = ')
    write_atomically(short, about_nothing + SHORT)
    async with opened(data_dir, level=short, ready=True) as game:
        await begin(game)
        await game.sees("nowhere: There is no such program")
        await answer(game, "Robot", "nowhere: There is no such program")
