"""Every example in the help of every command, in the README and in the docs does what it says.

The lines of one text are run one after the other in one folder, as a reader would type them.
"""

import contextlib
import io
import re
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from logical_robots_tui import Program
from logical_robots_tui.cli.main import PROGRAM, main
from logical_robots_tui.progress.board import Board, BoardMembership
from tests.house.examples import PAGES, blocks, commands, in_help, in_page
from tests.installed import CHECKOUT
from tests.processes import run_command
from tests.terminal import Terminal

QUICKER = {
    "diagnose 01-first-steps first-steps": ["--ticks", "100"],
    "replay record 01-first-steps first-steps -o first.replay": ["--ticks", "100"],
    "replay record 08-formation formation -o chain.replay --ticks 600": ["--ticks", "60"],
    "replay record 01-first-steps first-steps -o third.replay --start 3": ["--ticks", "100"],
    "serve --class players.toml": ["--port", "0"],
    "ladder ./board": ["--once"],
}
"""What is added, so that the tests take no longer than they need."""

ALSO_FINE = {"run": 1, "trace": 1, "why": 1, "diagnose": 1, "learn": 1}
"""Statuses other than 0 that are an answer: not won yet, there is no row, there are warnings,
the answer is wrong."""

OF_A_TERMINAL = {"doctor", "host", "ladder", "serve"}
FALSE = ("a bug in the game", "uses something that robots may not use", "Traceback")

DOCS = CHECKOUT / "docs"
HELPS = {f"{PROGRAM} {name}".strip(): in_help(parser) for name, parser in commands().items()}
TEXTS = {page.relative_to(CHECKOUT).as_posix(): in_page(page) for page in PAGES}
EXAMPLES = {text: lines for text, lines in (HELPS | TEXTS).items() if lines}


def _write_level(folder: Path, name: str = "gate.toml", page: str = "levels.md") -> None:
    level = next(block.text for block in blocks(DOCS / page) if block.language == "toml")
    (folder / name).write_text(level, "utf-8")


def _write_both_formats(folder: Path) -> None:
    _write_level(folder, "mine.toml", "level-editor.md")
    assert main(["level", "convert", str(folder / "mine.toml"), str(folder / "theirs.json")]) == 0


def _write_maze(folder: Path) -> None:
    assert main(["level", "new", str(folder / "maze.toml"), "--labyrinth", "3x2"]) == 0
    assert main(["level", "convert", str(folder / "maze.toml"), str(folder / "maze.json")]) == 0


def _write_files_of_lab(folder: Path) -> None:
    for page in ("lab.md", "grading.md", "arena.md"):
        _write_files_of(page, folder)


def _write_files_of(page: str, folder: Path) -> None:
    text = (DOCS / page).read_text("utf-8")
    for name, content in re.findall(r"^`([^`\n]+)`:\n\n```\w+\n(.*?)^```$", text, re.M | re.S):
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content, "utf-8")


def _sweep(folder: Path) -> None:
    """The files with the results of a sweep, which is made once for all tests of a process."""
    _write_files_of_lab(folder)
    ready = folder.parents[1] / "swept"
    if not ready.exists():
        assert main(["sweep", str(folder / "experiment.toml"), "-o", str(ready)]) == 0
    shutil.copytree(ready, folder / "out")


def _grade(folder: Path) -> None:
    _write_files_of_lab(folder)
    names = [str(folder / name) for name in ("assignment.toml", "submissions", "grades")]
    assert main(["grade", *names[:2], "-o", names[2]]) == 0


def _make_folders(_folder: Path) -> None:
    for name in (".local/share/bash-completion/completions", ".zfunc", ".config/fish/completions"):
        (Path.home() / name).mkdir(parents=True)


def _record(folder: Path) -> None:
    run = ["01-first-steps", "first-steps", "--ticks", "20"]
    assert main(["replay", "record", *run, "-o", str(folder / "first.replay")]) == 0


def _make_board(folder: Path) -> None:
    board = Board(folder / "board", "ada")
    board.create()
    board.join(BoardMembership(is_listed=True, name="Ada"))
    board.report(level="01-first-steps")


def _write_for_all(folder: Path) -> None:
    _write_files_of_lab(folder)
    _make_board(folder)


