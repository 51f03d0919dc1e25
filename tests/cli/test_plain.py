"""The game in lines of text."""

from __future__ import annotations

import io
import re
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from logical_robots_tui.cli.plain import COMMANDS
from logical_robots_tui.game import load_program
from logical_robots_tui.game.advancing import start_frame
from logical_robots_tui.game.frame import events_between
from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.world import load_level
from tests.cli.running import Command, Told, in_terminal
from tests.cli.test_why import TWO_RULES
from tests.short import AHEAD

RUNS = "The robots will use it from the next tick.\n"
STILL = AHEAD.splitlines()[0].replace("0.5", "0")


@pytest.fixture
def typed(
    command: Command, monkeypatch: pytest.MonkeyPatch, level: Path, ahead: Path
) -> TypedCommand:
    return TypedCommand(command, monkeypatch, level, ahead)


class TypedCommand:
    """The game without a screen, and what is typed into it."""

    def __init__(
        self, command: Command, monkeypatch: pytest.MonkeyPatch, level: Path, program: Path
    ) -> None:
        self._command, self._monkeypatch = command, monkeypatch
        self._level, self.program = level, program

    def __call__(self, *lines: str, options: tuple[object, ...] = ()) -> Told:
        return self.play(*lines, options=(self._level, self.program, *options))

    def play(self, *lines: str, options: tuple[object, ...] = ()) -> Told:
        self._monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))
        return self._command("play", *options, "--plain")


def test_a_name_that_the_level_lacks_is_told_at_the_start(typed: TypedCommand) -> None:
    typed.program.write_text(
        'Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-\n'
        '  Sensor(robot_name:, sensor:), robot_name != "Pipp";\n'
    )
    assert (
        'Warning, line 2: No robot of this level is called "Pipp". Did you mean "Pip"?'
        in typed().out.splitlines()
    )


def test_events_are_told_in_lines(typed: TypedCommand) -> None:
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


def test_what_can_not_be_done_is_said(typed: TypedCommand) -> None:
    words = ("jump", "step many", "back 3", "stop Nobody", "stop (", "goto", "where 3", "", "quit")
    told = typed(*words, "step").out
    assert "Type goto N.\nType where.\n" in told
    assert "Runs will stop" not in told
    assert "Unknown command jump. Type help for a list." in told
    assert "many is not a number." in told
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


def test_the_program_is_read_again_and_one_that_does_not_compile_is_mended(
    typed: TypedCommand, ahead: Path
) -> None:
    assert "The robots will use it from the next tick." in typed("apply").out
    ahead.write_text("Robot(", encoding="utf-8")
    told = typed("run", "line 1 " + AHEAD.replace("\n", " "), "apply", "step")
    assert told.status == 0
    assert told.out.count("Line 1: ") == 1
    assert "There is no program yet that can run." in told.out
    assert "\nTick 1.\n" in told.out


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
    assert f"Saved as kept in {kept.parent}.\nEdit {kept}, or use line and insert here;" in told
    assert kept.read_text(encoding="utf-8") == program.read_text(encoding="utf-8")
    assert told.endswith("The robots will use it from the next tick.\n")


def test_a_victory_is_kept_but_for_that_of_the_reference_program(
    typed: TypedCommand, level: Path, ahead: Path, tmp_path: Path
) -> None:
    data = ("--data-dir", tmp_path / "data")
    told = typed("run", options=data).out
    assert "The victory is saved in your progress." in told
    by_the_book = typed.play("run", options=("01-first-steps", "first-steps", *data)).out
    assert "Won by a reference program: not counted." in by_the_book
    progress = Progress(tmp_path / "data" / FILE_NAME)
    mine, reference = progress.record(str(level)), progress.record("01-first-steps")
    progress.close()
    assert (mine.state, mine.bests.size) == ("won", 11)
    assert f"Won after {mine.bests.ticks} ticks." in told
    assert (reference.state, reference.bests.ticks) == ("started", None)


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
    in_the_way = tmp_path / "in the way"
    in_the_way.write_text("")
    data = ("--data-dir", in_the_way / "data")
    told = typed("run", options=data).out
    assert "The victory only counts until you leave" in told
    assert "is kept in your progress" not in told


HOME = """\
starter = "first-steps-starter"
hints = ["It is not far.", "It is straight ahead."]
lesson = "A rule with one case."
further = "Be there in fewer ticks."
"""


