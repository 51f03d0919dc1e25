"""``logical-robots level show``: a picture of a level, in the terminal or in a file."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import new_command
from logical_robots_tui.cli.level.files import write
from logical_robots_tui.cli.text import harmless

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.world import Level

__all__ = ["declare"]

MOST_PIXELS = 4000

EPILOG = """\
examples:
  logical-robots level show 05-lighthouse
  logical-robots level show my-level.toml --svg my-level.svg
  logical-robots level show my-level.toml --png my-level.png --pixels 2000

Into a pipe it prints plain characters. A PNG is without names; an SVG has them.

exit status: 0, or 2 if the level can't be read or the picture not be written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "show",
        start=start,
        summary="draw a level",
        description="Draw a level at its start, in the terminal or into files.",
        epilog=EPILOG,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("--svg", type=Path, metavar="FILE", help="write a drawing of SVG")
    command.add_argument("--png", type=Path, metavar="FILE", help="write an image of PNG")
    command.add_argument(
        "--pixels",
        type=_pixels,
        default=1600,
        metavar="N",
        help="of the longer side of the PNG (default: %(default)s)",
    )
    command.add_argument("--ascii", action="store_true", help="draw with plain characters")


def start(options: argparse.Namespace) -> int:
    """Draw the level."""
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    if options.svg is not None:
        from logical_robots_tui.tui.labyrinth.drawing.svg import svg

        write(options.svg, svg(level))
        print(harmless(f"Wrote {options.svg}."))
    if options.png is not None:
        from logical_robots_tui.tui.labyrinth.drawing.image import draw_pixels, png

        write(options.png, png(draw_pixels(level, options.pixels)))
        print(harmless(f"Wrote {options.png}."))
    if options.svg is None and options.png is None:
        _print(level, plain=options.ascii)
    return 0


def _print(level: Level, *, plain: bool) -> None:
    """Print a level as large as the terminal allows; without colours in plain characters."""
    from rich.console import Console

    from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing
    from logical_robots_tui.tui.library.miniature import draw_miniature

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


def _pixels(text: str) -> int:
    try:
        pixels = int(text)
    except ValueError:
        pixels = 0
    if not 1 <= pixels <= MOST_PIXELS:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of pixels up to {MOST_PIXELS}")
    return pixels
