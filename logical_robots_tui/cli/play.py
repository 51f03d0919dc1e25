"""``logical-robots play`` and ``serve``: open the game in this terminal or in a browser."""

from __future__ import annotations

import argparse
import mimetypes
import os
import pwd
import re
import resource
import site
import sys
from collections.abc import Iterable
from contextlib import closing
from datetime import date
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.cli import command
from logical_robots_tui.cli.command import folder_of, is_set
from logical_robots_tui.errors import InputError, check_installed
from logical_robots_tui.paths import PLAYER_NAME, is_folder, shipped_folder
from logical_robots_tui.processes.helper import collect_later, is_helper, share_heap

if TYPE_CHECKING:
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.recovery import OpenGames
    from logical_robots_tui.progress.board import Board

FRAMES_A_SECOND = "120"
"""For Textual: text about a tick appears at most this long after its picture. Its default is 60."""

SIZES = ("small", "medium", "large")


def _day(text: str) -> date:
    if text == "today":
        return date.today()
    try:
        return date.fromisoformat(text)
    except ValueError:
        message = f"{text!r} is not a date such as 2026-11-22; a program comes before --daily"
        raise argparse.ArgumentTypeError(message) from None


def _player(text: str) -> str:
    if not PLAYER_NAME.fullmatch(text):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a name of at most 32 letters, digits and _ . -"
        )
    return text


@command.declare(
    "play",
    command.option("level", "LEVEL", "a level's name or file", nargs="?"),
    command.programs("*"),
    command.option(
        "--daily",
        "DATE",
        "play the labyrinth of a day, which everybody has; LEVEL is left out",
        nargs="?",
        type=_day,
        const="today",
    ),
    command.option(
        "--size", None, "the size of the labyrinth of the day", choices=SIZES, default=SIZES[1]
    ),
    command.START,
    command.flag(
        "--plain",
        "play in lines of text: type commands, read one line per event",
        lambda: os.environ.get("SSH_ORIGINAL_COMMAND") == "plain",
    ),
    command.DATA_DIR,
    command.option(
        "--player",
        "NAME",
        "the player's name, where many share an account; each gets a folder",
        type=_player,
        default=lambda: os.environ.get("LOGICAL_ROBOTS_PLAYER"),
    ),
    command.flag(
        "--restricted",
        "for shared computers: only your own files, no other programs, limited resources",
        lambda: is_set("LOGICAL_ROBOTS_RESTRICTED"),
    ),
    command.NO_SOLUTIONS,
    command.flag("--allow-clipboard", "let the restricted game write to your terminal's clipboard"),
    command.option("--host", "FOLDER", "start sooner, from the host at work there"),  # `supervisor`
    command.BOARD,
    command.flag("--class", "let the teacher see what you do, with --board", dest="is_class"),
)
def play(options: argparse.Namespace) -> int:
    """open the game in this terminal

    Open the game in this terminal.

    examples:
      logical-robots play                  continue, or start the first level
      logical-robots play 02-open-space    play another level
      logical-robots play my-level.toml my-program.l
      logical-robots play 16-high-ground --team blue=my-program.l
      logical-robots play --daily          play the labyrinth of today
      logical-robots play --plain          play in lines of text, also in a pipe:
      echo run | logical-robots play 01-first-steps first-steps --plain

    exit status: 0 after quitting, 2 if the game can't be opened
    """
    if options.restricted:
        clear_environment()
    if not options.plain:
        prepare_screen()
    if options.restricted and not options.player:
        folder = folder_of(options.data_dir)
        if is_folder(folder_of(folder, ".")):
            raise InputError(
                "No player is named, and this folder contains the folders of players",
                place=str(folder),
                hint="Add --player NAME, or set LOGICAL_ROBOTS_PLAYER=NAME in the environment.",
            )
    options.data_dir = folder_of(options.data_dir, options.player)
    if options.daily is not None:
        _choose_daily(options)
    home = f"logical_robots_tui.{'cli.plain' if options.plain else 'tui.app.app'}"
    games, board = None, _open_board(options)
    if options.restricted:
        import_module(home)  # afterwards no library can be loaded
        if not mimetypes.inited:  # as in a game that a host has forked
            mimetypes.init(())  # a download would read tables of the system
        options.data_dir = options.data_dir.absolute()
        games = restrict(options.data_dir, board.places if board is not None else ())
    recorder = _recorder(options)
    from logical_robots_tui.player.opening import Permissions, open_game

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
        board=board,
        is_class=options.is_class,
    )
    status: int = import_module(home).play(opening, recorder)
    return status


