"""What all commands share: options, and text that is safe to print."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import unicodedata
from collections.abc import Callable
from pathlib import Path
from textwrap import dedent
from typing import Any, Literal, TypeAlias

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


def new_command(
    commands: Commands,
    name: str,
    start: Callable[[argparse.Namespace], int],
    *,
    wants_json: Callable[[argparse.Namespace], bool] = lambda options: (
        "json" in options and options.json
    ),
) -> argparse.ArgumentParser:
    """Declare a command; `start` does the work and returns the exit status.

    Its docstring is the help: a line for the list of commands, a paragraph, and the rest.
    `wants_json` says whether errors are reported as JSON; by default with ``--json``.
    """
    summary, _, rest = (start.__doc__ or "").partition("\n\n")
    description, _, epilog = dedent(rest).partition("\n\n")
    command = commands.add_parser(
        name,
        help=summary,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(start=start, wants_json=wants_json)
    return command


def new_group(commands: Commands, name: str, *, summary: str, epilog: str) -> Commands:
    """Declare a command that consists of commands, and return where to add those."""
    command = commands.add_parser(
        name,
        help=summary,
        description=f"{summary[0].upper()}{summary[1:]}.",
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    return command.add_subparsers(title="commands", metavar="COMMAND", required=True)


def number_from(least: int) -> Callable[[str], int]:
    def read(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise argparse.ArgumentTypeError(f"{text!r} is not an integer of at least {least}")
        return number

    return read


def add_programs(command: argparse.ArgumentParser, *, nargs: Literal["+", "*"] = "+") -> None:
    """Add program arguments: `programs` by order, `teams` by team; both may be empty."""
    programs = command.add_argument(
        "programs",
        nargs=nargs,
        default=[],
        metavar="PROGRAM",
        help="a program's name or file; where teams play, one for each in order",
    )
    programs.required = False  # with "*" none could follow an option
    command.add_argument(
        "--team",
        dest="teams",
        type=_team_and_program,
        action="append",
        default=[],
        metavar="TEAM=PROGRAM",
        help="the program of a team, by its name",
    )


def named_programs(options: argparse.Namespace) -> list[str]:
    return [*options.programs, *(program for _team, program in options.teams)]


def _team_and_program(text: str) -> tuple[str, str]:
    team, sign, program = text.partition("=")
    if not (team and sign and program):
        raise argparse.ArgumentTypeError(f"{text!r} is not a team and a program: red=mine.l")
    return team, program


def add_start(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--start",
        dest="start_number",
        type=number_from(0),
        default=0,
        metavar="N",
        help="a shifted start by its number, as laboratory and robustness try it "
        "(default: 0, the given one)",
    )


def add_data_dir(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--data-dir",
        type=Path,
        metavar="FOLDER",
        help="the folder for your programs, progress and unsaved work",
    )


def is_set(variable: str) -> bool:
    return os.environ.get(variable, "") not in ("", "0")


def add_no_solutions(command: argparse.ArgumentParser) -> None:
    """Add the option that hides solutions; a teacher sets it for a class."""
    command.add_argument(
        "--no-solutions",
        action="store_true",
        default=is_set("LOGICAL_ROBOTS_NO_SOLUTIONS"),
        help="for a class: hide the solution of each level until it is won",
    )


def folder_of(data_dir: Path | None, player: str | None = None) -> Path:
    """Return the folder for a player's files; each named player has a folder in it."""
    if data_dir is None:
        from platformdirs import user_data_path

        data_dir = user_data_path("logical-robots", appauthor=False)
    return data_dir / "players" / player if player else data_dir


def own_programs(options: argparse.Namespace) -> Path:
    """Return the folder with the player's own programs, and hide solutions if that is wanted."""
    folder = folder_of(options.data_dir)
    if options.no_solutions:
        from logical_robots_tui.game.source import hide_solutions
        from logical_robots_tui.progress import FILE_NAME, Progress

        hide_solutions(Progress(folder / FILE_NAME))
    return folder / "programs"


def add_json(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="print JSON even to a terminal")


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
    clean = [tuple(harmless(cell) for cell in row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*clean, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in clean
    ]


def finite(value: Any) -> Any:
    """Replace infinities and NaN, which JSON does not have, by null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [finite(inner) for inner in value]
    return value


def line_of_json(value: Any) -> str:
    r"""Format a value as one line of JSON, with control characters escaped as in ``\u009b``."""
    text = json.dumps(finite(value), ensure_ascii=False, allow_nan=False)
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def cut(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: max(0, width - 3)]}..."
