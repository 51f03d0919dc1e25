"""Restricted mode: what this process may do on a shared or public machine.

A Python audit hook enforces it; once set, nothing in this process can remove it. The hook refuses
files outside the player's folder (under any name and through any symbolic link), programs other
than the game's own helpers, and connections. The installed Python and the game itself can be read,
because their modules are loaded while the game runs.
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

MOST_GAMES = 4
"""Games that one player may have open at the same time, of at most three processes each."""

_slots: list[int] = []  # file descriptors; closing one would free the slot

LIMITS = {
    "RLIMIT_AS": 2 * 1024**3,  # bytes of address space; the game needs half of that
    "RLIMIT_CPU": 3 * 3600,  # seconds
    "RLIMIT_FSIZE": 64 * 1024**2,  # bytes of one file
    "RLIMIT_NOFILE": 256,
    "RLIMIT_NPROC": 1024,  # processes and threads of the account
    "RLIMIT_CORE": 0,
}
"""Limits for each process of the game, by their names in Python's module ``resource``."""

_GRACE = 5  # processor seconds that a game over its limit has for a clean exit
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
    """Confine this process and its children to a folder and to `LIMITS`, permanently.

    The folder becomes the home directory. It is created if it is missing.

    Raises:
        InputError: It can't be created or used, or the player has too many games open.
    """
    try:
        own.mkdir(mode=0o700, parents=True, exist_ok=True)
        own = own.resolve()
        _take_slot(own)
    except OSError as error:
        reason = error.strerror or str(error)
        hint = "Tell the administrator of this machine."
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


def _take_slot(own: Path) -> None:
    """Take one of the player's slots for open games, until this process ends.

    Raises:
        InputError: All slots are taken.
        OSError: The folder can't be written to.
    """
    for number in range(MOST_GAMES):
        handle = os.open(own / f".game-{number}", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(handle)
        else:
            _slots.append(handle)
            return
    hint = "Leave one of them first; a game whose connection broke ends within a minute."
    raise InputError(f"you have {MOST_GAMES} games open, the most allowed", hint=hint)


def _limit(which: int, bound: int, grace: int) -> None:
    """Lower the soft and hard limit, unless they are lower already."""
    _, hard = resource.getrlimit(which)
    last = bound + grace if hard == resource.RLIM_INFINITY else min(bound + grace, hard)
    resource.setrlimit(which, (min(bound, last), last))


class _AuditHook:
    """Refuses operations that Python announces, by raising PermissionError."""

    def __init__(self, own: Path) -> None:
        self._own = str(own)
        # Not sys.prefix: that may be /usr, which holds much else.
        code: set[str | Path] = {Path(__file__).parents[1]}
        code |= {
            sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")
        }
        code |= {path for path in sys.path if Path(path).name in _PACKAGES or path.endswith(".zip")}
        code |= {shipped_folder("levels"), shipped_folder("programs")}
        real = {os.path.realpath(os.fspath(folder)) for folder in code if folder}
        # A folder that contains the player's would also contain those of others.
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
            return  # an open file
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
    """Refuse every program except this Python with one of the game's helper modules."""
    if executable == sys.executable and isinstance(words, list | tuple):
        module = words[words.index("-m") + 1] if "-m" in words[:-1] else ""
        if module in _HELPERS:
            return
    raise PermissionError(EACCES, "restricted mode starts no other program")
