"""The command as a whole: help, lists, refusals, and what happens when we are wrong."""

import argparse
import json
import logging
import re
import shutil
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import logical_robots_tui
from logical_robots_tui import supervisor
from logical_robots_tui.cli import command as commands
from logical_robots_tui.cli import main
from logical_robots_tui.cli.command import columns, harmless, line_of_json
from logical_robots_tui.cli.main import parser as command_parser
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.wording import join_names
from tests.cli.running import Command, Told
from tests.processes import run_command
from tests.terminal import Terminal

COMMANDS = (
    *("play", "run", "trace", "query", "when", "why", "origin", "diagnose", "check", "lsp", "help"),
    *(
        "levels",
        "programs",
        "progress",
        "level",
        "config",
        "doctor",
        "serve",
        "completion",
        "board",
    ),
)
SUBCOMMANDS = ("new", "check", "convert", "show")


def test_the_help_names_every_command_and_an_unknown_one_is_refused(command: Command) -> None:
    assert "'fly'" in command("fly").refusal
    assert command("--version").out == f"logical-robots {logical_robots_tui.__version__}\n"
    told = command("--help").success
    for name in COMMANDS:
        assert re.search(rf"^ {{4,}}{name}( |$)", told, re.MULTILINE), name


@pytest.mark.parametrize("words", ["", *COMMANDS, *(f"level {name}" for name in SUBCOMMANDS)])
def test_each_help_fits_a_terminal_of_80_columns_and_has_examples_and_exit_statuses(
    words: str, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    told = command(*words.split(), "--help").out
    assert told.startswith("usage: logical-robots")
    assert max(map(len, told.splitlines())) <= 80
    if words in ("play", "run") or words.startswith("level "):
        assert "examples:" in told
        assert "exit status:" in told
    if words == "level":
        assert all(f"    {name} " in told for name in SUBCOMMANDS)


def test_commands_in_whose_process_programs_think_are_bounded() -> None:
    for module in set(main._HOMES.values()):
        import_module(f"logical_robots_tui.cli.{module}")
    parts = {name: parts for name, (_, parts) in commands._COMMANDS.items()}
    think = {name for name in parts if any("run_args" in part.__qualname__ for part in parts[name])}
    assert len(think) >= 7
    assert think <= supervisor._THINKING <= main._HOMES.keys()


def test_a_command_that_is_loaded_alone_takes_what_it_takes_among_the_others() -> None:
    def usages(parser: argparse.ArgumentParser) -> dict[str, str]:
        commands = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
        return {name: command.format_help() for name, command in commands.choices.items()}

    together = usages(command_parser())
    assert {"play", "programs", "level", "completion"} <= set(together)
    for name, usage in together.items():
        alone = usages(command_parser(name))
        assert alone[name] == usage
        assert set(alone) == {name}


@pytest.mark.parametrize("arguments", [(), ("play",), ("play", "x", "y"), ("--data-dir", "x")])
def test_without_a_terminal_it_points_to_run(arguments: tuple[str, ...], command: Command) -> None:
    told = command(*arguments)
    assert (told.status, told.out, told.err.count("\n")) == (2, "", 1)
    assert "needs a terminal" in told.err
    assert "logical-robots run LEVEL PROGRAM" in told.err


def test_a_dumb_terminal_is_not_a_terminal() -> None:
    with Terminal([sys.executable, "-m", "logical_robots_tui"], env={"TERM": "dumb"}) as terminal:
        assert terminal.finish() == 2
    assert "needs a terminal" in terminal.text


def test_a_stream_that_is_piped_is_named(command: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True)
    told = command()
    assert (told.status, "for standard error too." in told.err) == (2, True)


def test_the_levels_are_listed_with_title_and_robots(command: Command) -> None:
    levels = command("levels", "--json").data
    assert levels
    for level, line in zip(levels, command("levels").out.splitlines()[1:], strict=True):
        assert level["title"] in line
        assert line.startswith(level["name"])
        if level["name"] == "13-swarm":
            assert len(level["robots"]) == 100
            assert line.endswith("  Bee 1 … Bee 100")
        else:
            assert line.endswith(", ".join(level["teams"] or level["robots"]))


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ("", ""),
        ("Ada", "Ada"),
        ("Bee 1,Bee 2", "Bee 1, Bee 2"),
        ("Bee 8,Bee 9,Bee 10", "Bee 8 … Bee 10"),
        ("Ada,R2,R3,R4,D4,D5,D6,D8", "Ada, R2 … R4, D4 … D6, D8"),
        ("R08,R09,R10", "R08 … R10"),
        ("R3,R2,R1", "R3, R2, R1"),
        ("1,2,3", "1 … 3"),
    ],
)
def test_numbered_names_in_order_are_abbreviated(names: str, said: str) -> None:
    assert join_names(names.split(",")) == said


