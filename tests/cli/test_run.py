"""``run`` and ``trace``: won or not, bonus goals, in words, as JSON, and tick by tick."""

import json
import signal
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.cli.run import play_out
from logical_robots_tui.mind import Program
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import load_level
from tests.cli.running import Ask, Command, in_terminal, shown
from tests.game.playing import HALL
from tests.lab.laboratory import write_files
from tests.short import AHEAD, LEVEL


def test_a_level_that_is_won_ends_with_status_0_and_is_told_of(short: Ask, ahead: Path) -> None:
    told = short("run", "--json")
    assert (told.status, told.err) == (0, "")
    data = told.data
    assert data["won"] is True
    assert 0 < data["ticks"] < 100
    assert (data["level"], data["program"]) == ("short", str(ahead))
    (pip,) = data["robots"]
    assert (pip["name"], pip["memory"], pip["battery_level"]) == ("Pip", "on my way", None)
    assert abs(pip["x"] - 42) < 6
    assert data["goals"] == [{"area": "Door", "wanted": ["Pip"], "inside": ["Pip"]}]
    assert data["notices"] == {"count": 0, "kinds": {}, "first": []}
    assert data["reliable"] is True
    assert data["second_goals"] == {}
    assert short("run").data == data, "it is JSON whenever nobody is looking"
    timed = short("run", "--times").data
    assert timed["milliseconds_per_tick"] > timed["think_milliseconds_per_tick"] > 0


@pytest.mark.parametrize("what", ["run", "trace"])
def test_equal_runs_are_equal_bytes(what: str, short: Ask) -> None:
    assert short(what).out == short(what).out


def test_a_level_that_is_not_won_ends_with_status_1_after_the_given_ticks(
    command: Command, level: Path, still: Path
) -> None:
    told = command("run", level, still, "--ticks", 7, "--json")
    assert (told.status, told.data["won"], told.data["ticks"]) == (1, False, 7)
    words = shown("run", level, still, "--ticks", 5, status=1)
    assert "not won within 5 ticks. Door is still missing Pip." in words.text


def test_of_a_run_that_was_nearer_to_its_goal_that_is_told(tmp_path: Path) -> None:
    lone = AHEAD.replace(";", ', robot_name == "Ada";')
    write_files(tmp_path, {"hall.toml": HALL, "lone.l": lone})
    told = shown("run", tmp_path / "hall.toml", tmp_path / "lone.l", "--ticks", 300, status=1)
    assert "missing Ada, Bo. Most at once: 1 of 2, tick 81." in told.text


def test_notices_are_counted_and_a_memory_that_is_no_json_is_null(short: Ask, ahead: Path) -> None:
    text = ahead.read_text()
    ahead.write_text(text.replace('"on my way"', "1e308 * 10"))
    assert short("run", "--ticks", 2).data["robots"][0]["memory"] is None
    ahead.write_text(text.replace("name:);", 'name:), robot_name == "Nobody";'))
    notices = short("run", "--ticks", 30).data["notices"]
    assert (notices["count"], notices["kinds"]) == (30, {"no row": 30})
    assert [notice["tick"] for notice in notices["first"]] == list(range(1, 11))


def test_a_saved_program_is_run(command: Command, level: Path, ahead: Path, tmp_path: Path) -> None:
    own = tmp_path / "data" / "programs"
    own.mkdir(parents=True)
    ahead.rename(own / "mine.l")
    assert command("run", level, "mine", "--data-dir", tmp_path / "data").status == 0


def test_a_terminal_shows_the_outcome_in_words_and_not_as_markup(level: Path, ahead: Path) -> None:
    level.write_text(level.read_text().replace("A short way", "[/red] [bold]no[/bold]"))
    told = shown("run", level, ahead)
    for text in ("[/red] [bold]no[/bold]: won at tick", "Pip", "ticks/s"):
        assert text in told.text
    told = shown("run", level, ahead, "--json")
    assert '"won": true' in told.text
    assert "won at tick" not in told.text


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("run", ["--ticks"]),
        pytest.param("query", ["Robot", "--tick"], marks=pytest.mark.slow),
        pytest.param("when", ["Robot", "--ticks"], marks=pytest.mark.slow),
    ],
)
def test_a_bar_shows_progress_until_control_c_ends_the_run(
    name: str, words: list[str], level: Path, still: Path
) -> None:
    with in_terminal(name, level, still, *words, 10**9) as terminal:
        terminal.wait_for("ticks/s")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.finish() == 130
    assert "of 1000000000" in terminal.everything
    assert "of 1000000000" not in terminal.text
    assert "Traceback" not in terminal.everything


SIZE, DISTANCE = 11, 24.5
GOALS = ("at most 9 ticks", "never blocked", "wins from all 20 starts")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    text = f"second_goals = {list(GOALS)}\n{LEVEL}"
    return write_files(tmp_path, {"goals.toml": text}) / "goals.toml"


