"""Commands that print what there is: levels, programs, functions, and the settings."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import (
    Commands,
    add_data_dir,
    add_no_solutions,
    columns,
    harmless,
    new_command,
)
from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_there
from logical_robots_tui.wording import join_names

if TYPE_CHECKING:
    from logical_robots_tui.language.reference import FunctionHelp
    from logical_robots_tui.world import Level


def declare(commands: Commands) -> None:
    help_ = new_command(commands, "help", print_help)
    help_.add_argument("name", metavar="FUNCTION", nargs="?", help="what to explain")
    levels = new_command(commands, "levels", list_all_levels)
    levels.add_argument("--json", action="store_true", help="print JSON")
    programs = new_command(commands, "programs", list_all_programs)
    programs.add_argument("--json", action="store_true", help="print JSON")
    add_data_dir(programs)
    add_no_solutions(programs)
    config = new_command(commands, "config", print_settings)
    config.add_argument("--path", action="store_true", help="print only the path of the file")
    config.add_argument("--default", action="store_true", help="print the defaults instead")


def list_all_levels(options: argparse.Namespace) -> int:
    """list the levels that come with the game

    List the levels that come with the game.
    """
    from logical_robots_tui.world import list_shipped, load_level

    levels = [load_level(name) for name in list_shipped()]
    if options.json:
        found = [
            {
                "name": level.name,
                "title": level.title,
                "robots": [robot.name for robot in level.robots],
                "starter": level.starter,
                "teams": [team.name for team in level.teams],
            }
            for level in levels
        ]
        print(json.dumps(found, indent=2))
        return 0
    rows = [(lv.name, lv.title, _who(lv)) for lv in levels]
    print(*columns([("NAME", "TITLE", "ROBOTS"), *rows]), sep="\n")
    return 0


def _who(level: Level) -> str:
    if level.teams:
        return f"teams: {join_names(team.name for team in level.teams)}"
    return join_names(robot.name for robot in level.robots)


def list_all_programs(options: argparse.Namespace) -> int:
    """list the shipped programs and your own

    List the programs that come with the game and those you saved in it.
    """
    from logical_robots_tui.cli.command import own_programs
    from logical_robots_tui.game import list_programs, load_program

    own = own_programs(options)
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


def print_help(options: argparse.Namespace) -> int:
    """explain the functions that a program can use

    Explain the functions, aggregates and operators that a program can use.

    examples:
      logical-robots help               list everything
      logical-robots help ArgMin        explain one of them
      logical-robots help '%'           operators need quotes

    exit status: 0, or 2 if there is no such function
    """
    from logical_robots_tui.language.reference import REFERENCE, find_help, similar

    if options.name is None:
        for kind in ("operator", "aggregate", "function"):
            rows: list[tuple[str, ...]] = [
                (entry.name, entry.summary) for entry in REFERENCE if entry.kind == kind
            ]
            print(f"{kind.capitalize()}s", *(f"  {row}" for row in columns(rows)), "", sep="\n")
        print("logical-robots help NAME explains one, with an example.")
        return 0
    entry = find_help(options.name)
    if entry is None:
        close = similar(options.name)
        hint = f"Did you mean {close}?" if close else "`logical-robots help` lists all functions."
        raise InputError(f"there is no function {options.name}.", hint=hint)
    print(_help_of(entry))
    return 0


def _help_of(entry: FunctionHelp) -> str:
    article = "an" if entry.kind[0] in "ao" else "a"
    return "\n".join(
        [
            entry.signature,
            f"  {entry.summary} ({article} {entry.kind})",
            "",
            f"  {entry.example}",
            f"  gives {entry.result}",
        ]
    )


FINE, WRONG = 0, 2


def print_settings(options: argparse.Namespace) -> int:
    """show the settings and keys, and where to change them

    Print the settings and keys in the format of the configuration file.

    examples:
      logical-robots config             the settings and the keys of all commands
      logical-robots config --path      the path of the configuration file
      logical-robots config --default   the defaults, to start your own file

    exit status: 0 the file is valid, 2 it has errors, which are printed to stderr
    """
    from logical_robots_tui.player.settings import Settings, as_toml, read_settings, settings_path
    from logical_robots_tui.tui.commands.keymap import KeyMap
    from logical_robots_tui.tui.commands.table import COMMANDS

    path = settings_path()
    if options.path:
        print(path)
        return FINE
    settings = Settings() if options.default else read_settings(path, KeyMap(COMMANDS).read)
    what = "settings from" if is_there(path) and not options.default else "defaults, to be put into"
    print(f"# Logical Robots: {what} {harmless(str(path))}", *as_toml(settings), "", sep="\n")
    print(*KeyMap(COMMANDS, settings.keys).as_toml(), sep="\n")
    for complaint in settings.complaints:
        print(harmless(complaint), file=sys.stderr)
    return WRONG if settings.complaints else FINE
