"""Writing files so that each is always either the old or the new one."""

from __future__ import annotations

import os
from secrets import token_hex
from typing import TYPE_CHECKING

from logical_robots_tui.paths import is_file, is_there, real

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["write_atomically"]


def write_atomically(path: Path, text: str | bytes) -> None:
    """Replace a file's content in one step, keeping its permissions.

    What a symbolic link leads to is replaced, not the link; a device or a pipe is written to.

    Args:
        path: The file; its folder must exist. A new one gets the permissions that are usual here.
        text: The new content; text is written as UTF-8, with its line ends as they are.

    Raises:
        OSError: It can't be written; the old content is still there.
    """
    content = text.encode("utf-8") if isinstance(text, str) else text
    if is_there(path) and not is_file(path):
        path.write_bytes(content)
        return
    path = real(path)
    temporary = path.with_name(f".{path.name}.{token_hex(4)}")
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
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
