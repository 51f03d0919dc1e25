"""A log file for a mistake of our own."""

from __future__ import annotations

import logging
import platform
import sys
import traceback
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from logical_robots_tui import __version__

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["LogKeeper", "keep"]


def keep(error: BaseException, folder: Path | None = None) -> Path | None:
    """Write the traceback of an error to a new file.

    Args:
        error: What happened.
        folder: Where to put the file; by default the system's place for logs.

    Returns:
        The file, or None if it can't be written.
    """
    return _write("".join(traceback.format_exception(error)), folder)


class LogKeeper(logging.Handler):
    """Keeps what the parts log about mistakes of our own, each in a file, and prints nothing."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one record to a new file in the system's place for logs."""
        _write(self.format(record), None)


def _write(what: str, folder: Path | None) -> Path | None:
    moment = datetime.now(UTC)
    text = "\n".join(
        [
            f"logical-robots {__version__}, Python {platform.python_version()}, {sys.platform}",
            moment.isoformat(timespec="seconds"),
            "",
            what,
        ]
    )
    try:
        folder = folder or _log_folder()
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"crash-{moment:%Y%m%d-%H%M%S-%f}.log"
        path.write_text(text, encoding="utf-8")
    except OSError:
        return None
    return path


def _log_folder() -> Path:
    from platformdirs import user_log_path

    return user_log_path("logical-robots", appauthor=False)
