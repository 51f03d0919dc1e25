"""One run: its result depends on nothing but what is run, and ends where nothing can change."""

from typing import Any

import msgspec
import pytest

from logical_robots_tui.game.measuring import play_through, start_of
from logical_robots_tui.lab.running import _reason, execute
from logical_robots_tui.lab.tasks import QueryMeasure, Result, RunTask, WorkerAnswer, fingerprint
from logical_robots_tui.mind import Program, Stopped
from logical_robots_tui.paths import shipped_folder
from logical_robots_tui.world import load_level
from logical_robots_tui.world.levels.load import read_level
from tests.lab.laboratory import FIRST_STEPS, SENSOR, STANDING, STILL, lane, program_text


def task(program: str, **changes: Any) -> RunTask:
    plain = RunTask(lane("A lane"), {"": program}, 300, (0,), (), 10**8, 60.0, False, fingerprint())
    return msgspec.structs.replace(plain, **changes)


def only(answer: WorkerAnswer) -> Result:
    ((_, result, _),) = answer.results
    return msgspec.json.decode(result, type=Result)


def test_a_run_is_the_game_played_through() -> None:
    answer = execute(task(FIRST_STEPS, starts=(0, 2)))
    level, program = read_level(lane("A lane"), "level"), Program.compile(FIRST_STEPS)
    for start, text, _ in answer.results:
        played = play_through(start_of(level, start), program, 300)
        result = msgspec.json.decode(text, type=Result)
        assert (result.outcome, result.ticks) == ("won", played.won_at)
        assert (result.distance, result.size) == (played.distance, 38)
    assert [start for start, _, _ in answer.results] == [0, 2]


def test_a_run_ends_where_nothing_can_change_any_more() -> None:
    result = only(execute(task(STANDING)))
    assert (result.outcome, result.ticks) == ("nothing changes", 2)
    assert only(execute(task(STILL.format("0.5", '""', SENSOR)))).outcome == "out of ticks"
    noisy = lane("A lane").replace("cell", "sensors = {noise = 1}\ncell", 1)
    assert only(execute(task(STANDING, level=noisy))).outcome == "out of ticks"
    timed = lane("A lane") + "cycle = {period = 9, first = 1, last = 3}\n"
    assert only(execute(task(STANDING, level=timed))).outcome == "out of ticks"


@pytest.mark.parametrize(
    "program",
    [
        STILL.format("0", "sensor.clock", SENSOR),
        STILL.format("if sensor.clock > 250 then 1 else 0", '""', SENSOR),
        f"Seen(robot_name:, sensor:) :- {SENSOR};"
        + STILL.format("if s.clock > 250 then 1 else 0", '""', "Seen(robot_name:, sensor: s)"),
    ],
)
def test_a_program_that_reads_the_clock_is_run_to_the_end(program: str) -> None:
    result = only(execute(task(program)))
    assert (result.outcome, result.ticks) == ("out of ticks", 300)


def test_stopping_early_says_nothing_else_than_the_whole_run() -> None:
    text = program_text("open-space-starter")
    level = (shipped_folder("levels") / "01-first-steps.toml").read_text("utf-8")
    early = only(execute(task(text, ticks=900, level=level)))
    assert early.outcome == "nothing changes"
    played, program = load_level("01-first-steps"), Program.compile(text)
    at_end, later = (play_through(played, program, ticks) for ticks in (early.ticks, 900))
    assert later.won_at is None
    # From there on the world is what it was.
    assert later.distance == at_end.distance


ROBOT = '[[robots]]\nname = "{}"\nx = {}\ny = 50\nheading = {}\n'
HOME = lane("Three").replace('["Ada"]', '["Ada", "Ben", "Cem"]').replace("x = 30", "x = 40")
HOME += ROBOT.format("Ben", 90, 0) + ROBOT.format("Cem", 140, 180)
CLOSED = HOME.replace("goal_for", 'on_beacon = "Lamp"\ngoal_for').replace("180", "0")
CLOSED += '[[beacons]]\nname = "Lamp"\nx = 22\ny = 50\n'  # behind everybody
TWO_GOALS = "all_goals = true\n" + HOME.replace('"Ben", "Cem"]', '"Ben"]')
TWO_GOALS += '[[areas]]\nname = "Start"\nx = 140\ny = 50\nradius = 20\ngoal_for = ["Cem"]\n'


@pytest.mark.parametrize(
    ("level", "drivers", "home", "is_brief"),
    [
        (HOME, "", 0, False),  # Ben began in the goal
        (HOME, '"Ada"', 1 / 2, True),
        (HOME, '"Ben"', 0, False),
        (HOME, '"Ada", "Ben"', 0, False),  # one came, but the other left
        (HOME, '"Ada", "Cem"', 1, False),
        (CLOSED, '"Ada"', 0, False),
        (TWO_GOALS, "", 0, False),
        (TWO_GOALS, '"Cem"', 0, False),
        (TWO_GOALS, '"Ada"', 1, False),
        (HOME.replace("goal_for", "# "), '"Ada"', 0, False),
    ],
)
def test_progress_is_measured_beyond_those_who_began_in_the_goal(
    level: str, drivers: str, home: float, is_brief: bool
) -> None:
    program = f"""
        Robot(robot_name:, desire: {{left_engine: power, right_engine: power}}, memory: "") :-
          Sensor(robot_name:), power == (if robot_name in ["", {drivers}] then 1 else 0);
    """.replace(", ]", "]")
    result = only(execute(task(program, level=level)))
    assert (result.outcome == "won") == (home == 1)
    assert result.home == pytest.approx(home)
    assert result.time_home is not None
    share = (1 - result.ticks / 300) if home == 1 else 0.1 if is_brief else 0
    assert result.time_home == pytest.approx(share, abs=0.1 * bool(home))


