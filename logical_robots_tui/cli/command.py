"""What all commands have in common."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Commands", "add_data_dir", "add_engine", "check_engine", "new_command"]

if TYPE_CHECKING:
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


def add_data_dir(command: argparse.ArgumentParser) -> None:
    """Add the option that says where the player's own things are kept."""
    command.add_argument(
        "--data-dir",
        type=Path,
        metavar="FOLDER",
        help="where your own programs, progress and unsaved texts are kept",
    )


def add_engine(command: argparse.ArgumentParser) -> None:
    """Add the option that says what robots think with."""
    command.add_argument(
        "--engine",
        choices=("sqlite", "duckdb"),
        default="sqlite",
        help="what the robots think with; duckdb is quicker for 200 and more (default: "
        "%(default)s)",
    )


def check_engine(options: argparse.Namespace) -> None:
    """Make sure that what the robots are to think with is there.

    Raises:
        InputError: It is not installed.
    """
    if options.engine == "duckdb":
        from logical_robots_tui.mind import check_installed

        check_installed()


def prefers_json(options: argparse.Namespace) -> bool:
    """Whether to print JSON: asked for, or nobody is looking."""
    return bool(options.json) or not sys.stdout.isatty()
