"""Opening the game in this terminal."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from platformdirs import user_data_path

from logical_robots_tui.game.continuing import level_to_begin_with, program_to_begin_with
from logical_robots_tui.game.source import hide_solutions
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.tui.app.app import LogicalRobotsApp
from logical_robots_tui.tui.app.facts import THEME, TOUR, settings_path
from logical_robots_tui.tui.app.permissions import Permissions
from logical_robots_tui.tui.app.settings import read_settings
from logical_robots_tui.tui.library.progress_recorder import ProgressRecorder
from logical_robots_tui.tui.terminal.capabilities import may_use_mouse
from logical_robots_tui.tui.terminal.crash_report import end_on_hangup
from logical_robots_tui.world import load_level

if TYPE_CHECKING:
    from pathlib import Path


__all__ = ["play"]


def play(
    level_name: str | None = None,
    program: str | None = None,
    data_dir: Path | None = None,
    permissions: Permissions | None = None,
) -> int:
    """Open the game and return when the player leaves.

    Args:
        level_name: A level's name or path; by default the shipped level played last, or the first
            one.
        program: A program's name or path; by default the player's last program for that level, or
            its starter.
        data_dir: Folder with drafts, the player's programs and progress; by default the system's
            data folder.
        permissions: What the player may do and read; by default everything.

    Returns:
        The exit status.

    Raises:
        InputError: The level or the program can't be used.
        Exception: A bug in the game; the terminal has been restored.
    """
    data_dir = data_dir or user_data_path("logical-robots", appauthor=False)
    permissions = permissions or Permissions()
    recorder = ProgressRecorder(data_dir / FILE_NAME)
    if not permissions.solutions:
        hide_solutions(recorder.progress)
    level = load_level(level_name or level_to_begin_with(recorder.progress))
    source, text = program_to_begin_with(recorder.progress, level, program, data_dir / "programs")
    app = LogicalRobotsApp(
        level,
        source,
        data_dir=data_dir,
        recorder=recorder,
        text=text,
        permissions=permissions,
        settings=read_settings(settings_path()),
        theme=recorder.progress.fact(THEME) or "",
        welcome=level_name is None and recorder.progress.fact(TOUR) is None,
    )
    app.suit_terminal()
    put_back = end_on_hangup(app.save_unsaved, app.leave_soon)
    try:
        app.run(mouse=may_use_mouse(os.environ))
    except Exception:
        if app.mistake is None:
            app.save_unsaved()
            raise
    finally:
        put_back()
    if app.mistake is not None:
        raise app.mistake
    return app.return_code or 0
