"""Overlays on the picture of a labyrinth that receive the mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.cells import Cells
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Look
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Viewport

__all__ = ["DrawnOver", "Pointing"]


class Pointing(Protocol):
    """Receives the mouse; points are map units."""

    def press(self, x: float, y: float) -> None:
        """The left button was pressed."""

    def hover(self, x: float, y: float, *, is_held: bool) -> None:
        """The mouse moved, perhaps with the button held."""

    def release(self) -> None:
        """The button was released."""

    def open(self) -> None:
        """There was a double click."""


class DrawnOver(Protocol):
    """Draws over the picture, and receives the mouse."""

    @property
    def pointer(self) -> Pointing:
        """Receives the mouse."""

    @property
    def cursor(self) -> tuple[float, float]:
        """The player's cursor in map units; zooming keeps it in place."""

    def paint(self, cells: Cells, view: Viewport, look: Look) -> None:
        """Draw over a picture."""
