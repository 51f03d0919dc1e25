"""What may lie over the picture of a labyrinth and take the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport

__all__ = ["DrawnOver", "Pointing"]


class Pointing(Protocol):
    """What is told where the mouse points; points are map units."""

    def press(self, x: float, y: float) -> None:
        """The left button went down."""

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        """The mouse is there, perhaps with the button held."""

    def release(self) -> None:
        """The button went up."""

    def open(self) -> None:
        """There were two clicks."""


class DrawnOver(Protocol):
    """What is drawn over the picture, and takes the mouse."""

    @property
    def pointer(self) -> Pointing:
        """What is told of the mouse."""

    @property
    def cursor(self) -> tuple[float, float]:
        """Where the player is at work, map units; zooming keeps it in its place."""

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture."""
