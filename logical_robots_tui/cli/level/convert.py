"""``logical-robots level convert``: convert between this game's format and the web platform's."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command
from logical_robots_tui.cli.level.files import add_force, refuse_existing, tell_lost

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots level convert theirs.json theirs.toml    from the web platform
  logical-robots level convert mine.toml mine.json        to the web platform

exit status: 0 written, 2 the level can't be read or written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "convert",
        start=start,
        summary="convert a level to another format",
        description="Convert a level to the format that the new file's ending names: .toml for\n"
        "this game, .json for the web platform. Prints what the new format can't express.",
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
