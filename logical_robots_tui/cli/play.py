"""``logical-robots play``: open the game in this terminal."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import add_data_dir, add_engine, check_engine, new_command
from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots play                  where you stopped, or the first level
  logical-robots play LEVEL            another level of the list
  logical-robots play my-level.toml my-program.l

exit status: 0 after quitting, 2 if the game can't be opened
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "play",
        start=start,
        summary="open the game in this terminal",
        description="Open the game in this terminal.",
        epilog=EPILOG,
    )
    command.add_argument("level", nargs="?", metavar="LEVEL", help="a level's name or file")
    command.add_argument("program", nargs="?", metavar="PROGRAM", help="a program's name or file")
    add_engine(command)
    add_data_dir(command)


def start(options: argparse.Namespace) -> int:
    """Open the game.

    Raises:
        InputError: There is no terminal, no such engine, or the level or program can't be used.
    """
    streams = (sys.stdin, sys.stdout, sys.stderr)
    if not all(stream.isatty() for stream in streams) or os.environ.get("TERM") == "dumb":
        raise InputError(
            "the game needs a terminal.",
            hint="Without one, use: logical-robots run LEVEL PROGRAM",
        )
    check_engine(options)
    # The terminal knows its size better than a shell that once exported it.
    for name in ("COLUMNS", "LINES"):
        os.environ.pop(name, None)
    # What is told of a tick follows its picture within so much; Textual waits twice as long.
    os.environ.setdefault("TEXTUAL_FPS", "120")
    from logical_robots_tui.tui.play import play

    return play(options.level, options.program, options.data_dir, options.engine)
