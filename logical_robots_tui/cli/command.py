"""What all commands share: how they are declared, what they print, and how they fail."""

from __future__ import annotations

import argparse
import json
import logging
import math
import os
import platform
import sys
import traceback
import unicodedata
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from textwrap import dedent
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from logical_robots_tui import __version__
from logical_robots_tui.errors import InputError, LogicalRobotsError, is_out_of_memory
from logical_robots_tui.wording import align

if TYPE_CHECKING:
    import rich.progress

    from logical_robots_tui.mind import Diagnostic, ProgramError
    from logical_robots_tui.progress import Progress

Part: TypeAlias = "Callable[[argparse._ActionsContainer], object]"
"""Adds something to a command's parser."""

Start: TypeAlias = Callable[[argparse.Namespace], int]

INTERRUPTED = 130  # 128 + SIGINT, as a shell reports it

_COMMANDS: dict[str, tuple[Start, tuple[Part, ...]]] = {}
_GROUPS: dict[str, tuple[str, str]] = {}


def declare(name: str, *parts: Part) -> Callable[[Start], Start]:
    """Declare a command, or one of a group, such as ``level new``, with its arguments.

    The function does the work and returns the exit status. Its docstring is the help: a line for
    the list of commands, a paragraph, and the rest.
    """

    def note(start: Start) -> Start:
        _COMMANDS[name] = start, parts
        return start

    return note


def group(name: str, summary: str, examples: str) -> None:
    """Declare a command that consists of commands."""
    hint = f"`logical-robots {name} COMMAND --help` explains a command."
    _GROUPS[name] = summary, f"examples:\n{examples}\n{hint}\n"


