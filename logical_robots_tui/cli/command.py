"""What all commands have in common."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = [
    "Commands",
    "add_data_dir",
    "add_json",
    "add_level_and_program",
    "new_command",
    "number_from",
    "opened",
    "prefers_json",
]

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

    Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


def new_command(
    commands: Commands,
    name: str,
    *,
    start: Callable[[argparse.Namespace], int],
    summary: str,
    description: str,
    epilog: str = "",
    wants_json: Callable[[argparse.Namespace], bool] = lambda _options: False,
) -> argparse.ArgumentParser:
    """Declare a command.

    Args:
        commands: Where to add it.
        name: What is typed.
        start: Does the work and returns the exit status.
        summary: One line for the list of commands.
        description: The head of the command's own help.
        epilog: Examples and exit status, laid out by hand.
        wants_json: Whether a failure is to be told as JSON.
    """
    command = commands.add_parser(
        name,
        help=summary,
        description=description,
        epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(start=start, wants_json=wants_json)
    return command


def add_level_and_program(command: argparse.ArgumentParser) -> None:
    """Add what is to be run, and the options that go with it; `opened` reads them."""
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("program", metavar="PROGRAM", help="a program's name or file")
    add_data_dir(command)


def opened(options: argparse.Namespace) -> tuple[Level, Program]:
    """The level and the compiled program that were named.

    Raises:
        InputError: One of them can't be read.
        ProgramFileError: The program is wrong.
    """
    from logical_robots_tui.cli.failure import ProgramFileError
    from logical_robots_tui.cli.folders import own_programs
    from logical_robots_tui.game import load_program
    from logical_robots_tui.mind import Program, ProgramError
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    source = load_program(options.program, own_programs(options.data_dir), pipes=True)
    try:
        return level, Program.compile(source.text)
    except ProgramError as error:
        place = str(source.path if options.program == str(source.path) else options.program)
        raise ProgramFileError(place, error) from error


def number_from(least: int) -> Callable[[str], int]:
    """A reader of whole numbers from `least` up, for an option."""

    def read(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} up")
        return number

    return read


def add_data_dir(command: argparse.ArgumentParser) -> None:
    """Add the option that says where the player's own things are kept."""
    command.add_argument(
        "--data-dir",
        type=Path,
        metavar="FOLDER",
        help="where your own programs, progress and unsaved texts are kept",
    )


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option that `prefers_json` reads."""
    command.add_argument(
        "--json", action="store_true", help="print JSON even when a terminal is looking"
    )


def prefers_json(options: argparse.Namespace) -> bool:
    """Whether to print JSON: asked for, or nobody is looking."""
    return bool(options.json) or not sys.stdout.isatty()
