"""How a labyrinth is to be drawn."""

from __future__ import annotations

from dataclasses import dataclass

from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.labyrinth.drawing.palette import DARK, Palette

__all__ = ["Highlight", "Look"]


@dataclass(frozen=True, slots=True)
class Highlight:
    """A robot, or one ray of its radar, to bring out of the picture.

    Attributes:
        robot: Its name.
        ray: The angle of the ray as the program reads it, radians; None means the robot itself.
    """

    robot: str
    ray: float | None = None


@dataclass(frozen=True, slots=True)
class Look:
    """The choices that a player has about the picture.

    Attributes:
        drawing: Which characters draw it.
        palette: Its colours.
        rays: Whether the robots' radar is shown as light.
        marks: Whether the ends of rays are marked.
        lines: Whether the rays of the selected robot are drawn one by one.
        trails: Whether the ways that robots came are shown.
        names: Whether names are shown.
        selected: Name of the robot to bring out, or None.
        highlight: A ray or a robot to bring out besides, or None.
        pulse: How far the beacons are in their pulse, 0 to 3; 0 is brightest.
    """

    drawing: Drawing = Drawing.QUADRANTS
    palette: Palette = DARK
    rays: bool = True
    marks: bool = True
    lines: bool = False
    trails: bool = True
    names: bool = True
    selected: str | None = None
    highlight: Highlight | None = None
    pulse: int = 0