BEFORE: dict[str, Callable[[Path], None]] = {
    "docs/levels.md": _write_level,
    "docs/commands.md": _make_board,
    f"{PROGRAM} level convert": _write_both_formats,
    f"{PROGRAM} level check": _write_maze,
    "docs/lab.md": _write_files_of_lab,
    "docs/grading.md": _write_files_of_lab,
    "docs/autograders.md": _write_files_of_lab,
    "docs/cluster.md": _write_files_of_lab,
    "docs/arena.md": _write_files_of_lab,
    "docs/teaching.md": _write_for_all,
    "docs/board.md": _make_board,
    PROGRAM: _write_for_all,
    **{f"{PROGRAM} board{name}": _make_board for name in ("", " show", " check", " watch")},
    f"{PROGRAM} sweep": _write_files_of_lab,
    f"{PROGRAM} grade": _write_files_of_lab,
    f"{PROGRAM} grade kit": _write_files_of_lab,
    f"{PROGRAM} tournament": _write_files_of_lab,
    **{f"{PROGRAM} lab{each}": _sweep for each in ("", " status", " resume", " export", " report")},
    f"{PROGRAM} lab play": _grade,
    f"{PROGRAM} replay show": _record,
    f"{PROGRAM} replay export": _record,
    f"{PROGRAM} completion": _make_folders,
}
"""What makes the files and folders that a text speaks of and that its own examples do not make."""


LONG = re.compile(
    rf"{PROGRAM}( (--\S+|play|run|trace|when|diagnose|replay|doctor)\b|$)"
    rf"|{PROGRAM} (sweep|lab|grade|tournament)\b"
)
"""A line that opens the game, plays for long or makes many runs, unless it asks for help."""


def is_long(text: str) -> bool:
    """Whether only a full run tries the examples of a text."""
    return any(LONG.match(line) and "--help" not in line for line in EXAMPLES[text])


def programs_in(page: Path) -> list[str]:
    """The programs in a page; those of the course are shipped ones, which tests/levels compiles."""
    if page.name in ("learn.md", "solutions.md"):
        return []
    texts = [block.text for block in blocks(page) if block.language == "prolog"]
    return [text for text in texts if "Robot(" in text]


def python_in(name: str) -> list[str]:
    return [block.text for block in blocks(PLACES[name]) if block.language == "python"]


