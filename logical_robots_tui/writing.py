"""Writing files so that each is always either the old or the new one."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

__all__ = ["write_atomically"]


def write_atomically(path: Path, text: str | bytes) -> None:
    """Replace a file's content in one step, keeping its permissions.

    What a symbolic link leads to is replaced, not the link; a device or a pipe is written to.

    Args:
        path: The file; its folder must exist.
        text: The new content; text is written as UTF-8, with its line ends as they are.

    Raises:
        OSError: It can't be written; the old content is still there.
    """
    content = text.encode("utf-8") if isinstance(text, str) else text
    if path.exists() and not path.is_file():
        path.write_bytes(content)
        return
    path = path.resolve()
    mode = path.stat().st_mode & 0o777 if path.exists() else 0o644
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(mode)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
