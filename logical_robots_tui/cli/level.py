"""``logical-robots level`` and ``levels``: create, check, convert, show and list levels."""

from __future__ import annotations

import argparse
import re
import shutil
import sys
from dataclasses import asdict, replace
from pathlib import Path

from logical_robots_tui import world
from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import columns, harmless, print_json
from logical_robots_tui.errors import InputError, joined
from logical_robots_tui.paths import is_file, is_folder
from logical_robots_tui.wording import join_names

FINE, WRONG = 0, 2


@command.declare("levels", command.JSON)
def list_all_levels(options: argparse.Namespace) -> int:
    """list the levels that come with the game

    List the levels that come with the game.
    """
    levels = [world.load_level(name) for name in world.list_shipped()]
    if options.json:
        entries = [
            {
                "name": level.name,
                "title": level.title,
                "robots": [robot.name for robot in level.robots],
                "starter": level.starter,
                "teams": [team.name for team in level.teams],
            }
            for level in levels
        ]
        print_json(entries)
        return 0
    rows = []
    for level in levels:
        names = join_names(entry.name for entry in level.teams or level.robots)
        rows.append((level.name, level.title, "teams: " * bool(level.teams) + names))
    print(*columns([("NAME", "TITLE", "ROBOTS"), *rows]), sep="\n")
    return 0


command.group(
    "level",
    "create, check, convert and show levels",
    """\
  logical-robots level new maze.toml --labyrinth 8x6 --seed 3
  logical-robots level check maze.toml
  logical-robots level show maze.toml
  logical-robots level convert maze.toml maze.json
""",
)

_FILE = command.option("file", "FILE", "the file to write", type=Path)


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size such as 8x6")
    return int(match[1]), int(match[2])


def _labyrinths(parser: argparse._ActionsContainer) -> None:
    group = parser.add_argument_group("labyrinths")
    command.number("--seed", int, 0, "the random seed")(group)
    summary = "share of extra walls to open, 0 to 1 (default: 0.1)"
    group.add_argument("--loops", type=float, default=0.1, metavar="SHARE", help=summary)
    command.number("--corridor", int, 60, "corridor width in map units")(group)


@command.declare(
    "level new",
    _FILE,
    command.one_of(
        command.option(
            "--room", "WxH", "an empty room, in map units (default: 600x400)", type=_size
        ),
        command.option("--labyrinth", "CxR", "a labyrinth, in columns and rows", type=_size),
        command.option("--copy", "LEVEL", "a copy of a level, by name or file"),
    ),
    command.option("--title", None, "the title"),
    command.number("--wall", int, 10, "wall thickness in map units"),
    _labyrinths,
    command.FORCE,
)
def _new(options: argparse.Namespace) -> int:
    """create a level

    Create a level: an empty room, a random labyrinth, or a copy.
    A file that ends with .json gets the web platform's format.

    examples:
      logical-robots level new room.toml --room 600x400
      logical-robots level new maze.toml --labyrinth 8x6 --seed 3 --loops 0.2
      logical-robots level new mine.toml --copy 04-everybody-home

    exit status: 0 written, 2 the level can't be created or written
    """
    from logical_robots_tui.editing.entities import set_words
    from logical_robots_tui.editing.files import save_level
    from logical_robots_tui.world.levels.labyrinths import empty_room, labyrinth
    from logical_robots_tui.world.levels.load import read_text

    refuse_existing(options.file, force=options.force)
    if options.copy:
        level = world.load_level(options.copy)
    elif options.labyrinth is None:
        level = empty_room(*(options.room or (600, 400)), wall=options.wall)
    else:
        level = labyrinth(
            *options.labyrinth,
            seed=options.seed,
            loops=options.loops,
            corridor=options.corridor,
            wall=options.wall,
        )
    words = {} if options.title is None else {"title": options.title}
    new_level = set_words(level, **words)
    file = Path(level.source)
    if options.copy and file.suffix.lower() == options.file.suffix.lower() and is_file(file):
        write(options.file, read_text(file))  # with its comments
        new_level = save_level(new_level, options.file)
    else:
        new_level = save_level(new_level, options.file, replace_all=True)
    _print_losses(new_level, options.file)
    size = f"{new_level.width} x {new_level.height} units"
    print(harmless(f"{options.file}: {new_level.title}, {size}."))
    print(harmless(f"Play it: logical-robots play {options.file}"))
    return 0


