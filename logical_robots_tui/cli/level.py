"""``logical-robots level``: create, check, convert and show levels."""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import harmless, new_command, new_group
from logical_robots_tui.cli.level_files import declare_convert, declare_new, write

if TYPE_CHECKING:
    from logical_robots_tui.cli.command import Commands
    from logical_robots_tui.editing.checks import LevelFinding
    from logical_robots_tui.world import Level

EPILOG = """\
examples:
  logical-robots level new maze.toml --labyrinth 8x6 --seed 3
  logical-robots level check maze.toml
  logical-robots level show maze.toml
  logical-robots level convert maze.toml maze.json

`logical-robots level COMMAND --help` explains a command.
"""


def declare(commands: Commands) -> None:
    summary = "create, check, convert and show levels"
    inner = new_group(commands, "level", summary=summary, epilog=EPILOG)
    declare_new(inner)
    _declare_check(inner)
    declare_convert(inner)
    _declare_show(inner)


FINE, WRONG = 0, 2

_CHECK_EPILOG = """\
examples:
  logical-robots level check maze.toml          print errors and warnings
  logical-robots level check *.toml *.json      check several levels
  logical-robots level check maze.toml --json   output for scripts

Positions are x:y in map units from the upper left corner.

exit status: 0 no errors (there may be warnings), 2 a level can't be loaded
"""


def _declare_check(commands: Commands) -> None:
    command = new_command(
        commands,
        "check",
        start=_check,
        summary="check a level for likely mistakes",
        description="Check levels for likely mistakes: unreachable goals, gaps in the rim, things\n"
        "inside walls, unknown names, and names used twice.",
        epilog=_CHECK_EPILOG,
    )
    command.add_argument("levels", metavar="LEVEL", nargs="+", help="a level's name or file")
    command.add_argument("--json", action="store_true", help="print JSON")


def _check(options: argparse.Namespace) -> int:
    results = []
    status = FINE
    for name in options.levels:
        found = _findings(name)
        if any(finding.forbids for finding in found):
            status = WRONG
        results.append({"file": name, "findings": [asdict(finding) for finding in found]})
        if not options.json:
            for finding in found:
                print(harmless(_line(name, finding)))
    if options.json:
        print(json.dumps({"ok": status == FINE, "levels": results}, indent=2))
    return status


def _findings(name: str) -> list[LevelFinding]:
    from logical_robots_tui.editing.checks import LevelFinding, check
    from logical_robots_tui.world import LevelError, load_level

    try:
        return check(load_level(name))
    except LevelError as error:
        inner = error.place.removeprefix(name).lstrip(":, ")
        text = f"{inner}: {error.message}" if inner else error.message
        return [LevelFinding(f"{text} {error.hint}".rstrip(), forbids=True)]


def _line(name: str, finding: LevelFinding) -> str:
    place = "" if finding.x is None else f":{finding.x:.0f}:{finding.y:.0f}"
    return f"{name}{place}: {'error' if finding.forbids else 'warning'}: {finding.text}"


_SHOW_EPILOG = """\
examples:
  logical-robots level show 05-lighthouse
  logical-robots level show my-level.toml --svg my-level.svg

In a pipe it prints ASCII characters.

exit status: 0 drawn, 2 the level can't be read or the file can't be written
"""


def _declare_show(commands: Commands) -> None:
    command = new_command(
        commands,
        "show",
        start=_show,
        summary="draw a level",
        description="Draw a level at its start, in the terminal or into a file.",
        epilog=_SHOW_EPILOG,
    )
    command.add_argument("level", metavar="LEVEL", help="a level's name or file")
    command.add_argument("--svg", type=Path, metavar="FILE", help="write an SVG file instead")
    command.add_argument("--ascii", action="store_true", help="draw with ASCII characters")


def _show(options: argparse.Namespace) -> int:
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
