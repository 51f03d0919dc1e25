"""Writing files for the level commands."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import is_there

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

    from logical_robots_tui.world import Level

__all__ = ["add_force", "refuse_existing", "tell_lost", "write"]


def add_force(command: argparse.ArgumentParser) -> None:
    """Add the option ``--force``."""
    command.add_argument("--force", action="store_true", help="replace an existing file")


def refuse_existing(path: Path, *, force: bool) -> None:
    """Refuse to overwrite a file.

    Raises:
        InputError: The file exists and may not be replaced.
    """
    if is_there(path) and not force:
        raise InputError(
            "This file already exists.",
            place=str(path),
            hint="Choose another name, or add --force to replace it.",
        )


def tell_lost(level: Level, path: Path) -> None:
    """Print what the web platform's format could not hold."""
    from logical_robots_tui.editing.level_text import lost_in_web
    from logical_robots_tui.world.levels.load import WEB

    lost = lost_in_web(replace(level, name=path.stem))
    if path.suffix.lower() == WEB and lost:
        print(f"Left out because the web platform does not support it: {', '.join(lost)}.")


def write(path: Path, content: str | bytes) -> None:
    """Write a file in one step.

    Raises:
        InputError: It can't be written.
    """
    from logical_robots_tui.writing import write_atomically

    try:
        write_atomically(path, content)
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"The file can't be written: {reason}.", place=str(path)) from error
