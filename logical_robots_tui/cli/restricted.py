"""Restricted mode: what this process may still do on a shared or public machine.

It is enforced by an audit hook of Python: once set, nothing in this process can remove it. It
refuses files outside of the player's folder (whatever way they are named and through whatever
symbolic link), other programs than the game's own helpers, and connections. Only the installed
Python and the game itself can be read besides, because they are loaded bit by bit while the game
runs.
"""

from __future__ import annotations

import fcntl
import os
import resource
import sys
import sysconfig
from errno import EACCES
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from logical_robots_tui.confinement import WHY, confine
from logical_robots_tui.errors import InputError
from logical_robots_tui.shipped import shipped_folder

__all__ = ["LIMITS", "MOST_GAMES", "restrict"]

MOST_GAMES = 4
"""Games that one player may have open at the same time, each of at most three processes."""

_places: list[int] = []

LIMITS = {
    "RLIMIT_AS": 2 * 1024**3,  # bytes of address space; the game itself needs half of that
    "RLIMIT_CPU": 3 * 3600,  # seconds
    "RLIMIT_FSIZE": 64 * 1024**2,  # bytes of one file
    "RLIMIT_NOFILE": 256,
    "RLIMIT_NPROC": 1024,  # processes and threads of the whole account
    "RLIMIT_CORE": 0,
}
"""Bounds on each process of the game, by their names in Python's module ``resource``."""

_GRACE = 5  # seconds of thinking in which a game that has used up its time ends in good order
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_DEVICES = frozenset(("/dev/null", "/dev/tty", "/dev/urandom"))
_PACKAGES = ("site-packages", "dist-packages", "lib-dynload")
_SYSTEM = ("/usr/share/zoneinfo", "/etc/localtime", "/usr/share/terminfo", "/lib/terminfo")
_CHANGES = frozenset(
    f"os.{name}"
    for name in (
        *("chmod", "chown", "link", "mkdir", "mkfifo", "mknod", "remove", "removexattr", "rename"),
        *("rmdir", "setxattr", "symlink", "truncate", "utime"),
    )
)
_OF_TWO = frozenset(("os.rename", "os.link", "os.symlink"))
_LISTINGS = frozenset(("os.listdir", "os.scandir", "os.chdir"))
_REFUSED = frozenset(
    (
        *("os.exec", "os.fork", "os.forkpty", "os.posix_spawn", "os.spawn", "os.system"),
        *("pty.spawn", "socket.connect", "socket.bind", "socket.sendto", "socket.sendmsg"),
        *("socket.getaddrinfo", "socket.gethostbyaddr", "socket.gethostbyname"),
        *("socket.getnameinfo", "ctypes.dlopen", "sqlite3.load_extension"),
    )
)
_HELPERS = ("logical_robots_tui.game.measuring", "logical_robots_tui.mind.compiling.worker")


def restrict(own: Path) -> None:
    """Keep this process and its children within a folder and within `LIMITS`, for good.

    Everything that is looked for at home is looked for in the folder from now on.

    Args:
        own: The player's folder; made if it is missing.

    Raises:
        InputError: It can't be made or used, or the player has too many games open.
    """
    try:
        own.mkdir(mode=0o700, parents=True, exist_ok=True)
        own = own.resolve()
        _hold_place(own)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Tell those who look after this machine."
        said = f"the player's folder can't be used: {reason}"
        raise InputError(said, place=str(own), hint=hint) from None
    for name in ("VISUAL", "EDITOR", "SHELL", "TMPDIR", "LOGICAL_ROBOTS_CACHE_DIR"):
        os.environ.pop(name, None)
    for name in [name for name in os.environ if name.startswith("XDG_")]:
        del os.environ[name]
    os.environ["HOME"] = str(own)
    os.chdir(own)
    for name, bound in LIMITS.items():
        _limit(getattr(resource, name), bound, grace=_GRACE if name == "RLIMIT_CPU" else 0)
    confine(own, shipped_folder("levels"), shipped_folder("programs"))
    sys.addaudithook(_AuditHook(own))


def _hold_place(own: Path) -> None:
    """Take one of the places that a player has, until this process ends.

    Raises:
        InputError: There is none left.
        OSError: The folder can't be written to.
    """
    for number in range(MOST_GAMES):
        handle = os.open(own / f".game-{number}", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
        else:
            _places.append(handle)
            return
    hint = "Leave one of them first; one whose connection broke ends by itself within a minute."
    raise InputError(f"you have {MOST_GAMES} games open, and that is the most", hint=hint)


def _limit(which: int, bound: int, grace: int) -> None:
    """Lower a limit, and the one that can't be raised again; one that is lower already stays."""
    _, hard = resource.getrlimit(which)
    last = bound + grace if hard == resource.RLIM_INFINITY else min(bound + grace, hard)
    resource.setrlimit(which, (min(bound, last), last))


class _AuditHook:
    """Refuses, by raising PermissionError, what Python announces before it does it."""

    def __init__(self, own: Path) -> None:
        self._own = str(own)
        # Not sys.prefix: that may be /usr, with much that is nobody's business.
        code: set[str | Path] = {Path(__file__).parents[1]}
        code |= {
            sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")
        }
        code |= {path for path in sys.path if Path(path).name in _PACKAGES or path.endswith(".zip")}
        code |= {shipped_folder("levels"), shipped_folder("programs")}
        real = {os.path.realpath(os.fspath(folder)) for folder in code if folder}
        # A folder that holds the player's would give everybody's away.
        self._code = tuple(
            folder for folder in (*real, *_SYSTEM) if not _is_within(self._own, folder)
        )

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open":
            path, _, flags = arguments
            self._check(path, writing=bool(flags & _WRITING))
        elif event == "sqlite3.connect":
            self._check_database(arguments[0])
        elif event in _CHANGES:
            for path in arguments[: 2 if event in _OF_TWO else 1]:
                self._check(path, writing=True)
        elif event in _LISTINGS:
            self._check(arguments[0], writing=False)
        elif event == "subprocess.Popen":
            _check_program(arguments[0], arguments[1])
        elif event in _REFUSED:
            raise PermissionError(EACCES, f"restricted mode has no {event}")

    def _check(self, path: object, *, writing: bool) -> None:
        if not isinstance(path, str | bytes | os.PathLike):
            return  # a file that is open already
        real = os.path.realpath(os.fsdecode(path))
        if _is_within(real, self._own) or real in _DEVICES:
            return
        if writing or not any(_is_within(real, folder) for folder in self._code):
            raise PermissionError(EACCES, WHY, str(path))

    def _check_database(self, name: str | bytes | os.PathLike[str]) -> None:
        text = os.fsdecode(name)
        if text not in ("", ":memory:"):
            self._check(unquote(text.removeprefix("file:").partition("?")[0]), writing=True)


def _is_within(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)


def _check_program(executable: object, words: object) -> None:
    """Refuse every program but this Python with one of the game's own modules."""
    if executable == sys.executable and isinstance(words, list | tuple):
        module = words[words.index("-m") + 1] if "-m" in words[:-1] else ""
        if module in _HELPERS:
            return
    raise PermissionError(EACCES, "restricted mode starts no other program")
