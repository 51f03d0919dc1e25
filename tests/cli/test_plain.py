"""The game in lines of text."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.game import load_program
from logical_robots_tui.game.advancing import start_frame
from logical_robots_tui.game.frame import events_between
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import load_level

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command, Told


@pytest.fixture
def typed(
    command: Command, monkeypatch: pytest.MonkeyPatch, level: Path, tmp_path: Path
) -> TypedCommand:
    return TypedCommand(command, monkeypatch, level, tmp_path / "program.l")


class TypedCommand:
    """The game without a screen, and what is typed into it."""

    def __init__(
        self, command: Command, monkeypatch: pytest.MonkeyPatch, level: Path, program: Path
    ) -> None:
        self._command, self._monkeypatch = command, monkeypatch
        self._level, self.program = level, program

    def __call__(self, *lines: str) -> Told:
        return self.play(*lines, options=(self._level, self.program))

    def play(self, *lines: str, options: tuple[object, ...] = ()) -> Told:
        self._monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))
        return self._command("play", *options, "--plain")


def test_a_name_that_the_level_lacks_is_told_at_the_start(typed: TypedCommand) -> None:
    typed.program.write_text(
        'Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-\n'
        '  Sensor(robot_name:, sensor:), robot_name != "Pipp";\n'
    )
    assert (
        'Warning, line 2: no robot of this level is called "Pipp". Did you mean "Pip"?'
        in typed().out.splitlines()
    )


def test_events_are_told_in_lines(typed: TypedCommand, ahead: Path) -> None:
    typed.program = ahead
    told = typed("run", "run 200", "back 2", "where", "restart", "step 2")
    lines = told.out.splitlines()
    assert told.status == 0
    assert lines[:3] == [
        "A short way",
        "Pip: at 12, 12, heading 0 degrees.",
        "Door: Pip is not in yet.",
    ]
    won = next(line for line in lines if "Won after" in line)
    tick = int(won.split()[-2])
    assert f"Tick {tick}: Pip enters Door." in lines
    assert f"Tick {tick}: Door: Pip is in." in lines
    assert f"Tick {tick + 198}." in lines
    assert any(line.endswith(": Pip is blocked by a wall.") for line in lines)
    assert lines[-2:] == ["Tick 0.", "Tick 2."]


def test_what_can_not_be_done_is_said(typed: TypedCommand, ahead: Path) -> None:
    typed.program = ahead
    told = typed("jump", "step many", "back 3", "stop Nobody", "", "quit", "step").out
    assert "Unknown command jump. Type help for a list." in told
    assert "many is not a number of ticks." in told
    assert "Tick 0." in told
    assert "Nobody" in told
    assert "Tick 1." not in told


def test_a_run_stops_where_it_is_asked_to(typed: TypedCommand) -> None:
    typed.program.write_text(
        "Late() :- Sensor(sensor:), sensor.clock == 3;\n"
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 0) :-\n"
        "  Sensor(robot_name:);\n",
        encoding="utf-8",
    )
    told = typed("stop Late", "run 9", "stop Late", "run 9").out
    assert "Runs will stop when Late has rows." in told
    assert "Stopped: Late has rows." in told
    assert "\nTick 3.\nRuns no longer stop when Late has rows.\nTick 12.\n" in told


def test_the_program_is_read_again(typed: TypedCommand, ahead: Path) -> None:
    typed.program = ahead
    assert "The robots will use it from the next tick." in typed("apply").out
    ahead.write_text("Robot(", encoding="utf-8")
    assert typed("apply").status == 2


def test_a_player_goes_on_with_the_last_program_in_the_last_level(
    typed: TypedCommand, tmp_path: Path
) -> None:
    program, data = tmp_path / "mine.l", ("--data-dir", tmp_path / "data")
    program.write_text(
        load_program("wall-crawler").text + "\n# Changed by the player.\n", encoding="utf-8"
    )
    typed.play("step", options=("03-the-long-hall", program, *data))
    told = typed.play("apply", "save wall-crawler", "save kept", "apply", options=data).out
    assert "Loaded your last program for this level.\nThe long hall\n" in told
    assert "Type save and a name first." in told
    assert "wall-crawler is part of the game" in told
    kept = tmp_path / "data" / "programs" / "kept.l"
    assert f"Saved as kept.\nEdit {kept}, then type apply." in told
    assert kept.read_text(encoding="utf-8") == program.read_text(encoding="utf-8")
    assert told.endswith("The robots will use it from the next tick.\n")


def test_a_victory_is_kept_but_for_that_of_the_reference_program(
    typed: TypedCommand, level: Path, ahead: Path, tmp_path: Path
) -> None:
    data = ("--data-dir", tmp_path / "data")
    told = typed.play("run", options=(level, ahead, *data)).out
    assert "The victory is saved in your progress." in told
    by_the_book = typed.play("run", options=("01-first-steps", "first-steps", *data)).out
    assert "Won by a reference program: not counted." in by_the_book
    progress = Progress(tmp_path / "data" / FILE_NAME)
    mine, reference = progress.record(str(level)), progress.record("01-first-steps")
    progress.close()
    assert (mine.state, mine.bests.rules) == ("won", 1)
    assert f"Won after {mine.bests.ticks} ticks." in told
    assert (reference.state, reference.bests.ticks) == ("in work", None)


def test_batteries_and_switches_are_told(level: Path) -> None:
    start = start_frame(load_level(level))
    (robot,), (area,) = start.after.robots, start.after.areas
    changed = replace(
        start.after,
        tick=1,
        robots=(replace(robot, dead=True),),
        areas=(replace(area, active=not area.active),),
    )
    frame = replace(start, tick=1, after=changed)
    told = [*events_between(load_level(level), start, frame)]
    assert told == ["The battery of Pip is empty.", "Door is switched off."]
    back = [*events_between(load_level(level), frame, start)]
    assert back == ["Pip has charge again.", "Door is switched on."]


def test_goals_of_one_name_are_told_apart(level: Path) -> None:
    one = load_level(level)
    (area,) = one.areas
    both = replace(one, areas=(area, replace(area, x=area.x + 500, victory_robots=("Pip", "Bo"))))
    start = start_frame(both)
    here, there = start.after.areas
    entered = replace(start.after, tick=1, areas=(replace(here, visitors=("Pip",)), there))
    told = [*events_between(both, start, replace(start, tick=1, after=entered))]
    assert told == ["Pip enters Door.", "Door: Pip is in."]


def test_where_nothing_can_be_kept_no_victory_is_said_to_be_kept(
    typed: TypedCommand, ahead: Path, tmp_path: Path
) -> None:
    typed.program = ahead
    in_the_way = tmp_path / "in the way"
    in_the_way.write_text("")
    data = ("--data-dir", in_the_way / "data")
    told = typed.play("run", options=(typed._level, ahead, *data)).out
    assert "The victory only counts until you leave" in told
    assert "is kept in your progress" not in told
