"""``logical-robots level new``: create an empty room, a random labyrinth or a copy of a level."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command
from logical_robots_tui.cli.level.files import add_force, refuse_existing, tell_lost, write

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.world import Level

__all__ = ["declare"]

EPILOG = """\
examples:
  logical-robots level new room.toml --room 600x400
  logical-robots level new maze.toml --labyrinth 8x6 --seed 3 --loops 0.2
  logical-robots level new mine.toml --copy 04-everybody-home

exit status: 0 written, 2 the level can't be created or written
"""


def declare(commands: Commands) -> None:
    """Add the command to the list."""
    command = new_command(
        commands,
        "new",
        start=start,
        summary="create a level",
        description="Create a level: an empty room, a random labyrinth, or a copy.\n"
        "A file that ends with .json gets the web platform's format.",
        epilog=EPILOG,
    )
    command.add_argument("file", metavar="FILE", type=Path, help="the file to write")
    kinds = command.add_mutually_exclusive_group()
    kinds.add_argument(
        "--room", metavar="WxH", type=_size, help="an empty room, in map units (default: 600x400)"
    )
    kinds.add_argument(
        "--labyrinth", metavar="CxR", type=_size, help="a labyrinth, in columns and rows"
    )
    kinds.add_argument("--copy", metavar="LEVEL", help="a copy of a level, by name or file")
    command.add_argument("--title", help="the title")
    command.add_argument(
        "--wall",
        type=int,
        default=10,
        metavar="N",
        help="wall thickness in map units (default: 10)",
    )
    random = command.add_argument_group("labyrinths")
    random.add_argument(
        "--seed", type=int, default=0, metavar="N", help="the random seed (default: 0)"
    )
    random.add_argument(
        "--loops",
        type=float,
        default=0.1,
        metavar="SHARE",
        help="share of extra walls to open, 0 to 1 (default: 0.1)",
    )
    random.add_argument(
        "--corridor",
        type=int,
        default=60,
        metavar="N",
        help="corridor width in map units (default: 60)",
    )
    add_force(command)


def start(options: argparse.Namespace) -> int:
    """Create the level and write it."""
    from logical_robots_tui.editing.files import save_level
    from logical_robots_tui.editing.properties import set_words
    from logical_robots_tui.world import load_level
    from logical_robots_tui.world.load import read_text

    refuse_existing(options.file, force=options.force)
    level = load_level(options.copy) if options.copy else _create(options)
    words = {} if options.title is None else {"title": options.title}
    new = set_words(level, **words)
    if options.copy and Path(level.source).suffix.lower() == options.file.suffix.lower():
        write(options.file, read_text(Path(level.source)))  # with its comments
        new = save_level(new, options.file)
    else:
        new = save_level(new, options.file, anew=True)
    tell_lost(new, options.file)
    size = f"{new.width} x {new.height} units"
    print(harmless(f"{options.file}: {new.title}, {size}."))
    print(harmless(f"Play it: logical-robots play {options.file}"))
    return 0


def _create(options: argparse.Namespace) -> Level:
    from logical_robots_tui.editing.labyrinths import empty_room, labyrinth

    if options.labyrinth is None:
        return empty_room(*(options.room or (600, 400)), wall=options.wall)
    return labyrinth(
        *options.labyrinth,
        seed=options.seed,
        loops=options.loops,
        corridor=options.corridor,
        wall=options.wall,
    )


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size such as 8x6")
    return int(found[1]), int(found[2])
