"""What a player may do with the machine that the game runs on."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Permissions"]


class Permissions(NamedTuple):
    """Everything on one's own machine; less on a shared or public one, or in a class.

    Attributes:
        programs: Whether other programs may use the terminal: an editor, or the shell after
            suspending.
        clipboard: Whether the game may write to the terminal's clipboard.
        solutions: Whether the solution of a level can be read before it is won.
    """

    programs: bool = True
    clipboard: bool = True
    solutions: bool = True
