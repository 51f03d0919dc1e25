"""``logical-robots levels`` and ``logical-robots programs``: lists of both."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import add_data_dir, add_no_solutions, new_command
from logical_robots_tui.cli.text import columns

if TYPE_CHECKING:
    import argparse

    from logical_robots_tui.cli.command import Commands

__all__ = ["declare"]


def declare(commands: Commands) -> None:
    """Add the commands to the list."""
    levels = new_command(
        commands,
        "levels",
        start=list_all_levels,
        summary="list the levels that come with the game",
        description="List the levels that come with the game.",
    )
    levels.add_argument("--json", action="store_true", help="print JSON")
    programs = new_command(
        commands,
        "programs",
        start=list_all_programs,
        summary="list the shipped programs and your own",
        description="List the programs that come with the game and those you saved in it.",
    )
    programs.add_argument("--json", action="store_true", help="print JSON")
    add_data_dir(programs)
    add_no_solutions(programs)


def list_all_levels(options: argparse.Namespace) -> int:
    """Print the name, title and robots of each level."""
    from logical_robots_tui.world import list_levels, load_level

    levels = [load_level(name) for name in list_levels()]
    if options.json:
        found = [
            {
                "name": level.name,
                "title": level.title,
                "robots": [robot.name for robot in level.robots],
                "starter": level.starter,
            }
            for level in levels
        ]
        print(json.dumps(found, indent=2))
        return 0
    rows = [(lv.name, lv.title, ", ".join(robot.name for robot in lv.robots)) for lv in levels]
    print(*columns([("NAME", "TITLE", "ROBOTS"), *rows]), sep="\n")
    return 0


def list_all_programs(options: argparse.Namespace) -> int:
    """Print the name and file of each program."""
    from logical_robots_tui.cli.command import own_programs
    from logical_robots_tui.game import list_programs, load_program
    from logical_robots_tui.game.source import hide_solutions
    from logical_robots_tui.progress import FILE_NAME, Progress

    own = own_programs(options.data_dir)
    if options.no_solutions:
        hide_solutions(Progress(own.parent / FILE_NAME))
    sources = [load_program(name, own) for name in list_programs(own)]
    if options.json:
        found = [
            {"name": source.name, "file": str(source.path), "shipped": source.shipped}
            for source in sources
        ]
        print(json.dumps(found, indent=2))
        return 0
    rows = [
        (source.name, "comes with the game" if source.shipped else str(source.path))
        for source in sources
    ]
    print(*columns([("NAME", "FROM"), *rows]), sep="\n")
    return 0