@pytest.fixture
def lesson(level: Path) -> Path:
    """The short level with something to learn."""
    level.write_text(HOME + level.read_text("utf-8"), "utf-8")
    return level


def test_every_command_is_in_the_help_and_no_other(typed: TypedCommand) -> None:
    told = typed("help").out
    for command in COMMANDS:
        assert f"\n{command.typed} " in told
        assert command.help in told


@pytest.mark.usefixtures("lesson")
def test_a_player_learns_in_lines(typed: TypedCommand, ahead: Path) -> None:
    told = typed("hint", "lesson", "hint", "hint", "run", "lesson", "results").out
    assert told.count("Hint 1: It is not far.\n") == 1
    assert "Hint 2: It is straight ahead.\nThere are no more.\nIt is not far.\n" in told
    before, _, after = told.partition("Won after")
    assert "A rule with one case." in before
    assert "Be there in fewer ticks." not in before
    assert "Be there in fewer ticks." in after
    assert "Yours: " in after


def test_a_player_answers_the_questions_of_a_lesson_in_lines(
    typed: TypedCommand, lesson: Path
) -> None:
    answer = "Way(sensor.forward_distance) :- Sensor(sensor:)"
    asked = f'{{ask = "How far?", answer = "{answer}", ticks = [0, 5]}}'
    lesson.write_text(f"questions = [{asked}]\n{lesson.read_text('utf-8')}", "utf-8")
    told = typed(
        "lesson",
        "answer 1 Way(43);",
        "answer 1 senso",
        "answer",
        "answer 1 sensor.forward_distance",
    )
    first, _, rest = told.out.partition("Question 1 of 1: How far?\n")
    assert "Right at tick 0, but at tick 5 your only row is wrong; 1 row is expected." in first
    assert "A rule with one case.\nQuestions: 0 of 1 answered. Type answer for a list.\n" in first
    assert "\nsenso\n^^^^^\n" in first
    assert rest.startswith("At ticks 0 and 5 of first-steps-starter, in the rows of all robots.\n")
    assert "0 of 1 answered.\n" in rest
    assert "Right at ticks 0 and 5.\n" in rest
    assert "Question 1 of 1, answered: How far?\n" in typed("answer 3 Robot").out
    lesson.write_text(lesson.read_text("utf-8").replace(asked, ""), "utf-8")
    assert "This level has no questions." in typed("answer").out


def test_hints_stay_revealed_and_a_level_without_texts_says_so(
    typed: TypedCommand, ahead: Path, lesson: Path, tmp_path: Path
) -> None:
    data = ("--data-dir", tmp_path / "data")
    typed("hint", options=data)
    assert "Hint 2: It is straight" in typed("hint", options=data).out
    told = typed("level 16-high-ground", "lesson", "hint", "reset", options=data)
    assert "High ground\n" in told.out


def test_a_player_inspects_in_lines(typed: TypedCommand) -> None:
    typed.program.write_text(TWO_RULES, "utf-8")
    told = typed(
        *("why", "step 3", "look", "why", "why Speed(9)", "why tree", "why Sped"),
        *("ask Speed(30)", "ask Speed(", "origin", "origin desire.right_engine", "origin 1+"),
        *("diagnose", "program", "robot Pip", "robot Pop"),
    ).out
    assert "No decision yet: run or step first." in told
    assert "Around Pip:\nahead: wall at 40; 30° left: wall at 16; " in told
    assert "\nahead: area Door at " in told
    assert "Robot for Pip at tick 3\n+ line 2: " in told
    assert "For more, type why tree or one of:\n  why Speed(41) == 1" in told
    assert "Speed for Pip at tick 3\n- line 1: " in told
    assert "sensor.forward_distance = 41" in told
    assert "There is no predicate Sped." in told
    assert "Line 1: This '(' is never closed." in told
    assert '1. Pip\'s memory = "far"\n' in told
    assert "1. Pip's desire.right_engine = 1\n" in told
    assert "'1+' is not a part such as memory.plan" in told
    assert "Ticks 1 to 3, not won." in told
    assert "\n1: Speed(d) = 1 :- d > 20;\n2: Robot(" in told
    assert "The robot is Pip.\nThere is no robot Pop. There is Pip." in told


