"""The subcommands of ``logical-robots level``."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from logical_robots_tui.cli.level import check, convert, new, show

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots level new maze.toml --labyrinth 8x6 --seed 3
  logical-robots level check maze.toml
  logical-robots level show maze.toml
  logical-robots level convert maze.toml maze.json

`logical-robots level COMMAND --help` explains a command.
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = commands.add_parser(
        "level",
        help="create, check, convert and show levels",
        description="Create, check, convert and show levels.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    inner = command.add_subparsers(title="commands", metavar="COMMAND", required=True)
    new.declare(inner)
    check.declare(inner)
    convert.declare(inner)
    show.declare(inner)
