"""``logical-robots play``: open the game in this terminal."""

from __future__ import annotations

import argparse
import os
import re
import sys
from datetime import date
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli.command import (
    Commands,
    add_data_dir,
    add_no_solutions,
    add_programs,
    add_start,
    folder_of,
    is_set,
    new_command,
)
from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_folder
from logical_robots_tui.processes.helper import collect_later

if TYPE_CHECKING:
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.player.open_games import OpenGames
    from logical_robots_tui.player.recorder import ProgressRecorder

SIZES = ("small", "medium", "large")


def declare(commands: Commands) -> None:
    command = new_command(commands, "play", start)
    command.add_argument("level", nargs="?", metavar="LEVEL", help="a level's name or file")
    add_programs(command, nargs="*")
    command.add_argument(
        "--daily",
        nargs="?",
        metavar="DATE",
        type=_day,
        const=_day("today"),
        help="play the labyrinth of a day, which everybody has; LEVEL is left out",
    )
    command.add_argument(
        "--size", choices=SIZES, default=SIZES[1], help="of the labyrinth of the day"
    )
    add_start(command)
    command.add_argument(
        "--plain",
        action="store_true",
        default=os.environ.get("SSH_ORIGINAL_COMMAND") == "plain",
        help="play in lines of text: type commands, read one line per event",
    )
    add_data_dir(command)
    command.add_argument(
        "--player",
        metavar="NAME",
        type=_player,
        default=os.environ.get("LOGICAL_ROBOTS_PLAYER"),
        help="the player's name, where many share an account; each gets a folder",
    )
    command.add_argument(
        "--restricted",
        action="store_true",
        default=is_set("LOGICAL_ROBOTS_RESTRICTED"),
        help="for shared machines: only your own files, no other programs, limited resources",
    )
    add_no_solutions(command)
    command.add_argument(
        "--allow-clipboard",
        action="store_true",
        help="let the restricted game write to your terminal's clipboard",
    )


def start(options: argparse.Namespace) -> int:
    """open the game in this terminal

    Open the game in this terminal.

    examples:
      logical-robots play                  continue, or start the first level
      logical-robots play 02-open-space    play another level
      logical-robots play my-level.toml my-program.l
      logical-robots play 13-high-ground --team blue=my-program.l
      logical-robots play --daily          play the labyrinth of today
      logical-robots play --plain          play in lines of text, also in a pipe:
      echo run | logical-robots play 01-first-steps first-steps --plain

    exit status: 0 after quitting, 2 if the game can't be opened
    """
    if options.restricted:
        from logical_robots_tui.cli.restricted import clear_environment

        clear_environment()
    if not options.plain:
        _prepare_screen()
    if options.restricted and not options.player:
        _refuse_shared_folder(folder_of(options.data_dir))
    options.data_dir = folder_of(options.data_dir, options.player)
    if options.daily is not None:
        _choose_daily(options)
    home = f"logical_robots_tui.{'cli.plain' if options.plain else 'tui.app.app'}"
    games = _restrict(options, home) if options.restricted else None
    recorder = _recorder(options)
    from logical_robots_tui.player.opening import open_game
    from logical_robots_tui.player.session_state import Permissions

    opening = open_game(
        recorder.progress,
        options.data_dir,
        options.level,
        options.programs,
        dict(options.teams),
        start=options.start_number,
        permissions=Permissions(
            programs=not options.restricted,
            clipboard=not options.restricted or options.allow_clipboard,
        ),
        games=games,
    )
    status: int = import_module(home).play(opening, recorder)
    return status


def play_replay(options: argparse.Namespace, replay: Replay) -> int:
    """Open a replay on the screen; raise InputError if there is no terminal."""
    _prepare_screen()
    from logical_robots_tui.player.opening import open_replay
    from logical_robots_tui.tui.app.app import play

    options.data_dir = folder_of(options.data_dir)
    return play(open_replay(replay, options.data_dir), _recorder(options))


def _recorder(options: argparse.Namespace) -> ProgressRecorder:
    """Open the player's record, and hide solutions if that is wanted."""
    from logical_robots_tui.game.source import hide_solutions
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.progress import FILE_NAME

    recorder = ProgressRecorder(options.data_dir / FILE_NAME)
    if options.no_solutions:
        hide_solutions(recorder.progress)
    return recorder


def _choose_daily(options: argparse.Namespace) -> None:
    """Take the labyrinth of the day as the level, or raise InputError."""
    from logical_robots_tui.player.continuing import daily_level
    from logical_robots_tui.progress import FILE_NAME, Progress

    if options.programs:
        raise InputError("--daily is the level; name a program at most, not two things.")
    progress = Progress(options.data_dir / FILE_NAME)
    try:
        level = daily_level(progress, options.daily, options.size)
    finally:
        progress.close()
    options.programs = [options.level] if options.level else []
    options.level = level.name


def _refuse_shared_folder(folder: Path) -> None:
    """Raise InputError if the folder contains folders of named players."""
    if is_folder(folder_of(folder, ".")):
        raise InputError(
            "no player is named, and this folder contains the folders of players",
            place=str(folder),
            hint="Add --player NAME, or set LOGICAL_ROBOTS_PLAYER=NAME in the environment.",
        )


def _restrict(options: argparse.Namespace, game: str) -> OpenGames:
    """Load the game, then restrict this process: afterwards no library can be loaded."""
    from logical_robots_tui.cli.restricted import restrict

    import_module(game)
    options.data_dir = options.data_dir.absolute()
    return restrict(options.data_dir)


def _prepare_screen() -> None:
    """Set up the environment for the screen; raise InputError if there is no terminal."""
    streams = (sys.stdin, sys.stdout, sys.stderr)
    if not all(stream.isatty() for stream in streams) or os.environ.get("TERM") == "dumb":
        raise InputError(
            "the game needs a terminal.",
            hint="Without one: logical-robots play --plain, or: logical-robots run LEVEL PROGRAM",
        )
    from logical_robots_tui.tui.terminal.capabilities import assume_colours

    assume_colours(os.environ)
    # The terminal knows its size better than a shell that once exported it.
    for name in ("COLUMNS", "LINES"):
        os.environ.pop(name, None)
    # Text about a tick appears at most this long after its picture; Textual's default is 60.
    os.environ.setdefault("TEXTUAL_FPS", "120")
    collect_later()  # after the first picture


def _day(text: str) -> date:
    if text == "today":
        return date.today()
    try:
        return date.fromisoformat(text)
    except ValueError:
        message = f"{text!r} is not a date such as 2026-11-22; a program comes before --daily"
        raise argparse.ArgumentTypeError(message) from None


def _player(text: str) -> str:
    """Accept a name that is valid as a folder name; a teacher chooses it, not the player."""
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,31}", text):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a name of at most 32 letters, digits and _ . -"
        )
    return text
