"""A lesson in lines, and its questions, which are answered with queries."""

from pathlib import Path

import pytest

from logical_robots_tui.progress import FILE_NAME, Progress
from tests.cli.running import Ask, Command, in_terminal
from tests.short import QUESTIONS

LESSON = f'starter = "obstacle-avoider"\nlesson = "A rule with one case."\n{QUESTIONS}'
WRONG = "Sensor(robot_name:, sensor: s"
RIGHT = "Way(sensor.forward_distance) :- Sensor(sensor:)"


@pytest.fixture
def lesson(level: Path) -> Path:
    level.write_text(LESSON + level.read_text("utf-8"), "utf-8")
    return level


@pytest.fixture
def typed(command: Command, lesson: Path) -> Ask:
    return lambda *lines, options=(): command("learn", lesson, *options, typed=lines)


def test_the_lesson_is_printed_and_its_questions_are_asked(typed: Ask) -> None:
    told = typed("Here(1);", "Sensor(robot_name:)", "").success
    assert told.startswith("A short way\n\nA rule with one case.\n")
    assert "Question 1 of 2: Who is there?\nAt ticks 0 and 2 of obstacle-avoider, " in told
    assert "A query may use Sensor, Memory, FreedomMotion, Robot." in told
    assert 'robot_name\n"Pip"\nRight at ticks 0 and 2; these rows are from tick 2.\n' in told
    assert "1 of 2 answered." in told


def test_answers_are_kept_and_questions_marked(typed: Ask, lesson: Path, tmp_path: Path) -> None:
    mine = ("--data-dir", tmp_path)
    told = typed("", WRONG, "Way(200);", RIGHT, options=mine).out
    assert f"> {WRONG}\n      ^\n" in told
    assert "col0\n200\nAt tick 0 your only row is wrong; 1 row is expected.\n" in told
    assert "Right at ticks 0 and 5; these rows are from tick 5.\n\n1 of 2 answered.\n" in told
    again = typed("", options=(*mine, "--question", "2"))
    assert "Question 2 of 2, answered: How far?" in again.out
    progress = Progress(tmp_path / FILE_NAME)
    assert progress.record(str(lesson)).answers == (("How far?", RIGHT),)
    progress.close()


@pytest.mark.parametrize(
    ("query", "status", "said"),
    [
        (RIGHT, 0, "Right at ticks 0 and 5; these rows are from tick 5."),
        ("sensor.forward_distance", 0, "Right at ticks 0 and 5; these rows are from tick 5."),
        ("Way(43);", 1, "Right at tick 0, but at tick 5 your only row is wrong; 1 row is expected"),
        ("Robot", 1, "At tick 0 its rows have 2 columns instead of 1."),
        (RIGHT + ", 1 > 2", 1, "At tick 0 it gives no rows; 1 row is expected."),
    ],
)
def test_a_script_gets_a_verdict(typed: Ask, query: str, status: int, said: str) -> None:
    told = typed(options=("--question", "2", "--answer", query))
    assert (told.status, told.err) == (status, "")
    assert told.out.splitlines()[-1].startswith(said)
    data = typed(options=("--question", "2", "--answer", query, "--json")).data
    assert data["right"] == (status == 0)
    assert data["verdict"].startswith(said)


def test_only_a_few_rows_of_many_are_printed_and_lesson_and_questions_as_json(typed: Ask) -> None:
    query = "Ray(ray.angle) :- Sensor(sensor:), ray in sensor.radar"
    lines = typed(options=("--question", "2", "--answer", query)).out.splitlines()
    assert len(lines) == 15
    assert lines[-2:] == ["...", "At tick 0 all its 31 rows are wrong; 1 row is expected."]
    data = typed(options=("--json",)).data
    assert data["lesson"] == "A rule with one case."
    question = {"ask": "How far?", "ticks": [0, 5], "program": "obstacle-avoider"}
    assert data["questions"][1] == {**question, "answered_by": None}


def test_mistakes_in_what_is_typed_are_told(typed: Ask, command: Command) -> None:
    told = typed(options=("--question", "1", "--answer", WRONG))
    assert (told.status, told.out) == (2, "")
    assert told.err.startswith(f"{WRONG}\n      ^\n")
    told = typed(options=("--question", "1", "--answer", WRONG, "--json"))
    assert (told.status, told.data["error"]["kind"]) == (2, "program")
    assert "There is no question 3" in typed(options=("--question", "3")).err
    assert "Add --question N." in typed(options=("--answer", "Robot")).err
    assert 'no level called "99"' in command("learn", "99").err


def test_a_player_in_a_terminal_reads_and_answers(command: Command, level: Path) -> None:
    assert command("learn", level).out == "A short way\n\nThis level has no lesson.\n"
    ask = f"Who is {'narrow ' * 30}indeed?"
    asked = f'{{ask = "{ask}", answer = "{RIGHT}", ticks = [0]}}'
    text = f'starter = "obstacle-avoider"\nlesson = """\n{ask}\n"""\nquestions = [{asked}]\n'
    level.write_text(text + level.read_text("utf-8"), "utf-8")
    with in_terminal("learn", level) as shown:
        shown.wait_for("\n>")
        assert shown.text.split().count("narrow") == 60
        shown.send(f"{RIGHT}\r")
        shown.wait_for("1 of 1 answered.")