def _open_board(options: argparse.Namespace) -> Board | None:
    """Return the board of the player, made if it is missing; raise InputError without a name."""
    if options.board is None:
        if options.is_class:
            hint = "Add --board FOLDER."
            raise InputError("--class tells the board what a player does", hint=hint)
        return None
    from logical_robots_tui.progress.board import Board

    board = Board(options.board.absolute(), options.player or _account())
    board.create()
    return board


def _account() -> str:
    return re.sub(r"^[.-]|[^A-Za-z0-9_.-]", "_", pwd.getpwuid(os.getuid()).pw_name)[:32]


def _base_path(text: str) -> str:
    path = text.strip("/")
    if not re.fullmatch(r"[\w.~/-]*", path):
        raise argparse.ArgumentTypeError(f"{text!r} is not a path such as /robots")
    return f"/{path}" if path else ""


_CLASS_PORT = 8000
_MOST_GAMES = 15 * (os.cpu_count() or 1)
_NO_TLS = (
    "Without TLS, whoever reads along in the network can play as any player. "
    "Put a proxy with TLS in front, as docs/web.md tells."
)


@command.declare(
    "serve",
    command.until_interrupted,
    command.option("level", "LEVEL", "a level's name or file", nargs="?"),
    command.option("program", "PROGRAM", "a program's name or file", nargs="?"),
    command.option("--class", "FILE", "serve the players in this file", dest="players", type=Path),
    command.one_of(
        command.option(
            "--add", "NAME", "add a player to the class and print the secret link", type=_player
        ),
        command.option("--revoke", "NAME", "remove a player from the class", type=_player),
    ),
    command.option(
        "--url",
        "URL",
        "the address in links, if players reach a proxy",
        type=lambda text: f"{text.rstrip('/')}/",
    ),
    command.number("--games", command.number_from(1), _MOST_GAMES, "the most games at once"),
    command.option(
        "--host", "HOST", "where to listen, with --class (default: 127.0.0.1)", default="127.0.0.1"
    ),
    command.option(
        "--port", "N", f"the port (default: any that is free, with --class {_CLASS_PORT})", type=int
    ),
    command.option(
        "--base-path",
        "PATH",
        "the beginning of all paths, such as /robots behind a proxy",
        type=_base_path,
        default="",
    ),
    command.flag("--no-open", "print the address only, without opening a browser"),
    command.DATA_DIR,
    command.BOARD,
    command.NO_SOLUTIONS,
)
def serve(options: argparse.Namespace) -> int:
    """play in a browser on this computer, or let a class play

    Play in a browser on this computer, with your own files, until ^C.
    Whoever has the printed address can play as you; nobody else can.
    With --class, each player has a secret link, a folder and restricted games.

    examples:
      logical-robots serve                  open the game in the browser
      logical-robots serve 02-open-space --no-open
      logical-robots serve --class players.toml --add ada
      logical-robots serve --class players.toml

    exit status: 0 after ^C, 2 if the page can't be served
    """
    for library in ("aiohttp", "textual_serve"):
        check_installed(library, "A browser", "'logical-robots-tui[web]'")
    import webbrowser
    from threading import Thread

    from logical_robots_tui.web.players import Players, digest_of, new_token
    from logical_robots_tui.web.server import GameServer, is_loopback
    from logical_robots_tui.web.server import serve as serve_pages

    is_class = options.players is not None
    port = options.port if options.port is not None else _CLASS_PORT * is_class
    host = f"[{options.host}]" if ":" in options.host else options.host

    def address(port: int) -> str:
        return options.url or f"http://{host}:{port}{options.base_path}/"

    if options.add or options.revoke:
        return _change_class(options, address(port))
    words = [word for word in (options.level, options.program) if word is not None]
    if options.data_dir is not None:
        words += ["--data-dir", str(options.data_dir)]
    if options.no_solutions:
        words.append("--no-solutions")
    if options.board is not None:
        words += ["--board", str(options.board.absolute()), *["--class"] * is_class]
    is_local, token = is_loopback(options.host), new_token()
    if is_class:
        words += ["--restricted", "--allow-clipboard"]  # that of the player's browser
        digests = Players(options.players, partial(print, file=sys.stderr)).digests
        if not is_local:
            print(_NO_TLS, file=sys.stderr)
    elif is_local:
        digests = {"": digest_of(token)}.copy
    else:
        hint = "Leave out --host, or serve a class: --class FILE."
        raise InputError(f"{options.host} is open to other computers", hint=hint)

    def announce(port: int) -> None:
        if is_class:
            print(f"Serving a class at {address(port)} with {options.games} games.", flush=True)
            return
        link = f"{address(port)}#{token}"
        print(f"Playing at {link}\n^C ends the game; unsaved text is kept.", flush=True)
        # Without a desktop it would be a browser in this terminal.
        has_desktop = sys.platform == "darwin" or {"DISPLAY", "WAYLAND_DISPLAY"} & {*os.environ}
        if has_desktop and not options.no_open:
            Thread(target=webbrowser.open, args=(link,), daemon=True).start()

    try:
        server = GameServer(words, digests, limit=options.games, base_path=options.base_path)
        serve_pages(server, options.host, port, announce)
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"Port {port} can't be used: {reason}") from None
    return 0