def test_shipped_and_own_programs_are_listed(command: Command, tmp_path: Path) -> None:
    own = tmp_path / "programs"
    own.mkdir()
    (own / "mine.l").write_text("# nothing yet\n")
    programs = command("programs", "--data-dir", tmp_path, "--json").data
    by_name = {program["name"]: program for program in programs}
    assert by_name["mine"] == {"name": "mine", "file": str(own / "mine.l"), "shipped": False}
    assert any(program["shipped"] for program in programs)
    assert str(own / "mine.l") in command("programs", "--data-dir", tmp_path).out


def test_a_mistake_of_ours_is_told_and_kept_in_a_log_file_if_one_can_be_written(
    command: Command, home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("logical_robots_tui.cli.level.columns", None)
    told = command("levels")
    assert told.status == 70
    assert "a bug in the game" in told.err
    assert "Traceback" not in told.err
    (log,) = home.rglob("crash-*.log")
    assert str(log) in told.err
    assert "TypeError: 'NoneType' object is not callable" in log.read_text()
    shutil.rmtree(home / ".local")
    (home / ".local").write_text("a file where a folder should be")
    told = command("levels")
    assert told.status == 70
    assert "could not be written to a log file" in told.err


def test_a_reader_that_has_enough_is_no_error() -> None:
    with subprocess.Popen(
        [sys.executable, "-m", "logical_robots_tui", "levels"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        assert process.stderr.read() == b""
    assert process.returncode == 141


def in_shell(words: str, typed: str = "") -> Told:
    command = ["sh", "-c", f"{sys.executable} -m logical_robots_tui {words}"]
    done = run_command(command, input=typed)
    return Told(done.returncode, done.stdout, done.stderr)


FULL = "logical-robots: Can't write to standard output: No space left on device.\n"


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("levels > /dev/full", FULL),
        ("run 01-first-steps first-steps --ticks 5 > /dev/full", FULL),
        ("run nowhere nothing --json > /dev/full", FULL),
        ("levels > /dev/full 2>&1", ""),
        ("run nowhere nothing 2> /dev/full", ""),
    ],
)
def test_a_full_disk_is_told_where_anything_can_be_and_by_the_status(typed: str, told: str) -> None:
    assert in_shell(typed).refusal == told


def test_what_the_parts_log_is_kept_in_a_file_and_not_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    log = logging.getLogger("elsewhere")
    keeper = commands.CrashLog(logging.ERROR)
    log.addHandler(keeper)
    log.error("it stumbled")
    log.removeHandler(keeper)
    (kept,) = (tmp_path / "logical-robots" / "log").iterdir()
    assert "it stumbled" in kept.read_text()
    assert capsys.readouterr().err == ""


@pytest.mark.sampled
@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_stream_that_is_closed_is_an_empty_one(closed: str, tmp_path: Path) -> None:
    told = in_shell(f"play 01-first-steps --plain --data-dir '{tmp_path}' {closed}", "step\n")
    assert (told.status, told.err) == (0, "")
    assert ("Tick 1." in told.out) == (closed == "2>&-")


def test_without_a_name_everything_is_listed_in_lines_that_fit_a_terminal(command: Command) -> None:
    told = command("help").success
    listed = {line.split("  ")[1] for line in told.splitlines() if line.startswith("  ")}
    assert listed == {entry.name for entry in REFERENCE}
    assert max(map(len, told.splitlines())) <= 90


@pytest.mark.parametrize("name", ["ArgMin", "argmin"])
def test_a_function_is_explained_with_an_example(name: str, command: Command) -> None:
    assert command("help", name).success == (
        "ArgMin{x -> y :- P(x, y)}\n"
        "  the x of the smallest y (an aggregate)\n"
        "\n"
        "  ArgMin{x -> -x :- x in [1, 2]}\n"
        "  gives 2\n"
    )


def test_a_misspelt_name_gets_a_suggestion(command: Command) -> None:
    refusal = command("help", "Squrt").refusal
    assert refusal == "logical-robots: There is no function Squrt. Did you mean Sqrt?\n"
    assert "`logical-robots help` lists" in command("help", "Xyzzyx").err


@given(st.text())
def test_made_harmless_or_json_a_text_is_printable(text: str) -> None:
    line = line_of_json({"memory": text})
    assert line.isprintable()
    assert json.loads(line) == {"memory": text}
    assert all(c.isprintable() or c in " \u00a0\u3000" or c.isspace() for c in harmless(text))
    assert not set(harmless(text)) & {"\x1b", "\x9b", "\r", "\n", "\t", "\x7f", "\u202e"}


@given(st.text(st.characters(categories=["L", "N", "P", "S"])))
def test_what_is_harmless_stays_as_it_is(text: str) -> None:
    assert harmless(text) == text


def test_control_characters_are_shown_by_their_code_and_letters_stay_letters() -> None:
    assert harmless("a\x1b[2J\nb\u202ec\ud800") == r"a\x1b[2J\nb\u202ec\ud800"
    assert line_of_json(["ü\x9b\x07\u202e"]) == r'["ü\u009b\u0007\u202e"]'


def test_columns_line_up_and_end_without_blanks() -> None:
    assert columns([("A", "B"), ("long", "x"), ("y", "")]) == ["A     B", "long  x", "y"]
