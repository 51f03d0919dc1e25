"""Error reports: the player's mistakes on standard error, bugs of ours in a log file."""

from __future__ import annotations

import json
import logging
import platform
import sys
import traceback
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from logical_robots_tui import __version__
from logical_robots_tui.cli.command import harmless
from logical_robots_tui.errors import InputError, LogicalRobotsError, is_out_of_memory

if TYPE_CHECKING:
    from logical_robots_tui.mind import Diagnostic, ProgramError

BAD_INPUT = 2
BUG = 70  # EX_SOFTWARE in sysexits.h


class ProgramFileError(LogicalRobotsError):
    """A program that was read from a file can't be compiled."""

    title = "This program can't run yet"

    def __init__(self, place: str, error: ProgramError) -> None:
        self.place = place
        self.diagnostics: tuple[Diagnostic, ...] = error.diagnostics
        super().__init__(str(error))


def report(error: LogicalRobotsError, *, as_json: bool) -> int:
    """Report a mistake on standard error, with `as_json` also on standard output."""
    if as_json:
        print(json.dumps({"error": _as_data(error)}, indent=2))
    _say(*_lines(error))
    return BAD_INPUT


def report_output(error: OSError) -> int:
    """Report that standard output can't be written; return the exit status."""
    _say(f"can't write to standard output: {error.strerror}.")
    return BAD_INPUT


def report_bug(error: Exception, *, as_json: bool) -> int:
    """Write a bug's traceback to a log file, print its path, and return the exit status."""
    kept = _write_log("".join(traceback.format_exception(error)))
    name = type(error).__name__
    where = f"See {kept} for details" if kept else "The details could not be written to a log file"
    if as_json:
        data = {"kind": "bug", "message": name, "log": str(kept or "")}
        print(json.dumps({"error": data}, indent=2))
    if is_out_of_memory(error):
        _say(f"the game has run out of memory. {where}.")
    else:
        _say(f"this is a bug in the game, not your mistake ({name}). {where}.")
    return BUG


def _as_data(error: LogicalRobotsError) -> dict[str, Any]:
    if isinstance(error, ProgramFileError):
        return {
            "kind": "program",
            "place": error.place,
            "diagnostics": [
                {
                    "line": found.line,
                    "column": found.column,
                    "message": found.message,
                    "hint": found.hint,
                    "excerpt": found.excerpt,
                }
                for found in error.diagnostics
            ],
        }
    if isinstance(error, InputError):
        return {"kind": "input", "place": error.place, "message": error.message, "hint": error.hint}
    return {"kind": "other", "message": str(error)}


def _lines(error: LogicalRobotsError) -> list[str]:
    if not isinstance(error, ProgramFileError):
        return [str(error)]
    lines = []
    for found in error.diagnostics:
        lines.append(f"{error.place}:{found.line}:{found.column}: {found.message}")
        lines += [f"    {more}" for more in (found.excerpt.strip(), found.hint) if more]
    return lines


def _say(head: str, *more: str) -> None:
    lines = f"logical-robots: {harmless(head)}", *map(harmless, more)
    with suppress(OSError):  # the exit status still says it
        print(*lines, sep="\n", file=sys.stderr)


class CrashLog(logging.Handler):
    """Writes each logged bug to its own file, and prints nothing."""

    def emit(self, record: logging.LogRecord) -> None:
        _write_log(self.format(record))


def _write_log(what: str) -> Path | None:
    """Write a new file in the system's log folder; return None if it can't be written."""
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
        folder = _log_folder()
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"crash-{moment:%Y%m%d-%H%M%S-%f}.log"
        path.write_text(text, encoding="utf-8")
    except OSError:
        return None
    return path


def _log_folder() -> Path:
    from platformdirs import user_log_path

    return user_log_path("logical-robots", appauthor=False)
