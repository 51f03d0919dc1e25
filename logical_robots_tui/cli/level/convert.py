"""``logical-robots level convert``: from the format of this game to the web platform's and back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import new_command
from logical_robots_tui.cli.level.files import add_force, refuse_existing, tell_lost
from logical_robots_tui.cli.text import harmless

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots level convert theirs.json theirs.toml    from the web platform
  logical-robots level convert mine.toml mine.json        to the web platform

exit status: 0 it is written, 2 it can't be read or written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "convert",
        start=start,
        summary="turn a level into the other format",
        description="Write a level in the format that the ending of the new file says: .toml is\n"
        "this game's, .json the web platform's. Nothing is lost that the new one can say.",
        epilog=EPILOG,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("file", metavar="FILE", type=Path, help="the file to write")
    add_force(command)


def start(options: argparse.Namespace) -> int:
    """Read the level and write it."""
    from logical_robots_tui.editing.files import save_level
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    refuse_existing(options.file, force=options.force)
    save_level(level, options.file, anew=True)
    tell_lost(level, options.file)
    print(harmless(f"Wrote {options.file}."))
    return 0