def add_command(commands: argparse._SubParsersAction[argparse.ArgumentParser], name: str) -> None:
    """Add a declared command or group to the parser.

    Errors are reported as JSON where `wants_json` says so: by default with ``--json``.
    """
    first, _, member = name.partition(" ")
    if name in _GROUPS:
        summary, epilog = _GROUPS[name]
        description = f"{summary[0].upper()}{summary[1:]}."
    else:
        start, parts = _COMMANDS[name]
        summary, _, body = (start.__doc__ or "").partition("\n\n")
        description, _, epilog = dedent(body).partition("\n\n")
    parser = commands.add_parser(
        member if member and first in _GROUPS else name,
        help=summary,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    if name in _GROUPS:
        inner = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
        for other_name in _COMMANDS:
            if other_name.startswith(f"{name} "):
                add_command(inner, other_name)
        return
    parser.set_defaults(
        start=start,
        status_after_interrupt=INTERRUPTED,
        wants_json=lambda options: getattr(options, "json", False),
    )
    for part in parts:
        part(parser)


def option(names: str, metavar: str | None, about: str, **settings: Any) -> Part:
    """Return an argument, named as in ``-o --output``; a default that is a function is called."""

    def add(parser: argparse._ActionsContainer) -> None:
        default = settings.get("default")
        overrides = {"default": default()} if callable(default) else {}
        parser.add_argument(*names.split(), metavar=metavar, help=about, **settings | overrides)

    return add


def number(name: str, read: Callable[[str], float], default: float, about: str) -> Part:
    return option(name, "N", f"{about} (default: {default})", type=read, default=default)


def flag(name: str, about: str, default: Callable[[], bool] = bool, **settings: Any) -> Part:
    return lambda parser: parser.add_argument(
        name, help=about, action="store_true", default=default(), **settings
    )


def one_of(*options: Part) -> Part:
    """Return options that exclude each other."""

    def add(parser: argparse._ActionsContainer) -> None:
        inner = parser.add_mutually_exclusive_group()
        for part in options:
            part(inner)

    return add


def until_interrupted(parser: argparse._ActionsContainer) -> None:
    """Let the command run until ^C and then end with 0."""
    parser.set_defaults(status_after_interrupt=0)


def number_from(minimum: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        try:
            integer = int(text)
        except ValueError:
            integer = minimum - 1
        if integer < minimum:
            raise argparse.ArgumentTypeError(f"{text!r} is not an integer of at least {minimum}")
        return integer

    return read


def programs(nargs: Literal["+", "*"] = "+") -> Part:
    """Return program arguments: `programs` by order, `teams` by team; both may be empty."""

    def add(parser: argparse._ActionsContainer) -> None:
        by_order = parser.add_argument(
            "programs",
            nargs=nargs,
            default=[],
            metavar="PROGRAM",
            help="a program's name or file; where teams play, one for each in order",
        )
        by_order.required = False  # with "*" none could follow an option
        parser.add_argument(
            "--team",
            dest="teams",
            type=_team_and_program,
            action="append",
            default=[],
            metavar="TEAM=PROGRAM",
            help="the program of a team, by its name",
        )

    return add


def named_programs(options: argparse.Namespace) -> list[str]:
    return [*options.programs, *(program for _team, program in options.teams)]


def _team_and_program(text: str) -> tuple[str, str]:
    team, sign, program = text.partition("=")
    if not (team and sign and program):
        raise argparse.ArgumentTypeError(f"{text!r} is not a team and a program: red=mine.l")
    return team, program


def is_set(variable: str) -> bool:
    return os.environ.get(variable, "") not in ("", "0")


LEVEL = option("level", "LEVEL", "a level's name or file")
LEVELS = option("levels", "LEVEL", "a level's name or file", nargs="+")
START = option(
    "--start",
    "N",
    "begin from this varied start (default: 0, the given start)",
    dest="start_number",
    type=number_from(0),
    default=0,
)
DATA_DIR = option(
    "--data-dir", "FOLDER", "the folder for your programs, progress and unsaved work", type=Path
)
NO_SOLUTIONS = flag(
    "--no-solutions",
    "for a class: hide the solution of each level until it is won",
    lambda: is_set("LOGICAL_ROBOTS_NO_SOLUTIONS"),
)


def board_folder() -> str | None:
    return os.environ.get("LOGICAL_ROBOTS_BOARD") or None


BOARD = option(
    "--board",
    "FOLDER",
    "compare victories with those of all players of this server",
    type=Path,
    default=board_folder,
)
JSON = flag("--json", "print JSON")
FORCE = flag("--force", "replace an existing file")


def folder_of(data_dir: Path | None, player: str | None = None) -> Path:
    """Return the folder for a player's files; each named player has a folder in it."""
    if data_dir is None:
        from platformdirs import user_data_path

        data_dir = user_data_path("logical-robots", appauthor=False)
    return data_dir / "players" / player if player else data_dir


def own_programs(options: argparse.Namespace) -> Path:
    """Return the folder with the player's own programs; hide solutions with --no-solutions."""
    folder = folder_of(options.data_dir)
    if options.no_solutions:
        from logical_robots_tui.game.source import hide_solutions
        from logical_robots_tui.progress import FILE_NAME, Progress

        hide_solutions(Progress(folder / FILE_NAME))
    return folder / "programs"


def open_progress(options: argparse.Namespace) -> Progress:
    """Open the player's record of progress; what is wrong with it goes to standard error."""
    from logical_robots_tui.progress import FILE_NAME, Progress

    file = folder_of(options.data_dir) / FILE_NAME
    return Progress(file, lambda message: print(harmless(message), file=sys.stderr))


def prefers_json(options: argparse.Namespace) -> bool:
    """Return whether to print JSON: on request, or if standard output is not a terminal."""
    return bool(options.json) or not sys.stdout.isatty()


UNRELIABLE = "A time limit ended a thought: another run may differ."

_UNPRINTABLE = {"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"}


def harmless(text: str) -> str:
    r"""Make text from a file or program safe to print: control characters become ``\x1b``."""
    return "".join(repr(c)[1:-1] if unicodedata.category(c) in _UNPRINTABLE else c for c in text)


def say(*sentences: str) -> None:
    """Print and flush, because a screen reader or another program waits for the line."""
    for sentence in sentences:
        for line in sentence.splitlines():
            print(harmless(line), flush=True)


def columns(rows: list[tuple[str, ...]]) -> list[str]:
    """Format rows as aligned columns, two spaces apart, with `harmless` cells."""
    return align([[*map(harmless, row)] for row in rows])


def _finite(value: Any) -> Any:
    """Replace infinities and NaN, which JSON does not have, by null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): _finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return value


def print_json(value: Any) -> None:
    print(json.dumps(_finite(value), indent=2))


def line_of_json(value: Any) -> str:
    r"""Format a value as one line of JSON, with control characters escaped as in ``\u009b``."""
    text = json.dumps(_finite(value), ensure_ascii=False, allow_nan=False)
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def cut(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: max(0, width - 3)]}..."


@contextmanager
def progress_bar(title: str, ticks: int, *, delay: float = 0.0) -> Iterator[Callable[..., None]]:
    """Show a progress bar after some seconds; yield a callback for finished ticks, and of all."""
    began = monotonic()
    with drawn_bar(title, delay) as draw:

        def show(tick: int, total: int = ticks) -> None:
            pace = tick / max(monotonic() - began, 1e-9)
            draw(tick, total, f"tick {tick} of {total}", f"{pace:.0f} ticks/s")

        yield show


_REDRAW_SECONDS = 0.1


@contextmanager
def drawn_bar(title: str, delay: float = 0.0) -> Iterator[Callable[[int, int, str, str], None]]:
    """Yield a function that draws a bar: part, whole, two texts beside it; none in a pipe."""
    next_time = monotonic() + delay if sys.stderr.isatty() else float("inf")
    bar: rich.progress.Progress | None = None
    with ExitStack() as stack:

        def draw(part: int, whole: int, count: str, note: str) -> None:
            nonlocal bar, next_time
            current_time = monotonic()
            if current_time < next_time:
                return
            next_time = current_time + _REDRAW_SECONDS
            if bar is None:
                bar = stack.enter_context(_new_bar())
                bar.add_task(harmless(title), total=whole, count="", note="")
            task = bar.task_ids[0]
            bar.update(task, completed=part, total=whole, count=count, note=note, refresh=True)

        yield draw


def _new_bar() -> rich.progress.Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.fields[count]}", markup=False),
        TextColumn("{task.fields[note]}", markup=False),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )


BAD_INPUT = 2
BUG = 70  # EX_SOFTWARE in sysexits.h


class ProgramFileError(LogicalRobotsError):
    """A program that was read from a file can't be compiled."""

    title = "This program can't run yet"

    def __init__(self, place: str, error: ProgramError) -> None:
        self.place = place
        self.diagnostics: tuple[Diagnostic, ...] = error.diagnostics
        super().__init__(str(error))


def report(error: LogicalRobotsError, *, as_json: bool) -> int:
    """Report an error on standard error, with `as_json` also on standard output."""
    document: dict[str, Any] = {"kind": "other", "message": str(error)}
    lines = [str(error)]
    if isinstance(error, ProgramFileError):
        from dataclasses import asdict  # slow to load

        diagnostics, lines = [], []
        for diagnostic in error.diagnostics:
            place = f"{error.place}:{diagnostic.line}:{diagnostic.column}"
            texts = diagnostic.excerpt.strip(), diagnostic.hint
            lines += [f"{place}: {diagnostic.message}", *(f"    {text}" for text in texts if text)]
            diagnostics.append(asdict(diagnostic))
            del diagnostics[-1]["severity"]
        document = {"kind": "program", "place": error.place, "diagnostics": diagnostics}
    elif isinstance(error, InputError):
        document = {"kind": "input", "place": error.place, "message": error.message}
        document["hint"] = error.hint
    if as_json:
        print_json({"error": document})
    _say(*lines)
    return BAD_INPUT


def report_output(error: OSError) -> int:
    """Report that standard output can't be written; return the exit status."""
    _say(f"Can't write to standard output: {error.strerror}.")
    return BAD_INPUT


def report_bug(error: Exception, *, as_json: bool) -> int:
    """Write a bug's traceback to a log file, print its path, and return the exit status."""
    log = _write_log("".join(traceback.format_exception(error)))
    name = type(error).__name__
    advice = f"See {log} for details" if log else "The details could not be written to a log file"
    if as_json:
        print_json({"error": {"kind": "bug", "message": name, "log": str(log or "")}})
    if is_out_of_memory(error):
        _say(f"The game has run out of memory. {advice}.")
    else:
        _say(f"This is a bug in the game, not your mistake ({name}). {advice}.")
    return BUG


def _say(head: str, *details: str) -> None:
    lines = f"logical-robots: {harmless(head)}", *map(harmless, details)
    with suppress(OSError):  # the exit status still says it
        print(*lines, sep="\n", file=sys.stderr)


class CrashLog(logging.Handler):
    """Writes each logged bug to its own file, and prints nothing."""

    def emit(self, record: logging.LogRecord) -> None:
        _write_log(self.format(record))


def _write_log(message: str) -> Path | None:
    """Write a new file in the system's log folder; return None if it can't be written."""
    from platformdirs import user_log_path

    moment = datetime.now(UTC)
    versions = f"logical-robots {__version__}, Python {platform.python_version()}, {sys.platform}"
    text = f"{versions}\n{moment.isoformat(timespec='seconds')}\n\n{message}"
    try:
        folder = user_log_path("logical-robots", appauthor=False)
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"crash-{moment:%Y%m%d-%H%M%S-%f}.log"
        path.write_text(text, encoding="utf-8")
    except OSError:
        return None
    return path
