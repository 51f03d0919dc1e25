"""``logical-robots level show``: draw a level in the terminal or into a file."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command
from logical_robots_tui.cli.level.files import write

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.world import Level

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots level show 05-lighthouse
  logical-robots level show my-level.toml --svg my-level.svg

In a pipe it prints ASCII characters.

exit status: 0 drawn, 2 the level can't be read or the file can't be written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "show",
        start=start,
        summary="draw a level",
        description="Draw a level at its start, in the terminal or into a file.",
        epilog=EPILOG,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("--svg", type=Path, metavar="FILE", help="write an SVG file instead")
    command.add_argument("--ascii", action="store_true", help="draw with ASCII characters")


def start(options: argparse.Namespace) -> int:
    """Draw the level."""
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    if options.svg is not None:
        from logical_robots_tui.tui.labyrinth.svg import svg

        write(options.svg, svg(level))
        print(harmless(f"Wrote {options.svg}."))
    else:
        _print(level, plain=options.ascii)
    return 0


def _print(level: Level, *, plain: bool) -> None:
    """Print a level as large as the terminal allows; in ASCII if there are no colours."""
    from rich.console import Console

    from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing
    from logical_robots_tui.tui.library.card import draw_miniature

    size = shutil.get_terminal_size((100, 40))
    console = Console(width=size.columns)
    plain = plain or not sys.stdout.isatty() or console.color_system is None or console.no_color
    rows = max(min(size.lines - 1, round(size.columns * level.height / level.width / 2)), 1)
    drawing = Drawing.ASCII if plain else Drawing.QUADRANTS
    cells = draw_miniature(level, size.columns, rows, drawing, DARK, names=True)
    if plain:
        print(*(line.rstrip() for line in cells.plain()), sep="\n")
        return
    for row in range(rows):
        for segment in cells.strip(row):
            console.print(segment.text, style=segment.style, end="", markup=False, highlight=False)
        console.print()
