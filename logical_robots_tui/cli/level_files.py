"""``logical-robots level new`` and ``level convert``: writing level files."""

from __future__ import annotations

import argparse
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command
from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_file, is_folder

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.world import Level

_NEW_EPILOG = """\
examples:
  logical-robots level new room.toml --room 600x400
  logical-robots level new maze.toml --labyrinth 8x6 --seed 3 --loops 0.2
  logical-robots level new mine.toml --copy 04-everybody-home

exit status: 0 written, 2 the level can't be created or written
"""


def declare_new(commands: Commands) -> None:
    command = new_command(
        commands,
        "new",
        start=_new,
        summary="create a level",
        description="Create a level: an empty room, a random labyrinth, or a copy.\n"
        "A file that ends with .json gets the web platform's format.",
        epilog=_NEW_EPILOG,
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


def _new(options: argparse.Namespace) -> int:
    from logical_robots_tui.editing.files import save_level
    from logical_robots_tui.editing.things import set_words
    from logical_robots_tui.world import load_level
    from logical_robots_tui.world.levels.load import read_text

    refuse_existing(options.file, force=options.force)
    level = load_level(options.copy) if options.copy else _create(options)
    words = {} if options.title is None else {"title": options.title}
    new = set_words(level, **words)
    file = Path(level.source)
    if options.copy and file.suffix.lower() == options.file.suffix.lower() and is_file(file):
        write(options.file, read_text(file))  # with its comments
        new = save_level(new, options.file)
    else:
        new = save_level(new, options.file, anew=True)
    _tell_lost(new, options.file)
    size = f"{new.width} x {new.height} units"
    print(harmless(f"{options.file}: {new.title}, {size}."))
    print(harmless(f"Play it: logical-robots play {options.file}"))
    return 0


def _create(options: argparse.Namespace) -> Level:
    from logical_robots_tui.world.levels.labyrinths import empty_room, labyrinth

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


_CONVERT_EPILOG = """\
examples:
  logical-robots level convert theirs.json theirs.toml    from the web platform
  logical-robots level convert mine.toml mine.json        to the web platform

exit status: 0 written, 2 the level can't be read or written
"""


def declare_convert(commands: Commands) -> None:
    command = new_command(
        commands,
        "convert",
        start=_convert,
        summary="convert a level to another format",
        description="Convert a level to the format that the new file's ending names: .toml for\n"
        "this game, .json for the web platform. Prints what the new format can't express.",
        epilog=_CONVERT_EPILOG,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("file", metavar="FILE", type=Path, help="the file to write")
    add_force(command)


def _convert(options: argparse.Namespace) -> int:
    from logical_robots_tui.editing.files import save_level
    from logical_robots_tui.world import load_level

    level = load_level(options.level)
    refuse_existing(options.file, force=options.force)
    save_level(level, options.file, anew=True)
    _tell_lost(level, options.file)
    print(harmless(f"Wrote {options.file}."))
    return 0


def add_force(command: argparse.ArgumentParser) -> None:
    command.add_argument("--force", action="store_true", help="replace an existing file")


def refuse_existing(path: Path, *, force: bool) -> None:
    """Raise InputError if the file exists and may not be replaced."""
    if (is_file(path) or is_folder(path)) and not force:
        raise InputError(
            "This file already exists.",
            place=str(path),
            hint="Choose another name, or add --force to replace it.",
        )


def _tell_lost(level: Level, path: Path) -> None:
    from logical_robots_tui.editing.level_text import lost_in_web
    from logical_robots_tui.world.levels.load import WEB

    lost = lost_in_web(replace(level, name=path.stem))
    if path.suffix.lower() == WEB and lost:
        print(f"Left out because the web platform does not support it: {', '.join(lost)}.")


def write(path: Path, content: str | bytes) -> None:
    """Write a file in one step, or raise InputError."""
    from logical_robots_tui.writing import write_atomically

    try:
        write_atomically(path, content)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"The file can't be written: {reason}.", place=str(path)) from error
