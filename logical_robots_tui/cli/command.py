"""What all commands have in common."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

    Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"

__all__ = [
    "Commands",
    "add_data_dir",
    "add_json",
    "folder_of",
    "new_command",
    "number_from",
    "own_programs",
    "prefers_json",
]


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


def folder_of(data_dir: Path | None, player: str | None = None) -> Path:
    """The folder for everything of a player's.

    Args:
        data_dir: The folder that was named, or None for the system's place for it.
        player: A name, where many players share an account.
    """
    if data_dir is None:
        from platformdirs import user_data_path

        data_dir = user_data_path("logical-robots", appauthor=False)
    return data_dir / "players" / player if player else data_dir


def own_programs(data_dir: Path | None) -> Path:
    """The folder with the player's own programs.

    Args:
        data_dir: The folder for everything of the player's, or None for the system's place for it.
    """
    return folder_of(data_dir) / "programs"


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option that `prefers_json` reads."""
    command.add_argument(
        "--json", action="store_true", help="print JSON even when a terminal is looking"
    )


def prefers_json(options: argparse.Namespace) -> bool:
    """Whether to print JSON: asked for, or nobody is looking."""
    return bool(options.json) or not sys.stdout.isatty()