def _change_class(options: argparse.Namespace, url: str) -> int:
    """Revoke a player, or add one and print the link."""
    from logical_robots_tui.web.players import change_player, new_token

    file, name = options.players, options.revoke or options.add
    if file is None:
        raise InputError("--add and --revoke need the file of the class", hint="Add --class FILE.")
    token = None if options.revoke else new_token()
    try:
        is_known = change_player(file, name, token)
    except OSError as error:
        raise InputError(f"can't be changed: {error.strerror}", place=str(file)) from None
    if token is None and not is_known:
        raise InputError(f"has no player {name}", place=str(file))
    if is_known:
        print(f"The link that {name} had is no longer valid.", file=sys.stderr)
    if token is not None:
        print(f"{url}#{token}")
    return 0


@command.declare(
    "host",
    command.until_interrupted,
    command.option("folder", "FOLDER", "where games look for it", type=Path),
    command.BOARD,
)
def host(options: argparse.Namespace) -> int:
    """let the games of a shared computer start sooner

    Keep the game loaded, and fork a copy for each player who starts `play --host FOLDER`.
    Where no host answers, games start without it. With --board, the ladder of that board is
    at work as well.

    examples:
      logical-robots host ./host
      logical-robots host ./host --board ./board
      logical-robots play --restricted --player ada --host ./host

    exit status: 0 after ^C, 2 if FOLDER can't be used
    """
    from logical_robots_tui.processes.hosting import GameHost, listen
    from logical_robots_tui.tui.terminal.capabilities import assume_browser

    os.environ["TEXTUAL_FPS"] = FRAMES_A_SECOND
    assume_browser(os.environ, None)  # whose terminal is like most players'
    games = GameHost(listen(options.folder))
    if options.board is not None:
        games.companions.append(_start_ladder(options.board))
    games.warm_up(lambda: import_module("logical_robots_tui.tui.app.app").rehearse())
    print(f"Games that are started with --host {options.folder} are forked.", flush=True)
    words = games.serve()
    return int(import_module("logical_robots_tui.cli.main").main(words))


def _start_ladder(board: Path) -> int:
    """Start the ladder of a board; return the end of a pipe that keeps it running while open."""
    import subprocess

    from logical_robots_tui.processes.lifeline import LIFELINE

    read_end, write_end = os.pipe()
    subprocess.Popen(  # noqa: S603 - our own command
        [sys.executable, "-m", "logical_robots_tui", "ladder", str(board.absolute())],
        stdin=subprocess.DEVNULL,
        env=os.environ | {LIFELINE: str(read_end)},
        pass_fds=[read_end],
        start_new_session=True,
    )
    os.close(read_end)
    return write_end


def play_replay(options: argparse.Namespace, replay: Replay) -> int:
    """Open a replay on the screen; raise InputError if there is no terminal."""
    prepare_screen()
    from logical_robots_tui.player.opening import open_replay
    from logical_robots_tui.tui.app import app

    options.data_dir = folder_of(options.data_dir)
    return app.play(open_replay(replay, options.data_dir), _recorder(options))


def _recorder(options: argparse.Namespace) -> ProgressRecorder:
    """Open the player's record; hide solutions with --no-solutions."""
    from logical_robots_tui.game.source import hide_solutions
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.progress import FILE_NAME

    recorder = ProgressRecorder(options.data_dir / FILE_NAME)
    if options.no_solutions:
        hide_solutions(recorder.progress)
    return recorder


def _choose_daily(options: argparse.Namespace) -> None:
    """Take the labyrinth of the day as the level, or raise InputError."""
    from logical_robots_tui.player.library import daily_level
    from logical_robots_tui.progress import FILE_NAME, Progress

    if options.programs:
        raise InputError("--daily chooses the level: give at most the name of a program.")
    with closing(Progress(options.data_dir / FILE_NAME)) as progress:
        level = daily_level(progress, options.daily, options.size)
    options.programs = [options.level] if options.level else []
    options.level = level.name


