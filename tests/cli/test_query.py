"""``query`` and ``when``: any question about one tick, or the ticks in which something holds."""

from pathlib import Path

import pytest

from logical_robots_tui.mind import Mind
from tests.cli.running import Ask, Command, shown


def test_a_question_is_answered_for_its_tick(short: Ask, level: Path, ahead: Path) -> None:
    told = short("query", "--tick", 7, "Sensor(robot_name:, sensor:), clock == sensor.clock")
    assert (told.status, told.data["tick"], told.data["minds"]) == (0, 7, ["Pip"])
    clock = told.data["columns"].index("clock")
    assert [row[clock] for row in told.data["rows"]] == [7]
    table = shown("query", level, ahead, "--tick", 1, "Robot(robot_name:, desire:)")
    assert "IN THE MIND OF  robot_name  desire" in table.text
    assert '"Pip"' in table.text


@pytest.mark.parametrize(
    ("tick", "query", "rows"),
    [
        (0, "Memory", [["Pip", ""]]),  # the start
        (150, "c == AnyValue{sensor.clock :- Sensor(sensor:)}", [[150]]),  # after victory
        (1, "Sensor(robot_name:), robot_name == 3", []),
    ],
)
def test_no_rows_is_status_1(tick: int, query: str, rows: list[object], short: Ask) -> None:
    told = short("query", "--tick", tick, query)
    assert (told.status, told.data["rows"]) == (int(not rows), rows)


def test_a_wrong_question_is_told_with_its_place_and_a_failing_one_with_why(short: Ask) -> None:
    refusal = short("query", "--tick", 10**9, "Sensor(robot_nam:)").refusal  # before the run
    assert "query:1:8: Sensor has no column robot_nam" in refusal
    assert "Did you mean robot_name?" in refusal
    failure = short("query", "--tick", 1, 'x in ["a"], x.field == 2').refusal
    assert "neither a record nor a list" in failure


CLOCK = "Sensor(sensor:), clock == sensor.clock, "


@pytest.fixture
def counter(tmp_path: Path) -> Path:
    path = tmp_path / "counter.l"
    path.write_text(
        'Third(robot_name:, n:) :- Memory(robot_name:, memory: n), n != "", Mod(n, 3) == 0;\n'
        'Held() = Max{m :- Memory(memory: m), m != ""};\n'
        "Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory:) :-\n"
        "  Sensor(robot_name:, sensor:), memory == sensor.clock;\n"
    )
    return path


@pytest.fixture
def when(command: Command, level: Path, counter: Path) -> Ask:
    return lambda *words: command("when", level, counter, *words)


def test_the_stretches_have_rows(when: Ask, command: Command, level: Path, counter: Path) -> None:
    told = when(f"{CLOCK}clock in [3, 4, 5, 9, 11, 12]")
    data = told.data
    assert (told.status, data["first"], data["last"], data["holds_in"]) == (0, 3, 12, 6)
    assert (data["stretches"], data["failed_in"]) == ([[3, 5], [9, 9], [11, 12]], [])
    stretches = when("Third", "--ticks", 7).data["stretches"]
    asked = ("query", level, counter, "Third", "--tick")
    rows = [bool(command(*asked, tick).data["rows"]) for tick in range(8)]
    assert [any(a <= tick <= b for a, b in stretches) for tick in range(8)] == rows
    assert any(rows)


def test_a_run_is_won_or_over(command: Command, level: Path, ahead: Path, still: Path) -> None:
    won = command("when", level, ahead, "Robot").data
    assert won["won_at"] == won["ticks"] == won["last"]
    data = command("when", level, still, "Robot", "--ticks", 40).data
    assert (data["ticks"], data["won_at"], data["stretches"]) == (40, None, [[1, 40]])
    told = command("when", level, still, "Memory(memory: 7)", "--ticks", 9)
    assert (told.status, told.data["first"], told.data["stretches"]) == (1, None, [])


@pytest.mark.parametrize(
    ("question", "stretches"),
    [
        ("Held() > 5", [[7, 12]]),
        ("Held() - 5", [[2, 5], [7, 12]]),
        ("1 == 2", []),
        ("~Third(n: 3)", [[1, 3], [5, 12]]),
        ("if Held() > 10 then 1 else null", [[12, 12]]),
    ],
)
def test_a_question_holds_if_true(when: Ask, question: str, stretches: list[list[int]]) -> None:
    assert when(question, "--ticks", 12).data["stretches"] == stretches


def test_a_robot_s_mind_can_be_chosen(command: Command, tmp_path: Path) -> None:
    program = tmp_path / "late.l"
    program.write_text(
        'Late(n) :- Memory(robot_name:, memory: n), n != "",\n'
        '  n >= (if robot_name == "Jade" then 6 else 3);\n'
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory:) :-\n"
        "  Sensor(robot_name:, sensor:), memory == sensor.clock;\n"
    )
    run = ["when", "04-everybody-home", program, "Late", "--ticks", 9]
    assert command(*run).data["first"] == 4
    assert command(*run, "--robot", "Jade").data["first"] == 7
    refusal = command(*run, "--robot", "Eve").refusal.replace("\n", " ")
    assert "There is no robot Eve. There are Ruby, Jade, Lapis." in refusal


def test_a_wrong_query_is_told_and_a_second_one_thinks_nothing(
    when: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = when("Third").data
    monkeypatch.setattr(Mind, "think", None)
    assert when("Third").data == first
    assert "query:1:8: Sensor has no column robot_nam" in when("Sensor(robot_nam:)").refusal


def test_the_ticks_in_which_it_fails_are_told(when: Ask) -> None:
    told = when(f'{CLOCK}x in ["a"], (if clock in [2, 3] then x.field else 1) == 1', "--ticks", 5)
    data = told.data
    assert (told.status, data["stretches"], data["failed_in"]) == (0, [[1, 1], [4, 5]], [[2, 3]])
    assert "neither a record nor a list" in data["failure"]
    assert "It failed in every tick: This failed" in when('x in ["a"], x.field == 2').refusal


def test_in_a_terminal_it_is_told_in_words(level: Path, counter: Path) -> None:
    told = shown("when", level, counter, f"{CLOCK}clock in [3, 4, 5, 9]", "--ticks", 20)
    assert "holds in 4 of 20 ticks: first in tick 3, last in tick 9." in told.text
    assert "FROM  TO  TICKS" in told.text
    told = shown("when", level, counter, "1 == 2", "--ticks", 20, status=1)
    assert "1 == 2 never holds in 20 ticks." in told.text
