"""What a player may do with the machine that the game runs on."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Permissions"]


class Permissions(NamedTuple):
    """All of it on one's own machine; less on a shared or public one.

    Attributes:
        programs: Whether other programs may have the terminal: an editor, or the shell that
            suspending leads to.
        clipboard: Whether the game may write to the clipboard of the player's terminal.
    """

    programs: bool = True
    clipboard: bool = True
