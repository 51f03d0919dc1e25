"""What each command does."""

from __future__ import annotations

from logical_robots_tui.tui.commands.looking_actions import LookingActions
from logical_robots_tui.tui.commands.playing_actions import PlayingActions
from logical_robots_tui.tui.commands.writing_actions import WritingActions

__all__ = ["Actions"]


class Actions(PlayingActions, LookingActions, WritingActions):
    """One method for each command, called as the command is."""
