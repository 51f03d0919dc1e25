"""How a labyrinth is to be drawn."""

from __future__ import annotations

from dataclasses import dataclass

from logical_robots_tui.tui.drawing.glyphs import Drawing
from logical_robots_tui.tui.drawing.palette import DARK, Palette

__all__ = ["Look"]


@dataclass(frozen=True, slots=True)
class Look:
    """The choices that a player has about the picture.

    Attributes:
        drawing: Which characters draw it.
        palette: Its colours.
        rays: Whether the robots' radar is shown as light.
        marks: Whether the ends of rays are marked.
        names: Whether names are shown.
        selected: Name of the robot to bring out, or None.
    """

    drawing: Drawing = Drawing.QUADRANTS
    palette: Palette = DARK
    rays: bool = True
    marks: bool = True
    names: bool = True
    selected: str | None = None
