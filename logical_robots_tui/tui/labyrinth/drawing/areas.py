"""Paints areas: tinted discs with a rim; striped if solid, faint and dotted while switched off."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.palette import RGB
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster
    from logical_robots_tui.world.level import Area

__all__ = ["area_weights", "blend"]


def blend(
    image: Floats,
    window: tuple[slice, slice],
    colour: RGB,
    weights: Floats,
) -> None:
    """Mix a colour into part of an image, with a weight from 0 to 1 for each dot."""
    part = image[window]
    part += (np.array(colour, np.float32) - part) * weights[..., None]


def area_weights(
    raster: Raster, area: Area, active: bool, *, flash: bool = False
) -> tuple[tuple[slice, slice], Floats, Floats] | None:
    """Return how strongly an area colours the floor.

    Args:
        raster: The dots.
        area: The area.
        active: Whether it is switched on.
        flash: Whether to show that this has just changed.

    Returns:
        The window of dots that it touches, the weights of its disc and those of its rim; None if
        it is out of sight.
    """
    radius = min(abs(area.radius), 1e6)
    window = raster.window(area.x - radius, area.x + radius, area.y - radius, area.y + radius)
    if window is None:
        return None
    dx, dy = raster.offsets(window, area.x, area.y)
    distance = np.hypot(dx, dy)
    dot = raster.dot
    disc = np.clip((radius - distance) / dot + 0.5, 0, 1)

    thick = max(1.2 * dot, 1.5)
    rim = np.clip((thick / 2 - np.abs(distance - radius + thick / 2)) / dot + 0.5, 0, 1)
    if flash:
        rim = np.clip((2 * thick - np.abs(distance - radius + thick)) / dot + 0.5, 0, 1)
        return window, disc * (0.5 if active else 0.3), rim * 1.0
    if not active:
        dashes = max(round(2 * math.pi * radius / (6 * dot)), 4)
        rim *= np.sin(np.arctan2(dy, dx) * dashes) > 0
        return window, disc * 0.07, rim * 0.42

    if area.impenetrable:
        # Stripes lie still on the map, so that they don't crawl when the view moves.
        period = max(6.0, 6 * dot)
        x, y = raster.x[window[1]][None, :], raster.y[window[0]][:, None]
        striped = (x + y) / period % 1 < 0.5
        disc *= np.where(striped, 0.62, 0.34).astype(np.float32)
        return window, disc, rim * 0.95
    if area.victory_robots:
        inner = radius - 3 * thick
        second = np.clip((thick / 2 - np.abs(distance - inner)) / dot + 0.5, 0, 1)
        if inner > 3 * dot:
            rim = np.maximum(rim, second * 0.55)
        return window, disc * 0.26, rim * 0.95
    return window, disc * 0.22, rim * 0.8