def test_a_program_is_edited_in_lines(typed: TypedCommand, ahead: Path, tmp_path: Path) -> None:
    told = typed("insert 1 # Mine.", "program", "apply", "save edited", "line 1", "apply").out
    assert "Type apply, and the robots will use it.\n1: # Mine.\n2: Robot(" in told
    assert told.count("The robots will use it from the next tick.") == 2
    (file,) = (tmp_path / "home").rglob("edited.l")
    assert file.read_text("utf-8") == f"# Mine.\n{ahead.read_text('utf-8')}"


def test_a_mistake_is_told_once_and_the_robots_go_on(typed: TypedCommand) -> None:
    told = typed("line 1 Robot(", "apply", "step", "where").out
    assert told.count("Line 1: ") == 1
    assert "Tick 1.\nPip: at " in told
    assert "There is no line 9" in typed("line 9 x").out


def test_earlier_versions_and_the_starter_come_back(
    typed: TypedCommand, ahead: Path, lesson: Path
) -> None:
    starter = load_program("first-steps-starter").text.splitlines()[0]
    told = typed("reset", "yes", "program", "versions", "versions 1", "program", "versions 77").out
    assert "The starter program is back." in told
    assert f"1: {starter}\n" in told
    assert " #1: 3 lines\n" in told
    assert f"The earlier version is back.\n{RUNS}1: {ahead.read_text('utf-8').splitlines()[0]}" in (
        told
    )
    assert "There is no version 77." in told


def test_a_player_goes_on_to_other_levels_and_programs(typed: TypedCommand) -> None:
    told = typed(
        "level 01-first-steps",
        "next",
        "look",
        "level nowhere",
        "level",
        "open wall-crawler",
        "step",
    ).out
    assert told.index("\nFirst steps\n") < told.index("\nOpen space\n") < told.index("Around Ada:")
    assert 'There is no level called "nowhere".' in told
    assert "03-the-long-hall: The long hall\n" in told
    assert told.endswith(f"{RUNS}Tick 1.\n")


def test_unsaved_text_is_offered_and_any_other_line_leaves_the_question_open(
    typed: TypedCommand, ahead: Path, level: Path, tmp_path: Path
) -> None:
    options = ("--data-dir", tmp_path / "data")
    typed("line 1 # Unfinished(", options=options)
    told = typed("where", options=options).out
    assert "Unsaved text. Continue with your unsaved text of “ahead” from" in told
    assert (
        "Type one of these. yes: Yes, continue; no: No, set it aside; show: Show it.\nPip" in told
    )
    told = typed("show", "yes", "program", options=options).out
    assert told.count("# Unfinished(") == 2
    assert typed("no", "program", options=options).out.count("# Unfinished(") == 0
    assert "Unsaved text" not in typed("program", options=options).out


def test_solutions_are_shown_to_those_who_insist(typed: TypedCommand) -> None:
    options = ("01-first-steps",)
    told = typed.play("solution", "no", "solution", "where", options=options).out
    assert told.count("Do you want to see winning programs") == 2
    assert "Unknown" not in told
    assert told.endswith("Goal: Ada is not in yet.\n")
    first = load_program("first-steps").text.splitlines()[0]
    assert first in typed.play("solution", "yes", options=options).out


def test_the_past_is_gone_to_and_another_future_switched_to(typed: TypedCommand) -> None:
    told = typed(
        *("step 5", "goto 2", "where", "goto 77", "other", "line 1", "insert 1 " + STILL, "apply"),
        *("step 2", "other", "step 1"),
    ).out
    assert "Tick 77 is not in history" in told
    assert "There is no other branch." in told
    assert told.endswith("Tick 4.\nTick 4.\nTick 5.\n")


def test_a_run_is_ended_by_an_interrupt_and_the_game_goes_on(level: Path, ahead: Path) -> None:
    ahead.write_text(AHEAD.replace("0.5", "-0.5"))
    with in_terminal("play", level, ahead, "--plain") as terminal:
        terminal.wait_for("Type help for the commands.")
        terminal.send("run 1000000\r")
        terminal.wait_for("is blocked by a wall.")
        terminal.process.send_signal(signal.SIGINT)
        terminal.wait_for(lambda: re.search(r"^Tick \d{1,6}\.$", terminal.text, re.MULTILINE))
        terminal.send("quit\r")
        assert terminal.finish() == 0
