"""What each command does."""

from __future__ import annotations

from logical_robots_tui.tui.looking_actions import LookingActions
from logical_robots_tui.tui.playing_actions import PlayingActions
from logical_robots_tui.tui.writing_actions import WritingActions

__all__ = ["Actions"]


class Actions(PlayingActions, LookingActions, WritingActions):
    """One method for each command, called as the command is."""
