"""A Python audit hook that refuses what a process does not need.

It can't be removed. Python and the game stay readable, because modules are loaded late.
Names are followed through symbolic links.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Callable, Iterable
from errno import EACCES
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from logical_robots_tui.confinement import REFUSAL, check_new_folder
from logical_robots_tui.paths import shipped_folder

_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_DEVICES = frozenset(("/dev/null", "/dev/tty", "/dev/urandom"))
_PACKAGES = ("site-packages", "dist-packages", "lib-dynload")
_SYSTEM_PATHS = ("/usr/share/zoneinfo", "/etc/localtime", "/usr/share/terminfo", "/lib/terminfo")
_HIDDEN = (".cache/logical-robots", ".local/state/logical-robots")
"""The game's own folders below a player's; in no other that begins with a dot can it write."""

_CHANGE_EVENTS = frozenset(
    f"os.{name}"
    for name in (
        *("chmod", "chown", "link", "mkdir", "mkfifo", "mknod", "remove", "removexattr", "rename"),
        *("rmdir", "setxattr", "symlink", "truncate", "utime"),
    )
)
_TWO_PATHS = frozenset(("os.rename", "os.link", "os.symlink"))
_LISTING_EVENTS = frozenset(("os.listdir", "os.scandir", "os.chdir"))
_REFUSED_EVENTS = frozenset(
    (
        *("os.exec", "os.fork", "os.forkpty", "os.posix_spawn", "os.spawn", "os.system"),
        *("pty.spawn", "socket.connect", "socket.bind", "socket.sendto", "socket.sendmsg"),
        *("socket.getaddrinfo", "socket.gethostbyaddr", "socket.gethostbyname"),
        *("socket.getnameinfo", "ctypes.dlopen", "sqlite3.load_extension"),
    )
)


def allow_only(
    folder: Path | None,
    may_start: Callable[[object, object], bool] = lambda *_: False,
    places: Iterable[Path] = (),
) -> None:
    """Allow this process only files in a folder, and only some programs, permanently.

    Without a folder only the game and Python can be read. `may_start` gets path and words.
    `places` are files and folders elsewhere that it can write, too.
    """
    sys.addaudithook(_AuditHook(folder, may_start, places))


class _AuditHook:
    """Refuses operations that Python announces, by raising PermissionError."""

    def __init__(
        self,
        root: Path | None,
        may_start: Callable[[object, object], bool],
        places: Iterable[Path],
    ) -> None:
        self._folder = "" if root is None else str(root)
        self._places = tuple(map(os.path.realpath, places))
        self._may_start = may_start
        # Not sys.prefix, which may be /usr, with much else in it.
        code: set[str | Path] = {
            Path(__file__).parents[1],
            *map(sysconfig.get_path, ("stdlib", "platstdlib", "purelib", "platlib")),
            *(shipped_folder("levels"), shipped_folder("programs")),
        }
        code |= {
            path
            for path in sys.path
            if root is None or Path(path).name in _PACKAGES or path.endswith(".zip")
        }
        real_paths = {os.path.realpath(os.fspath(folder)) for folder in code if folder}
        # A folder that contains the player's would also contain those of others.
        self._code_folders = tuple(
            folder
            for folder in (*real_paths, *_SYSTEM_PATHS)
            if not self._folder or not _is_within(self._folder, folder)
        )

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open":
            path, _, flags = arguments
            self._check(path, is_writing=bool(flags & _WRITING))
        elif event == "sqlite3.connect":
            name = os.fsdecode(arguments[0])
            if name not in ("", ":memory:"):
                self._check(unquote(name.removeprefix("file:").partition("?")[0]), is_writing=True)
        elif event in _CHANGE_EVENTS:
            for path in arguments[: 2 if event in _TWO_PATHS else 1]:
                self._check(path, is_writing=True)
            if event == "os.mkdir":
                check_new_folder(arguments[0])
        elif event in _LISTING_EVENTS:
            self._check(arguments[0], is_writing=False)
        elif event == "subprocess.Popen":
            if not self._may_start(arguments[0], arguments[1]):
                raise PermissionError(EACCES, "restricted mode starts no other program")
        elif event in _REFUSED_EVENTS:
            raise PermissionError(EACCES, f"restricted mode has no {event}")

    def _check(self, path: object, *, is_writing: bool) -> None:
        if not isinstance(path, str | bytes | os.PathLike):
            return  # an open file
        real = os.path.realpath(os.fsdecode(path))
        if real in _DEVICES:
            return
        if self._folder and _is_within(real, self._folder):
            if not is_writing or _is_visible(real[len(self._folder) + 1 :]):
                return
        elif not is_writing and any(_is_within(real, folder) for folder in self._code_folders):
            return
        if any(_is_within(real, place) for place in self._places):
            return
        raise PermissionError(EACCES, REFUSAL, str(path))


def _is_within(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder.rstrip(os.sep) + os.sep)


def _is_visible(relative: str) -> bool:
    """Return whether a file is in no hidden folder except those of the game."""
    if not any(part.startswith(".") for part in Path(relative).parts[:-1]):
        return True
    return any(_is_within(relative, folder) or _is_within(folder, relative) for folder in _HIDDEN)
