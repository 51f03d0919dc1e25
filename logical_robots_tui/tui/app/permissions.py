"""What a player may do with the machine that the game runs on."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Permissions"]


class Permissions(NamedTuple):
    """Everything on one's own machine; less on a shared or public one.

    Attributes:
        programs: Whether other programs may use the terminal: an editor, or the shell after
            suspending.
        clipboard: Whether the game may write to the terminal's clipboard.
    """

    programs: bool = True
    clipboard: bool = True
