"""Paints robots: a disc in their colour with a nose where they are heading."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.areas import blend
from logical_robots_tui.tui.labyrinth.drawing.palette import RGB, Palette, luminance, mix
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster, Viewport
    from logical_robots_tui.world.state import RobotState

__all__ = ["body_rows", "paint_robot", "shows_body", "text_on"]


def shows_body(viewport: Viewport) -> bool:
    """Return whether robots are large enough to see a nose on them."""
    return ROBOT_RADIUS / viewport.units >= 2.2


def body_rows(viewport: Viewport) -> int:
    """Return how many rows a robot's body reaches above and below its own."""
    return round(ROBOT_RADIUS / (2 * viewport.units) - 0.2) if shows_body(viewport) else 0


def paint_robot(
    image: Floats, raster: Raster, robot: RobotState, colour: RGB, palette: Palette
) -> None:
    """Paint the body of a robot.

    Args:
        image: Colours of the dots, changed in place.
        raster: The dots.
        robot: Where it stands.
        colour: Its colour.
        palette: The other colours.
    """
    if not math.isfinite(robot.angle):
        return
    full = shows_body(raster.viewport)
    radius = ROBOT_RADIUS if full else max(ROBOT_RADIUS, 0.9 * raster.dot)
    reach = radius * 1.5
    window = raster.window(robot.x - reach, robot.x + reach, robot.y - reach, robot.y + reach)
    if window is None:
        return
    dx, dy = raster.offsets(window, robot.x, robot.y)
    distance = np.hypot(dx, dy)
    dot = raster.dot
    body = np.clip((radius - distance) / dot + 0.5, 0, 1)
    if not full:
        blend(image, window, colour, body * 0.85)
        return

    shadow = np.clip((radius * 1.4 - distance) / (radius * 0.4), 0, 1)
    blend(image, window, palette.floor, shadow * 0.55)
    blend(image, window, mix(colour, (0, 0, 0), 0.45), body)
    inner = np.clip((radius - max(1.1 * dot, 1.2) - distance) / dot + 0.5, 0, 1)
    blend(image, window, colour, inner)
    cos, sin = math.cos(robot.angle), math.sin(robot.angle)
    ahead, aside = dx * cos + dy * sin, np.abs(dy * cos - dx * sin)
    if radius > 6 * dot:
        nose = np.minimum(ahead + 0.3 * radius, (1.15 * radius - ahead) * 0.33 - aside)
    else:  # Too few dots for a pointer.
        nose = 0.4 * radius - np.hypot(ahead - 0.68 * radius, aside)
    nose = np.clip(nose / dot + 0.5, 0, 1) * body
    blend(image, window, mix(colour, palette.bright, 0.72), nose)


def text_on(colour: RGB) -> RGB:
    """Return black or white, whichever reads better on a colour."""
    return (8, 8, 10) if luminance(colour) > 0.45 else (255, 255, 255)
