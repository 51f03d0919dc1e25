"""A level and a program in step, as scripts use them."""

import sys
from pathlib import Path

import pytest

from logical_robots_tui import (
    Desire,
    InputError,
    Level,
    Mind,
    Program,
    ProgramError,
    Sensors,
    Simulation,
)
from logical_robots_tui.game.measuring import start_of
from logical_robots_tui.game.replay import load_replay
from logical_robots_tui.world import LevelError, load_level
from tests.levels.playing import measured, program_text, ticks_to_win

AHEAD = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: sensor.clock) :-
  Sensor(robot_name:, sensor:);
"""
ARENA = "high-ground"


def test_a_level_is_won_in_the_ticks_of_the_game() -> None:
    with Simulation("01-first-steps", "first-steps") as sim:
        assert sim.run().tick == sim.won_at == measured("01-first-steps").ticks
        assert sim.won
        assert sim.over


def test_robots_see_what_their_level_lets_them_see_from_each_start() -> None:
    level = load_level("08-formation")
    count = AHEAD.replace("sensor.clock", "Count{other :- Memory(robot_name: other)}")
    sim = Simulation("formation", count, start=3)
    assert sim.level.robots == start_of(level, 3).robots != level.robots
    sim.step()
    assert level.visibility.memory == "seen"
    assert [*sim.memories.values()] == [1, 3, 1, 2, 2]


@pytest.mark.slow
def test_formation_sees_what_its_level_lets_it_see() -> None:
    level = load_level("08-formation")
    assert level.visibility.memory != "own"
    sim = Simulation("formation", "formation", start=3)
    program = Program.compile(program_text("formation"))
    assert sim.run().tick == ticks_to_win(start_of(level, 3), program, 20_000)


@pytest.mark.parametrize("form", ["path", "text", "level"])
def test_a_level_is_a_path_a_text_or_a_level(form: str) -> None:
    given = load_level("01-first-steps")
    path = Path(given.source)
    forms: dict[str, Level | str | Path] = {
        "path": path,
        "text": path.read_text("utf-8"),
        "level": given,
    }
    assert Simulation(forms[form], AHEAD).level.robots == given.robots


@pytest.mark.parametrize("form", ["path", "text", "program"])
def test_a_program_is_a_path_a_text_or_a_program(form: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.l"
    path.write_text(AHEAD)
    forms: dict[str, Program | str | Path] = {
        "path": path,
        "text": AHEAD,
        "program": Program.compile(AHEAD),
    }
    sim = Simulation("01-first-steps", forms[form])
    sim.step()
    assert sim.memories == {"Ada": 1}


def test_without_a_program_it_is_the_starter() -> None:
    level = load_level("02-open-space")
    assert Simulation(level).program.text == program_text(level.starter)


def test_each_team_has_its_program_and_points() -> None:
    level = load_level(ARENA)
    first, second, *_ = [team.name for team in level.teams]
    sim = Simulation(level, {first: AHEAD})
    assert sim.program.for_team(first).text == AHEAD
    assert sim.program.for_team(second).text != AHEAD
    sim.run(20)
    assert set(sim.points) == {team.name for team in level.teams}
    assert sim.why(next(each for each in level.robots if each.team == second).name).rows == 1


@pytest.mark.parametrize(
    ("level", "program", "error", "words"),
    [
        ("01-first-step", None, LevelError, "no level called"),
        ("01-first-steps", "first-stepps", InputError, "no such program"),
        ("01-first-steps", {"red": AHEAD}, InputError, "no team 'red'"),
        ("01-first-steps", "Robot(", InputError, "no such program"),
        ("01-first-steps", "Robot(;", ProgramError, "line 1"),
    ],
)
def test_what_is_not_there_or_wrong_is_refused(
    level: str, program: str | dict[str, str | Path] | None, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        Simulation(level, program)


def test_a_run_ends_where_a_question_or_a_function_holds() -> None:
    near = "Sensor(sensor:), sensor.forward_distance < 100"
    one, other = Simulation("01-first-steps", AHEAD), Simulation("01-first-steps", AHEAD)
    one.run(until=near)
    assert 0 < one.tick < 1000
    assert one.query(near).rows
    other.run(until=lambda sim: bool(sim.query(near).rows))
    assert other.frame == one.frame
    assert one.run(7).tick == other.tick + 7
    with pytest.raises(ProgramError):
        one.run(until="Sensor(")


def test_robots_that_are_driven_by_hand_do_not_follow_the_program() -> None:
    sim = Simulation("01-first-steps", AHEAD)
    sim.step({"Ada": (0, 0.5)})
    assert (sim.robots["Ada"].left_engine, sim.robots["Ada"].right_engine) == (0, 0.5)
    sim.step({"Ada": Desire(0.25, 0)})
    assert sim.robots["Ada"].left_engine == 0.25
    sim.step()
    assert sim.robots["Ada"].left_engine == 1
    for wrong in (3, "ab", (1, 2, 3), {"left_engine": 1}):
        with pytest.raises(ValueError, match="pair of engine powers"):
            sim.step({"Ada": wrong})  # type: ignore[dict-item] # on purpose
    with pytest.raises(ValueError, match="no robot 'Adda'"):
        sim.step({"Adda": (1, 1)})
    assert sim.tick == 3


def test_an_experiment_branches_and_can_return() -> None:
    sim = Simulation("01-first-steps", AHEAD)
    sim.run(20)
    saved = sim.save()
    sim.run(10)
    later = sim.save()
    sim.restore(saved)
    for _ in range(10):
        sim.step({"Ada": (-1, -1)})
    assert sim.frame != later
    assert sim.at(20) == saved
    sim.restore(saved)
    sim.run(10)
    assert sim.frame == later
    other = Simulation("01-first-steps", AHEAD)
    other.restore(saved)
    other.run(10)
    assert other.frame == later
    with pytest.raises(ValueError, match="another level"):
        Simulation("04-everybody-home").restore(saved)


def test_another_program_goes_on_from_the_present_tick() -> None:
    sim = Simulation("01-first-steps", AHEAD)
    sim.run(5)
    sim.use("first-steps")
    sim.step()
    assert sim.tick == 6
    assert sim.memories != {"Ada": 6}


def test_a_replay_has_all_ticks(tmp_path: Path) -> None:
    sim = Simulation("01-first-steps", AHEAD, sensors=Sensors(rays=7, noise=2))
    with pytest.raises(InputError, match="nothing to record"):
        sim.record(tmp_path / "empty.replay")
    sim.run(30)
    sim.record(tmp_path / "mine.replay")
    replay = load_replay(tmp_path / "mine.replay")
    assert [*replay.states()][-1] == sim.frame.after
    again = Simulation(replay.levels[0], AHEAD)
    assert again.level.sensors == Sensors(rays=7, noise=2)
    again.run(30)
    assert again.frame == sim.frame
    with pytest.raises(InputError, match="can't be written"):
        sim.record(tmp_path / "nowhere" / "mine.replay")


def test_a_table_without_pandas_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="Install it with: pip install pandas"):
        Simulation("01-first-steps").to_pandas()


def test_the_rows_are_a_table_and_the_paths_a_picture() -> None:
    sim = Simulation("04-everybody-home", "everybody-home")
    sim.run(40)
    table = sim.to_pandas()
    assert len(table) == 41 * len(sim.robots)
    last = table[table["tick"] == 40].set_index("robot")
    assert {name: last.loc[name, "x"] for name in sim.robots} == {
        name: robot.x for name, robot in sim.robots.items()
    }
    assert sim.svg().startswith("<svg")
    assert sim.svg() in sim._repr_html_()


def test_an_explanation_is_printed() -> None:
    sim = Simulation("01-first-steps", AHEAD)
    sim.step()
    told = str(sim.why("Ada"))
    assert told.startswith("+ Robot(")
    assert "sensor.clock = 1" in told
    with pytest.raises(ValueError, match="no robot"):
        sim.why("Bob")


def test_a_mind_is_made_for_a_level_without_teams() -> None:
    level = load_level("08-formation")
    mind = Mind.for_level(Program.compile(program_text("formation")), level)
    assert (mind.memory, mind.sensor) == (level.visibility.memory, level.visibility.sensor)
    with pytest.raises(ValueError, match="Each team"):
        Mind.for_level(Program.compile(AHEAD), load_level(ARENA))