def test_a_program_with_too_many_steps_in_each_tick_is_ended() -> None:
    text = "N(x) :- x in Range(2000);\n" + STILL.format(
        "Sum{x * y :- N(x), N(y)} + sensor.clock", '""', SENSOR
    )
    result = only(execute(task(text, steps=100_000)))
    assert (result.outcome, result.ticks) == ("too many steps", 10)
    assert result.notices == {"failed": 10}
    assert result.first is not None
    assert "thinking took more than 100,000 steps" in result.first[2]


def test_a_program_that_does_not_compile_says_where() -> None:
    result = only(execute(task("Robot(robot_name:) :-\n Snesor(robot_name:);")))
    assert result.outcome == "does not compile"
    assert [mistake.line for mistake in result.mistakes][-1] == 2


def test_questions_are_asked_every_so_many_ticks_or_at_the_end() -> None:
    measures = (QueryMeasure("often", "Robot(robot_name:)", 100), QueryMeasure("last", "1 + 1", 0))
    result = only(execute(task(STANDING, measures=measures)))
    assert result.series["often"].columns == ("tick", "robot", "robot_name")
    assert result.series["often"].rows == tuple((tick, "Ada", "Ada") for tick in (1, 100, 200, 300))
    assert [row[0] for row in result.series["last"].rows] == [300]


def test_an_answer_is_one_number_of_each_tick_that_is_asked() -> None:
    measures = (
        QueryMeasure("rows", "Robot(robot_name:)", 7),
        QueryMeasure("value", "Max{sensor.clock :- Sensor(sensor:)}", 7),
        QueryMeasure("truth", "Sensor(sensor:), sensor.clock > 10", 7),
        QueryMeasure("text", '"a"', 7),
        QueryMeasure("fails", "Sum{1 / 0}", 7),
    )
    result = only(execute(task(STANDING, measures=measures, ticks=24)))
    numbers = {name: dict(series.numbers) for name, series in result.series.items()}
    ticks = [1, 7, 14, 21, 24]
    assert (numbers["rows"], list(numbers["value"])) == (dict.fromkeys(ticks, 1), ticks)
    values = list(numbers["value"].values())
    assert sorted(values, key=lambda value: value or 0) == values
    assert numbers["truth"] == {tick: int((numbers["value"][tick] or 0) > 10) for tick in ticks}
    assert numbers["text"] == dict.fromkeys(ticks)

    # The last tick is asked once.
    often = (QueryMeasure("often", "1", 10),)
    result = only(execute(task(STANDING, measures=often, ticks=20)))
    assert result.series["often"].numbers == ((1, 1), (10, 1), (20, 1))
    result = only(execute(task(FIRST_STEPS, measures=often)))
    assert result.series["often"].numbers[-1] == (result.ticks, 1)


def test_a_run_stops_when_its_question_holds() -> None:
    until = "Sensor(sensor:), sensor.clock >= 50"
    measures = (QueryMeasure("last", "Max{sensor.clock :- Sensor(sensor:)}", 0),)
    result = only(execute(task(STANDING, measures=measures, until=until)))
    assert result.outcome == "stopped"
    assert [number for _, number in result.series["last"].numbers] == [50]
    assert [tick for tick, _ in result.series["last"].numbers] == [result.ticks]
    assert only(execute(task(FIRST_STEPS, until="1 == 2"))) == only(execute(task(FIRST_STEPS)))


def test_varied_starts_are_for_programs_that_win_and_tasks_for_the_same_engine() -> None:
    assert execute(task(FIRST_STEPS, fingerprint="another")).is_refused
    lost = execute(task(FIRST_STEPS, ticks=50, starts=(0, 1, 2), given_first=True))
    assert [start for start, _, _ in lost.results] == [0]


def test_a_run_that_takes_too_long_is_not_a_result() -> None:
    answer = execute(task(FIRST_STEPS, ticks=20_000, seconds=0.01))
    assert (answer.results, answer.failure) == ((), "it took more than 0.01 seconds")
    assert _reason(Stopped(), task(FIRST_STEPS, seconds=1.0)) == "it took more than 1 second"


def test_a_run_that_is_explained_is_the_same_run_and_always_explained_alike() -> None:
    turning = STILL.format("0.5", '""', SENSOR)
    plain, *explained = (
        only(execute(task(turning, is_explained=is_on))) for is_on in (False, True, True)
    )
    assert explained[0] == explained[1]
    paths, findings = explained[0].paths, explained[0].findings
    assert plain == msgspec.structs.replace(explained[0], paths={}, findings=())
    assert [finding.kind for finding in findings] == ["unfinished"]
    assert 100 < len(paths["Ada"]) <= 201
    end = plain.ends[0]
    assert paths["Ada"][-1] == (round(end.x), round(end.y))
    won = only(execute(task(FIRST_STEPS, is_explained=True)))
    assert (won.outcome, won.paths, won.findings) == ("won", {}, ())
