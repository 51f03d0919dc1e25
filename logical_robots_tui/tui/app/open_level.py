"""The level at hand: as it is in its file, as it is edited, and as it is on the screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.editing.edits import Edits
from logical_robots_tui.world.level import alike

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

__all__ = ["OpenLevel"]


class OpenLevel:
    """One level in its three versions, from being opened until the player goes to another one.

    Args:
        level: The level as it was opened.

    Attributes:
        saved: As it is in its file, or as it was made.
        edits: As it is edited, and the way back and forth.
        shown: As it is in the frame on the screen.
    """

    def __init__(self, level: Level) -> None:
        self.saved = self.shown = level
        self.edits = Edits(level)

    @property
    def edited(self) -> Level:
        """The level as it is edited."""
        return self.edits.level

    @property
    def has_changes(self) -> bool:
        """Whether what is edited differs from the file, or from how it was made."""
        return not alike(self.edited, self.saved)

    @property
    def is_saved(self) -> bool:
        """Whether a file says the same as what is edited."""
        return bool(self.saved.source) and not self.has_changes