PLACES = {page.name: page for page in PAGES}
WITH_PROGRAMS = [page for page in PAGES if programs_in(page)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the reader is: a home of one's own, a level, a program, and the docs."""
    for name in ("XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("COLUMNS", "100")
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "docs").symlink_to(DOCS)
    _write_level(folder, "my-level.toml", "level-editor.md")
    program, *_ = (b.text for b in blocks(DOCS / "dialect.md") if b.language == "prolog")
    (folder / "my-program.l").write_text(program, "utf-8")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.sampled
@pytest.mark.parametrize(
    "text", [pytest.param(text, marks=[pytest.mark.slow] * is_long(text)) for text in EXAMPLES]
)
def test_the_examples_of_a_text_do_what_they_say(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if text in BEFORE:
        BEFORE[text](folder)
        capsys.readouterr()
    for line in EXAMPLES[text]:
        status, said = _run(line, capsys, monkeypatch)
        told = f"{line}\nends with {status} and says:\n{said[:4000]}"
        assert not any(each in said for each in FALSE), told
        assert status in _fine(line), told


def _run(
    line: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> tuple[int, str]:
    if _needs_a_shell(line):
        return _run_in_shell(line)
    name, *arguments = shlex.split(line)
    assert name == PROGRAM
    arguments += QUICKER.get(" ".join(arguments), [])
    plays = not arguments or "play" in arguments[:2]
    opens = plays or arguments[0] in OF_A_TERMINAL or arguments[:2] == ["board", "watch"]
    if "--help" not in arguments and opens:
        return _run_in_terminal(arguments)
    # As where somebody looks on: else it would be JSON.
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    try:
        status = main(arguments)
    except SystemExit as end:
        status = int(end.code or 0)
    return status, "".join(capsys.readouterr())


def _needs_a_shell(line: str) -> bool:
    return bool(re.search(r"[|<>*]", re.sub(r"""'[^']*'|"[^"]*\"""", "", line)))


def _run_in_shell(line: str) -> tuple[int, str]:
    call = f'{PROGRAM}() {{ {shlex.quote(sys.executable)} -m logical_robots_tui "$@"; }}'
    jq = "" if shutil.which("jq") else "jq() { cat; }"
    done = run_command(["bash", "-o", "pipefail", "-c", f"{call}\n{jq}\n{line}"])
    return done.returncode, done.stdout + done.stderr


def _run_in_terminal(arguments: list[str]) -> tuple[int, str]:
    """What opens the game is left again when it is open."""
    with Terminal(
        [sys.executable, "-m", "logical_robots_tui", *arguments], controls=True
    ) as terminal:
        if arguments[:1] == ["serve"]:
            if not {"--add", "--revoke"} & {*arguments}:
                terminal.wait_for("http://127.0.0.1:")
                terminal.send("\x03")
        elif arguments[:1] == ["host"]:
            terminal.wait_for("are forked")
            terminal.send("\x03")
        elif arguments[:1] == ["board"]:
            terminal.wait_for("01-first-steps")
            terminal.send("\x03")
        elif "--plain" in arguments:
            terminal.wait_for("help")
            terminal.send("quit\n")
        elif not arguments or "play" in arguments[:2]:
            terminal.wait_for("· applied")
            terminal.send("q")
        return terminal.finish(), terminal.everything


def _fine(line: str) -> set[int]:
    """The exit statuses of a line with which it has done what it says."""
    called = re.search(rf"{PROGRAM} (\w+)", line)
    name = called[1] if called else ""
    if name not in ALSO_FINE:
        return {0}
    assert re.search(rf"exit status: 0.*?\b{ALSO_FINE[name]} ", commands()[name].format_help())
    return {0, ALSO_FINE[name]}


def test_every_command_has_an_example() -> None:
    every = "\n".join(line for lines in EXAMPLES.values() for line in lines)
    for name in commands():
        assert re.search(rf"^(.*\| )?{PROGRAM} {name}\b".strip(), every, re.MULTILINE), name


def test_an_interrupt_ends_as_a_help_says() -> None:
    parsers = commands()
    until_interrupted = {
        name for name in parsers if parsers[name].get_default("status_after_interrupt") == 0
    }
    assert until_interrupted == {"board watch", "host", "ladder", "serve"}
    told = {name for name in parsers if "exit status: 0 after ^C" in parsers[name].format_help()}
    assert told == until_interrupted


@pytest.mark.sampled
@pytest.mark.parametrize("page", WITH_PROGRAMS, ids=lambda page: page.name)
def test_programs_in_a_page_compile(page: Path) -> None:
    for text in programs_in(page):
        assert Program.compile(text).predicate("Robot")


def run_python(texts: Iterable[str]) -> str:
    """What blocks of a page print, one after the other."""
    names: dict[str, object] = {}
    with contextlib.redirect_stdout(io.StringIO()) as out:
        for text in texts:
            exec(compile(text, "page", "exec"), names)
    return out.getvalue()


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("name", ["security.md", "why-logica.md"])
def test_python_in_a_page_runs(name: str) -> None:
    run_python(python_in(name))


@pytest.mark.slow
def test_the_page_on_cost_prints_its_table(folder: Path) -> None:
    _write_files_of("cost.md", folder)
    (table,) = (block.text for block in blocks(PLACES["cost.md"]) if block.language == "text")
    steps, steps_of_page = (
        [int(number) for number in re.findall(r"\d+", text)]
        for text in (run_python(python_in("cost.md")), table)
    )
    assert steps == pytest.approx(steps_of_page, rel=0.2), "another SQLite takes other steps"
    assert (folder / "cost.svg").stat().st_size > 0


@pytest.mark.slow
def test_the_page_on_python_runs(folder: Path) -> None:
    assert re.match(r"10 [\d.]+ \{'Ada': 10\} False\n", run_python(python_in("python.md")))
    assert (folder / "crow.replay").exists()


@pytest.mark.usefixtures("folder")
def test_what_the_page_on_python_does_with_its_own_program_runs() -> None:
    others = re.compile(r"breadcrumbs|everybody-home|saved|crow|sweep|results")
    own = [text for text in python_in("python.md") if not others.search(text)]
    assert len(own) == 3
    assert re.fullmatch(r"10 [\d.]+ \{'Ada': 10\} False\n\d+ .*\n", run_python(own))


def test_no_other_page_has_python() -> None:
    pages = {page.name for page in PAGES if python_in(page.name)}
    assert pages == {"cost.md", "python.md", "security.md", "why-logica.md"}