def test_a_run_says_which_are_reached(command: Command, file: Path, ahead: Path) -> None:
    found = command("run", file, ahead).data
    assert (found["size"], found["distance"]) == (SIZE, DISTANCE)
    assert found["second_goals"] == dict(zip(GOALS, (False, True, None), strict=True))


async def test_a_run_says_so_in_words(file: Path) -> None:
    outcome = await play_out(load_level(file), Program.compile(AHEAD), "ahead", 500)
    told = outcome.as_text()
    goals = "at most 9 ticks: no; never blocked: yes; wins from all 20 starts: not tried"
    drove = f"The program has {SIZE} symbols; the robots drove {DISTANCE:.0f} units."
    assert f"\n{drove}\nBonus goals: {goals}.\n" in told


def test_the_game_in_lines_names_and_keeps_them(
    command: Command, file: Path, ahead: Path, tmp_path: Path
) -> None:
    words = (file, ahead, "--plain", "--data-dir", tmp_path / "data")
    told = command("play", *words, typed=("run",)).out
    assert "Bonus goal: never blocked.\n" in told
    assert "Bonus goal reached: never blocked.\n" in told
    assert "reached: at most 9 ticks" not in told
    progress = Progress(tmp_path / "data" / FILE_NAME)
    assert progress.record(str(file)).bests.goals == ("never blocked",)
    progress.close()


@pytest.mark.parametrize("ticks", [2, 5])
@pytest.mark.usefixtures("late")
def test_a_run_in_which_a_clock_ended_a_thought_is_marked(
    ticks: int, command: Command, level: Path, ahead: Path
) -> None:
    for name, words in (("run", ()), ("when", ("Robot",)), ("diagnose", ())):
        told = command(name, level, ahead, *words, "--ticks", ticks, "--json")
        assert told.data["reliable"] is (ticks < 3), name
    told = command("trace", level, ahead, "--ticks", ticks)
    assert ('"reliable": false' in told.out) is (ticks >= 3)


NEAR = """
Near(robot_name:, d: sensor.forward_distance) :- Sensor(robot_name:, sensor:), sensor.clock > 1;
"""


def lines(told: str) -> list[Any]:
    return [json.loads(line) for line in told.splitlines()]


def test_every_tick_is_told_until_the_end(
    short: Ask, command: Command, level: Path, still: Path
) -> None:
    told = short("trace")
    found = lines(told.out)
    assert (told.status, told.err) == (0, "")
    assert [line["tick"] for line in found] == list(range(1, len(found) + 1))
    assert [line["won"] for line in found] == [False] * (len(found) - 1) + [True]
    last = found[-1]
    (pip,) = last["robots"]
    assert (pip["name"], pip["right_engine"]) == ("Pip", 0.5)
    assert len(last["sensors"]["Pip"]["radar"]) == 31
    assert last["memories"] == {"Pip": "on my way"}
    (decision,) = last["decisions"]
    assert decision["desire"] == {"left_engine": 0.5, "right_engine": 0.5}
    assert last["areas"] == [{"name": "Door", "active": True, "visitors": ["Pip"]}]
    told = command("trace", level, still, "--ticks", 3)
    assert (told.status, len(lines(told.out))) == (1, 3)


def test_the_rows_of_predicates_are_told(short: Ask, ahead: Path) -> None:
    ahead.write_text(ahead.read_text() + NEAR)
    first, second = lines(short("trace", "--ticks", 2, "--predicates", "Near, Robot").out)
    assert first["predicates"]["Near"]["rows"] == []
    near = second["predicates"]["Near"]
    assert near["columns"] == ["robot_name", "d"]
    assert near["rows"] == [["Pip", second["sensors"]["Pip"]["forward_distance"]]]
    assert near["minds"] == ["Pip"]
    assert set(second["predicates"]) == {"Near", "Robot"}


def test_one_robot_only(command: Command, ahead: Path) -> None:
    _, second, *_ = [robot.name for robot in load_level("04-everybody-home").robots]
    told = command("trace", "04-everybody-home", ahead, "--ticks", 1, "--robot", second)
    (line,) = lines(told.out)
    assert [robot["name"] for robot in line["robots"]] == [second]
    assert [decision["robot"] for decision in line["decisions"]] == [second]
    assert list(line["sensors"]) == list(line["memories"]) == [second]


def test_unknown_names_are_refused_before_the_run(short: Ask) -> None:
    for option, name in (("--robot", "Pop"), ("--predicates", "Robbot")):
        told = short("trace", option, name).refusal
        assert f"no {option[2:].removesuffix('s')} {name}" in told
        assert "There is" in told or "There are" in told
