"""Writing files atomically."""

from __future__ import annotations

import fcntl
import os
import re
from contextlib import suppress
from pathlib import Path

from logical_robots_tui.confinement import check_name, check_quota
from logical_robots_tui.paths import is_file, is_there, real

_TEMPORARY = re.compile(r"\.(.+)\.[0-9a-f]{8}")


def write_atomically(path: Path, text: str | bytes) -> None:
    """Replace a file's content in one step, keeping its permissions, or raise OSError.

    The folder must exist. Follows a symbolic link, and writes directly to a device or a pipe.
    Text is written as UTF-8 with its line ends; on an error the old content is intact.
    """
    content = text.encode("utf-8") if isinstance(text, str) else text
    if is_there(path) and not is_file(path):
        path.write_bytes(content)
        return
    path = real(path)
    check_name(path)
    check_quota(path, len(content))
    temporary, handle = _open_beside(path)
    try:
        with os.fdopen(handle, "wb") as file:
            if path.exists():
                os.fchmod(handle, path.stat().st_mode & 0o777)
            file.write(content)
            file.flush()
            os.fsync(handle)
            temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    _sweep(path)


def _open_beside(path: Path) -> tuple[Path, int]:
    """Create a temporary file in the same folder, locked while it is being written."""
    while True:
        temporary = path.with_name(f".{path.name}.{os.urandom(4).hex()}")
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        with suppress(OSError):  # a file system without locks
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.fstat(handle).st_nlink:
            return temporary, handle
        os.close(handle)  # removed before it was locked


def _sweep(path: Path) -> None:
    """Remove temporary files in this folder that killed processes left behind."""
    with suppress(OSError):
        for name in os.listdir(path.parent):  # noqa: PTH208 - names are looked at first
            found = _TEMPORARY.fullmatch(name)
            if found and (found[1] == path.name or (path.parent / found[1]).exists()):
                _remove_if_left(path.parent / name)


def _remove_if_left(temporary: Path) -> None:
    with suppress(OSError):
        handle = os.open(temporary, os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)  # fails while another process writes
            temporary.unlink()
        finally:
            os.close(handle)
