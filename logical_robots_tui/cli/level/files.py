"""Files that the commands on levels write."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

__all__ = ["add_force", "refuse_existing", "write"]


def add_force(command: argparse.ArgumentParser) -> None:
    """Add the option that allows to replace a file."""
    command.add_argument("--force", action="store_true", help="replace a file that is there")


def refuse_existing(path: Path, *, force: bool) -> None:
    """Refuse to write over a file.

    Raises:
        InputError: The file is there and may not be replaced.
    """
    if path.exists() and not force:
        raise InputError(
            "This file is there already.",
            place=str(path),
            hint="Choose another name, or add --force to replace it.",
        )


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
