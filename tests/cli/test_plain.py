"""The game in lines of text."""

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
from tests.cli.running import Ask, Command, Told, in_terminal
from tests.cli.test_why import TWO_RULES
from tests.short import AHEAD

RUNS = "The robots will use it from the next tick.\n"
STANDS = "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 0) :-\n  "
HOME = """\
starter = "first-steps-starter"
hints = ["It is not far.", "It is straight ahead."]
lesson = "A rule with one case."
further = "Be there in fewer ticks."
"""


class TypedCommand:
    def __init__(self, command: Command, level: Path, program: Path, data: Path) -> None:
        self._command, self._level, self.program = command, level, program
        self.options = ("--data-dir", data)

    def __call__(self, *lines: str) -> Told:
        return self.play(self._level, self.program)(*lines)

    def play(self, *words: object) -> Ask:
        return lambda *lines: self._command("play", *words, *self.options, "--plain", typed=lines)


@pytest.fixture
def typed(command: Command, level: Path, ahead: Path, tmp_path: Path) -> TypedCommand:
    return TypedCommand(command, level, ahead, tmp_path / "data")


@pytest.fixture
def lesson(level: Path) -> Path:
    level.write_text(HOME + level.read_text("utf-8"), "utf-8")
    return level


def test_a_name_that_the_level_lacks_is_told_at_the_start(typed: TypedCommand) -> None:
    typed.program.write_text(f'{STANDS}Sensor(robot_name:), robot_name != "Pipp";\n')
    said = 'Warning, line 2: No robot of this level is called "Pipp". Did you mean "Pip"?'
    assert said in typed().out.splitlines()


def test_events_are_told_in_lines(typed: TypedCommand) -> None:
    lines = typed("run", "run 200", "back 2", "where", "restart", "step 2").success.splitlines()
    opening = ["A short way", "Pip: at 12, 12, heading 0 degrees.", "Door: Pip is not in yet."]
    assert lines[:3] == opening
    tick = int(next(line for line in lines if "Won after" in line).split()[-2])
    assert f"Tick {tick}: Pip enters Door." in lines
    assert f"Tick {tick}: Door: Pip is in." in lines
    assert f"Tick {tick + 198}." in lines
    assert any(line.endswith(": Pip is blocked by a wall.") for line in lines)
    assert lines[-2:] == ["Tick 0.", "Tick 2."]


def test_what_can_not_be_done_is_said(typed: TypedCommand) -> None:
    words = ("jump", "step many", "back 3", "stop Nobody", "stop (", "goto", "where 3", "", "quit")
    told = typed(*words, "step").out
    for text in ("Type goto N.\nType where.\n", "many is not a number.", "Tick 0.", "Nobody"):
        assert text in told
    assert "Unknown command jump. Type help for a list." in told
    assert "Runs will stop" not in told
    assert "Tick 1." not in told


def test_a_run_stops_where_it_is_asked_to(typed: TypedCommand) -> None:
    late = "Late() :- Sensor(sensor:), sensor.clock == 3;\n"
    typed.program.write_text(f"{late}{STANDS}Sensor(robot_name:);\n", "utf-8")
    told = typed("stop Late", "run 9", "stop Late", "run 9").out
    assert "Runs will stop when Late has rows." in told
    assert "Stopped: Late has rows." in told
    assert "\nTick 3.\nRuns no longer stop when Late has rows.\nTick 12.\n" in told


def test_the_program_is_read_again_and_one_that_does_not_compile_is_mended(
    typed: TypedCommand,
) -> None:
    assert RUNS in typed("apply").out
    typed.program.write_text("Robot(", encoding="utf-8")
    told = typed("run", "line 1 " + AHEAD.replace("\n", " "), "apply", "step").success
    assert told.count("Line 1: ") == 1
    assert "There is no program yet that can run." in told
    assert "\nTick 1.\n" in told


def test_a_player_goes_on_where_the_last_game_was(typed: TypedCommand, tmp_path: Path) -> None:
    program, kept = tmp_path / "mine.l", tmp_path / "data" / "programs" / "kept.l"
    program.write_text(load_program("wall-crawler").text + "\n# Changed by the player.\n", "utf-8")
    typed.play("03-the-long-hall", program)("step")
    told = typed.play()("apply", "save wall-crawler", "save kept", "apply").out
    assert "Loaded your last program for this level.\nThe long hall\n" in told
    assert "Type save and a name first." in told
    assert "wall-crawler is part of the game" in told
    assert f"Saved as kept in {kept.parent}.\nEdit {kept}, or use line and insert here;" in told
    assert kept.read_text("utf-8") == program.read_text("utf-8")
    assert told.endswith(RUNS)