def prepare_screen() -> None:
    """Set up the environment for the screen; raise InputError if there is no terminal."""
    from logical_robots_tui.tui.terminal.capabilities import (
        assume_browser,
        assume_colours,
        replace_unwritable,
    )

    share_heap()
    os.environ.setdefault("TEXTUAL_FPS", FRAMES_A_SECOND)
    if os.environ.get("TEXTUAL_DRIVER"):
        assume_browser(os.environ, sys.__stderr__)
        collect_later()  # after the first picture
        return
    streams = {"input": sys.stdin, "output": sys.stdout, "error": sys.stderr}
    missing = [name for name, stream in streams.items() if not stream.isatty()]
    if missing or os.environ.get("TERM") == "dumb":
        is_partial = 0 < len(missing) < len(streams)
        raise InputError(
            "The game needs a terminal"
            + (f" for standard {' and '.join(missing)} too." if is_partial else "."),
            hint="Without one: logical-robots play --plain, or: logical-robots run LEVEL PROGRAM",
        )
    assume_colours(os.environ)
    replace_unwritable(sys.__stderr__)  # to which the screen is written
    # The terminal knows its size better than a shell that once exported it.
    for name in ("COLUMNS", "LINES"):
        os.environ.pop(name, None)
    collect_later()  # after the first picture


LIMITS = {
    "RLIMIT_AS": 2 * 1024**3,  # bytes of address space; the game needs half of that
    "RLIMIT_CPU": 3 * 3600,  # seconds
    "RLIMIT_FSIZE": 64 * 1024**2,  # bytes of one file
    "RLIMIT_NOFILE": 256,
    "RLIMIT_NPROC": 1024,  # processes and threads of the account
    "RLIMIT_CORE": 0,
}
"""Limits for each process of the game, by their names in Python's module ``resource``."""

_ALLOWED_VARIABLES = frozenset(
    (
        *("COLORTERM", "HOME", "LANG", "LANGUAGE", "NO_COLOR", "PATH", "SSH_CONNECTION", "STY"),
        *("TERM", "TMUX", "TZ", "XDG_DATA_HOME", "OPENBLAS_NUM_THREADS"),
        *("DYLD_LIBRARY_PATH", "LD_LIBRARY_PATH"),
    )
)
"""Environment variables that are left, beside those of the language."""

_WEB_DRIVER = "textual.drivers.web_driver:WebDriver"
_BROWSER_VARIABLES = frozenset(("COLUMNS", "ROWS", "TERM_PROGRAM", "TEXTUAL_DRIVER"))
"""Left as well where a web server has started the game; no other driver is loaded."""

_GRACE = 5  # processor seconds that a game over its limit has for a clean exit


def clear_environment() -> None:
    """Remove variables that affect Python, Textual or an editor, before they are loaded.

    Raises InputError if Python would load modules from the player's home folder.
    """
    if site.ENABLE_USER_SITE:
        raise InputError(
            "Restricted mode needs a Python that loads no packages from home folders",
            hint="Install the game in a virtual environment, or set PYTHONNOUSERSITE=1.",
        )
    is_served = os.environ.get("TEXTUAL_DRIVER") == _WEB_DRIVER
    allowed = _ALLOWED_VARIABLES | (_BROWSER_VARIABLES if is_served else frozenset())
    for name in [*os.environ]:
        if name not in allowed and not name.startswith("LC_"):
            del os.environ[name]


def restrict(folder: Path, places: Iterable[Path] = ()) -> OpenGames:
    """Confine this process and its children to a folder and to `LIMITS`, permanently.

    The folder becomes the home directory, and is created if missing. `places` can be written as
    well, but not by what the player names. Returns the player's open games; raises InputError if
    there are too many, or the folder can't be used.
    """
    from logical_robots_tui.confinement import confine
    from logical_robots_tui.player.recovery import OpenGames
    from logical_robots_tui.processes.audit import allow_only

    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder = folder.resolve()
        games = OpenGames(folder)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Tell the administrator of this computer."
        message = f"The player's folder can't be used: {reason}"
        raise InputError(message, place=str(folder), hint=hint) from None
    os.environ.pop("XDG_DATA_HOME", None)
    os.environ["HOME"] = str(folder)
    os.chdir(folder)
    for name, bound in LIMITS.items():
        kind, maximum = getattr(resource, name), bound + _GRACE * (name == "RLIMIT_CPU")
        _, hard = resource.getrlimit(kind)
        if hard != resource.RLIM_INFINITY:
            maximum = min(maximum, hard)
        resource.setrlimit(kind, (min(bound, maximum), maximum))
    confine(folder, shipped_folder("levels"), shipped_folder("programs"))
    allow_only(folder, is_helper, places)
    return games
