"""What was played is not played again, as long as nothing has changed that plays a part in it."""

import sys
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from logical_robots_tui import Level, Program
from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.game import run
from logical_robots_tui.game.measuring import play_through, vary_start
from tests import conftest
from tests.levels import verdicts
from tests.levels.playing import load_level, ticks_to_win
from tests.levels.verdicts import Verdict, folder, key_of, verdict
from tests.processes import run_command

AHEAD = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") :- Sensor(robot_name:);
"""


@pytest.fixture
def level() -> Level:
    return load_level("01-first-steps")


@pytest.fixture(scope="module")
def ahead() -> Program:
    return Program.compile(AHEAD)


@pytest.fixture
def played(ahead: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The ticks of patience with which a level was played, with an empty folder of verdicts."""
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "cache"))
    patiences: list[int] = []
    play = verdicts.play

    def noted(level: Level, program: Program, ticks: int) -> Verdict:
        patiences.append(ticks)
        return play(level, program, ticks)

    monkeypatch.setattr(verdicts, "play", noted)
    return patiences


def test_a_verdict_is_kept_and_answers_for_fewer_ticks(
    level: Level, ahead: Program, played: list[int]
) -> None:
    for ticks in (30, 20, 40, 35):
        assert ticks_to_win(level, ahead, ticks) is None
    assert played == [30, 40]
    assert not verdict(level, ahead, 30).repeats
    assert verdict(vary_start(level, 0), ahead, 5).ticks == 5


def test_a_victory_is_none_before_its_tick(level: Level, ahead: Program, played: list[int]) -> None:
    (robot,), (goal,) = level.robots, [area for area in level.areas if area.victory_robots]
    nearby = replace(robot, x=goal.x - goal.radius - 9.5, y=goal.y, angle=0.0)
    near = replace(level, robots=(nearby,))
    assert [ticks_to_win(near, ahead, ticks) for ticks in (50, 10, 9)] == [10, 10, None]
    assert played == [50]


def test_a_robot_that_stands_before_a_wall_does_so_for_ever(
    level: Level, ahead: Program, played: list[int]
) -> None:
    late = 5_000
    stopped = verdict(level, ahead, late)
    assert stopped.repeats
    assert stopped.is_blocked
    assert stopped.ticks < 400
    assert verdict(level, ahead, 2 * late) == stopped
    assert played == [late]
    to_the_end = play_through(level, ahead, stopped.ticks + 50)
    assert (to_the_end.won_at, to_the_end.distance) == (None, stopped.distance)


def test_the_clock_may_change_what_follows_a_state(level: Level, played: list[int]) -> None:
    text = AHEAD.replace("right_engine: 1", "right_engine: if sensor.clock < 350 then 1 else -1")
    program = Program.compile(text.replace("name:);", "name:, sensor:);"))
    assert not verdict(level, program, 340).repeats
    assert played == [340]


@pytest.mark.parametrize(
    "damage",
    [lambda content: content[:-1], lambda content: content.replace(b"[30", b"[31"), lambda _: b""],
    ids=["cut off", "changed", "empty"],
)
def test_a_damaged_verdict_is_played_again(
    level: Level, ahead: Program, played: list[int], damage: Callable[[bytes], bytes]
) -> None:
    first = verdict(level, ahead, 30)
    place = folder().place
    assert place
    (path,) = place.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    assert verdict(level, ahead, 30) == first
    assert played == [30, 30]


def test_a_changed_line_makes_another_verdict_where_it_plays_a_part(
    level: Level, ahead: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    playing = ("world/a.py", "world/levels/a.py", "language/a.py", "mind/a.py", "game/minds.py")
    others = ("tui/a.py", "cli/a.py", "player/a.py", "game/findings.py")
    files = [tmp_path / name for name in (*playing, "schema.py", *others)]
    (tmp_path / "game" / "history").mkdir(parents=True)
    for file in (*files, *(tmp_path / part for part in run.SIMULATION if part.endswith(".py"))):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("one = 1\n")
    monkeypatch.setattr(run, "_CODE", tmp_path)
    monkeypatch.setattr(run, "simulation_digest", run.simulation_digest.__wrapped__)
    keys = [key_of(level, ahead)]
    for file in files:
        file.write_text("one = 2\n")
        keys.append(key_of(level, ahead))
    assert [after != before for before, after in pairwise(keys)] == [True] * 6 + [False] * 4


def test_level_start_and_program_make_another_verdict(level: Level, ahead: Program) -> None:
    other = Program.compile(AHEAD + "\n# as before")
    levels = (level, vary_start(level, 0), vary_start(level, 1), load_level("02-open-space"))
    assert len({key_of(each, text) for each in levels for text in (ahead, other)}) == 8


@pytest.mark.parametrize("is_full", [True, False])
def test_only_a_full_run_begins_without_verdicts(
    is_full: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config: Any = SimpleNamespace(option=SimpleNamespace(all=is_full), rootpath=tmp_path)
    monkeypatch.setenv(FOLDER_VARIABLE, str(conftest._compiled(config)))
    folder().keep("one", [b"kept"])
    conftest.forget_earlier_runs(config)
    assert (folder().read("one", 10) is None) is is_full


def test_the_digest_covers_every_module_of_the_game_that_a_run_loads() -> None:
    script = "import sys, logical_robots_tui.game.run; print(*sys.modules)"
    loaded = run_command([sys.executable, "-c", script], check=True).stdout.split()
    modules = [name.split(".", 1)[1].replace(".", "/") for name in loaded if ".game." in name]
    rooms = ("game/debugging", "game/history")
    assert {f"{module}.py" for module in modules if module not in rooms} <= {
        str(path.relative_to(run._CODE))
        for part in run.SIMULATION
        for path in [run._CODE / part, *(run._CODE / part).glob("*.py")]
    }
