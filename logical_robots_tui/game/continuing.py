"""Where a player continues, and what progress is kept; shared by the screen and plain mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.reference import is_shipped, level_key
from logical_robots_tui.game.source import (
    DEFAULT_PROGRAM,
    Source,
    load_program,
    shipped_texts,
)
from logical_robots_tui.world import list_levels

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.progress import Progress
    from logical_robots_tui.world import Level

__all__ = [
    "keep_if_own",
    "level_to_begin_with",
    "note_level",
    "program_to_begin_with",
]

_LAST_LEVEL = "level"


def level_to_begin_with(progress: Progress) -> str:
    """Return the shipped level that was played last, or the first one.

    Raises:
        InputError: The levels are missing from the installation.
    """
    names = list_levels()
    if not names:
        raise InputError("The levels are missing from this installation.", hint="Install it again.")
    last = progress.fact(_LAST_LEVEL)
    return last if last in names else names[0]


def note_level(progress: Progress, level: Level) -> None:
    """Record that the player has opened a level."""
    if is_shipped(level):
        progress.set_fact(_LAST_LEVEL, level.name)


def program_to_begin_with(
    progress: Progress, level: Level, named: str | None, own: Path
) -> tuple[Source, str | None]:
    """Return the program to open in a level, and the text last used there if it is to continue.

    Args:
        progress: The player's progress.
        level: The level.
        named: A program's name or path, or None for the level's default.
        own: Folder of the player's programs.

    Raises:
        InputError: The program can't be read.
    """
    source = load_program(named or level.starter or DEFAULT_PROGRAM, own)
    goes_on = named is None and bool(level.starter)
    return source, progress.newest(level_key(level)) if goes_on else None


def keep_if_own(progress: Progress, key: str, text: str) -> None:
    """Keep a program with the level of that key, unless it is a shipped one."""
    if text not in shipped_texts().values():
        progress.keep(key, text)