def test_a_victory_is_kept_but_for_that_of_the_reference_program(
    typed: TypedCommand, level: Path, tmp_path: Path
) -> None:
    told = typed("run").out
    assert "The victory is saved in your progress." in told
    by_the_book = typed.play("01-first-steps", "first-steps")("run").out
    assert "Won by a reference program: not counted." in by_the_book
    progress = Progress(tmp_path / "data" / FILE_NAME)
    mine, reference = progress.record(str(level)), progress.record("01-first-steps")
    progress.close()
    assert (mine.state, mine.bests.size) == ("won", 11)
    assert f"Won after {mine.bests.ticks} ticks." in told
    assert (reference.state, reference.bests.ticks) == ("started", None)


def test_batteries_switches_and_goals_of_one_name_are_told_apart(level: Path) -> None:
    one = load_level(level)
    start = start_frame(one)
    (robot,), (area,) = start.after.robots, start.after.areas
    robots, areas = (replace(robot, dead=True),), (replace(area, active=not area.active),)
    frame = replace(start, tick=1, after=replace(start.after, tick=1, robots=robots, areas=areas))
    told = [*events_between(one, start, frame)]
    assert told == ["The battery of Pip is empty.", "Door is switched off."]
    assert [*events_between(one, frame, start)] == ["Pip has charge again.", "Door is switched on."]
    (goal,) = one.areas
    both = replace(one, areas=(goal, replace(goal, x=goal.x + 500, victory_robots=("Pip", "Bo"))))
    start = start_frame(both)
    here, there = start.after.areas
    entered = replace(start.after, tick=1, areas=(replace(here, visitors=("Pip",)), there))
    told = [*events_between(both, start, replace(start, tick=1, after=entered))]
    assert told == ["Pip enters Door.", "Door: Pip is in."]


def test_no_victory_is_kept_where_nothing_is(typed: TypedCommand, tmp_path: Path) -> None:
    (tmp_path / "data").write_text("")
    typed.options = ("--data-dir", tmp_path / "data" / "data")
    told = typed("run").out
    assert "The victory only counts until you leave" in told
    assert "is kept in your progress" not in told


def test_every_command_is_in_the_help_and_no_other(typed: TypedCommand) -> None:
    told = typed("help").out
    for command in COMMANDS:
        assert f"\n{command.usage} " in told
        assert command.help in told


@pytest.mark.usefixtures("lesson")
def test_a_player_learns_in_lines(typed: TypedCommand) -> None:
    told = typed("hint", "lesson", "hint", "hint", "run", "lesson", "results").out
    assert told.count("Hint 1: It is not far.\n") == 1
    assert "Hint 2: It is straight ahead.\nThere are no more.\nIt is not far.\n" in told
    before, _, after = told.partition("Won after")
    assert "A rule with one case." in before
    assert "Be there in fewer ticks." not in before
    assert "Be there in fewer ticks." in after
    assert "Yours: " in after
    # The hints stay revealed, and a level without texts says so.
    assert typed("hint").out.endswith("There are no more.\nIt is not far.\nIt is straight ahead.\n")
    assert "High ground\n" in typed("level 16-high-ground", "lesson", "hint", "reset").out


def test_a_player_answers_questions_of_a_lesson_in_lines(typed: TypedCommand, lesson: Path) -> None:
    answer = "Way(sensor.forward_distance) :- Sensor(sensor:)"
    asked = f'{{ask = "How far?", answer = "{answer}", ticks = [0, 5]}}'
    lesson.write_text(f"questions = [{asked}]\n{lesson.read_text('utf-8')}", "utf-8")
    right = "answer 1 sensor.forward_distance"
    told = typed("lesson", *(f"answer 1 {text}" for text in ("Way(43);", "senso")), "answer", right)
    first, _, rest = told.out.partition("Question 1 of 1: How far?\n")
    assert "Right at tick 0, but at tick 5 your only row is wrong; 1 row is expected." in first
    assert "A rule with one case.\nQuestions: 0 of 1 answered. Type answer for a list.\n" in first
    assert "\nsenso\n^^^^^\n" in first
    assert rest.startswith("At ticks 0 and 5 of first-steps-starter, in the rows of all robots.\n")
    assert "0 of 1 answered.\n" in rest
    assert "Right at ticks 0 and 5; these rows are from tick 5.\n" in rest
    assert "Question 1 of 1, answered: How far?\n" in typed("answer 3 Robot").out
    lesson.write_text(lesson.read_text("utf-8").replace(asked, ""), "utf-8")
    assert "This level has no questions." in typed("answer").out


