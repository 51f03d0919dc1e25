"""Opening the game in this terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from platformdirs import user_data_path

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program
from logical_robots_tui.tui.app import LogicalRobotsApp
from logical_robots_tui.tui.crash import end_on_hangup
from logical_robots_tui.world import list_levels, load_level

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["DEFAULT_PROGRAM", "play"]

DEFAULT_PROGRAM = "obstacle-avoider"
"""What the robots think in a level that does not name a program to start with."""


def play(
    level_name: str | None = None, program: str | None = None, data_dir: Path | None = None
) -> int:
    """Open the game and return when the player leaves it.

    Args:
        level_name: A level's name or path; by default the first shipped level.
        program: A program's name or path; by default what the level starts with.
        data_dir: Where drafts and the player's programs are; by default the system's place.

    Returns:
        The exit status.

    Raises:
        InputError: The level or the program can't be used.
        Exception: The game made a mistake of its own; the terminal is in order again.
    """
    data_dir = data_dir or user_data_path("logical-robots", appauthor=False)
    level = load_level(level_name or _first_level())
    own = data_dir / "programs"
    source = load_program(program or level.starter or DEFAULT_PROGRAM, own)
    app = LogicalRobotsApp(level, source, data_dir=data_dir)
    put_back = end_on_hangup(app.last_words, app.leave_soon)
    try:
        app.run()
    finally:
        put_back()
    if app.mistake is not None:
        raise app.mistake
    return app.return_code or 0


def _first_level() -> str:
    names = list_levels()
    if not names:
        raise InputError("The game came without its levels.", hint="Install it again.")
    return names[0]