@command.declare("level check", command.LEVELS, command.JSON)
def _check(options: argparse.Namespace) -> int:
    """check a level for likely mistakes

    Check levels for likely mistakes: unreachable goals, gaps in the rim, things
    inside walls, unknown names, and names used twice.

    examples:
      logical-robots level check maze.toml          print errors and warnings
      logical-robots level check *.toml *.json      check several levels
      logical-robots level check maze.toml --json   output for scripts

    Positions are x, y in map units from the upper left corner.

    exit status: 0 no errors (there may be warnings), 2 a level can't be loaded
    """
    from logical_robots_tui.editing.checks import LevelFinding, check

    results = []
    status = FINE
    for name in options.levels:
        try:
            findings = check(world.load_level(name))
        except world.LevelError as error:
            inner = error.place.removeprefix(name).lstrip(":, ")
            text = f"{joined(inner, error.message)} {error.hint}".rstrip()
            findings = [LevelFinding(text, forbids=True)]
        if any(finding.forbids for finding in findings):
            status = WRONG
        results.append({"file": name, "findings": [asdict(finding) for finding in findings]})
        for finding in findings if not options.json else ():
            place = "" if finding.x is None else f": at {finding.x:.0f}, {finding.y:.0f}"
            severity = "error" if finding.forbids else "warning"
            print(harmless(f"{name}{place}: {severity}: {finding.text}"))
    if options.json:
        print_json({"ok": status == FINE, "levels": results})
    return status


@command.declare("level convert", command.LEVEL, _FILE, command.FORCE)
def _convert(options: argparse.Namespace) -> int:
    """convert a level to another format

    Convert a level to the format that the new file's ending names: .toml for
    this game, .json for the web platform. Prints what the new format can't express.

    examples:
      logical-robots level convert theirs.json theirs.toml    from the web platform
      logical-robots level convert mine.toml mine.json        to the web platform

    exit status: 0 written, 2 the level can't be read or written
    """
    from logical_robots_tui.editing.files import save_level

    level = world.load_level(options.level)
    refuse_existing(options.file, force=options.force)
    save_level(level, options.file, replace_all=True)
    _print_losses(level, options.file)
    print(harmless(f"Wrote {options.file}."))
    return 0


def refuse_existing(path: Path, *, force: bool) -> None:
    """Raise InputError if the file exists and may not be replaced."""
    if (is_file(path) or is_folder(path)) and not force:
        raise InputError(
            "This file already exists.",
            place=str(path),
            hint="Choose another name, or add --force to replace it.",
        )


def _print_losses(level: world.Level, path: Path) -> None:
    from logical_robots_tui.editing.level_text import lost_in_web
    from logical_robots_tui.world.levels.load import WEB

    losses = lost_in_web(replace(level, name=path.stem))
    if path.suffix.lower() == WEB and losses:
        print(f"Left out because the web platform does not support it: {', '.join(losses)}.")


def write(path: Path, content: str | bytes) -> None:
    """Write a file in one step, or raise InputError."""
    from logical_robots_tui.paths import write_atomically

    try:
        write_atomically(path, content)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"The file can't be written: {reason}.", place=str(path)) from error


@command.declare(
    "level show",
    command.LEVEL,
    command.option("--svg", "FILE", "write an SVG file instead", type=Path),
    command.flag("--ascii", "draw with ASCII characters"),
    command.flag("--json", "print its robots, beacons and areas as JSON"),
)
def _show(options: argparse.Namespace) -> int:
    """draw a level

    Draw a level at its start, in the terminal or into a file.

    examples:
      logical-robots level show 05-lighthouse
      logical-robots level show my-level.toml --svg my-level.svg

    In a pipe it prints ASCII characters.

    exit status: 0 drawn, 2 the level can't be read or the file can't be written
    """
    level = world.load_level(options.level)
    if options.json:
        kinds = ("robots", "beacons", "areas", "teams")
        entities = {kind: [asdict(entity) for entity in getattr(level, kind)] for kind in kinds}
        from logical_robots_tui.game.source import names_in

        names = {kind: sorted(names) for kind, names in asdict(names_in(level)).items()}
        print_json({"name": level.name, "title": level.title, "names": names, **entities})
    elif options.svg is not None:
        from logical_robots_tui.tui.labyrinth.svg import svg

        write(options.svg, svg(level))
        print(harmless(f"Wrote {options.svg}."))
    else:
        _print(level, plain=options.ascii)
    return 0


def _print(level: world.Level, *, plain: bool) -> None:
    """Print a level as large as the terminal allows; in ASCII if there are no colours."""
    from rich.console import Console

    from logical_robots_tui.tui.labyrinth.drawing import DARK, Drawing
    from logical_robots_tui.tui.library.cards import miniature

    size = shutil.get_terminal_size((100, 40))
    console = Console(width=size.columns)
    plain = plain or not sys.stdout.isatty() or console.color_system is None or console.no_color
    rows = max(min(size.lines - 1, round(size.columns * level.height / level.width / 2)), 1)
    drawing = Drawing.ASCII if plain else Drawing.QUADRANTS
    cells = miniature(level, size.columns, rows, drawing, DARK, names=True)
    if plain:
        print(*(line.rstrip() for line in cells.plain()), sep="\n")
        return
    for row in range(rows):
        for segment in cells.strip(row):
            console.print(segment.text, style=segment.style, end="", markup=False, highlight=False)
        console.print()