INSPECTED = (
    "No decision yet: run or step first.",
    "Around Pip:\nahead: wall at 40; 30° left: wall at 16; ",
    "\nahead: area Door at ",
    "Robot for Pip at tick 3\n+ line 2: ",
    "For more, type why tree or one of:\n  why Speed(41) == 1",
    "Speed for Pip at tick 3\n- line 1: ",
    "sensor.forward_distance = 41",
    "There is no predicate Sped.",
    "Line 1: This '(' is never closed.",
    '1. Pip\'s memory = "far"\n',
    "1. Pip's desire.right_engine = 1\n",
    "'1+' is not a part such as memory.plan",
    "Ticks 1 to 3, not won.",
    "\n1: Speed(d) = 1 :- d > 20;\n2: Robot(",
    "The robot is Pip.\nThere is no robot Pop. There is Pip.",
)


def test_a_player_inspects_in_lines(typed: TypedCommand) -> None:
    typed.program.write_text(TWO_RULES, "utf-8")
    told = typed(
        *("why", "step 3", "look", "why", "why Speed(9)", "why tree", "why Sped"),
        *("ask Speed(30)", "ask Speed(", "origin", "origin desire.right_engine", "origin 1+"),
        *("diagnose", "program", "robot Pip", "robot Pop"),
    ).out
    assert [text for text in INSPECTED if text not in told] == []


def test_a_program_is_edited_and_mistakes_told_once(typed: TypedCommand, tmp_path: Path) -> None:
    told = typed("insert 1 # Mine.", "program", "apply", "save edited", "line 1", "apply").out
    assert "Type apply, and the robots will use it.\n1: # Mine.\n2: Robot(" in told
    assert told.count(RUNS) == 2
    file = tmp_path / "data" / "programs" / "edited.l"
    assert file.read_text("utf-8") == f"# Mine.\n{typed.program.read_text('utf-8')}"
    told = typed("line 1 Robot(", "apply", "step", "where").out
    assert told.count("Line 1: ") == 1
    assert "Tick 1.\nPip: at " in told
    assert "There is no line 9" in typed("yes", "line 9 x").out


@pytest.mark.usefixtures("lesson")
def test_earlier_versions_and_the_starter_come_back(typed: TypedCommand) -> None:
    starter, ahead = (
        load_program(name).text.splitlines()[0] for name in ("first-steps-starter", typed.program)
    )
    told = typed("reset", "yes", "program", "versions", "versions 1", "program", "versions 77").out
    for text in ("The starter program is back.", f"1: {starter}\n", " #1: 3 lines\n"):
        assert text in told
    assert f"The earlier version is back.\n{RUNS}1: {ahead}" in told
    assert "There is no version 77." in told


def test_a_player_goes_on_to_other_levels_and_programs(typed: TypedCommand) -> None:
    levels = ("level 01-first-steps", "next", "look", "level nowhere", "level")
    told = typed(*levels, "open wall-crawler", "step").out
    assert told.index("\nFirst steps\n") < told.index("\nOpen space\n") < told.index("Around Ada:")
    assert 'There is no level called "nowhere".' in told
    assert "03-the-long-hall: The long hall\n" in told
    assert told.endswith(f"{RUNS}Tick 1.\n")


def test_unsaved_text_is_offered_and_any_other_line_leaves_the_question_open(
    typed: TypedCommand,
) -> None:
    typed("line 1 # Unfinished(")
    told = typed("where").out
    assert "Unsaved text. Continue with your unsaved text of “ahead” from" in told
    choices = "yes: Yes, continue; no: No, set it aside; show: Show it."
    assert f"Type one of these. {choices}\nPip" in told
    assert typed("show", "yes", "program").out.count("# Unfinished(") == 2
    assert typed("no", "program").out.count("# Unfinished(") == 0
    assert "Unsaved text" not in typed("program").out


def test_solutions_are_shown_to_those_who_insist(typed: TypedCommand) -> None:
    play = typed.play("01-first-steps")
    told = play("solution", "no", "solution", "where").out
    assert told.count("Do you want to see winning programs") == 2
    assert "Unknown" not in told
    assert told.endswith("Goal: Ada is not in yet.\n")
    assert load_program("first-steps").text.splitlines()[0] in play("solution", "yes").out


def test_the_past_is_gone_to_and_another_future_switched_to(typed: TypedCommand) -> None:
    still = AHEAD.splitlines()[0].replace("0.5", "0")
    told = typed(
        *("step 5", "goto 2", "where", "goto 77", "other", "line 1", "insert 1 " + still, "apply"),
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
