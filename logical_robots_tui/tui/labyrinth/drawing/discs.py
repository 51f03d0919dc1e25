"""Paints areas and robots as antialiased discs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from logical_robots_tui.tui.labyrinth.drawing.palette import luminance, mix
from logical_robots_tui.world.sensing import ROBOT_RADIUS

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.palette import RGB, Palette
    from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats, Raster, Viewport
    from logical_robots_tui.world.level import Area
    from logical_robots_tui.world.state import RobotState


def blend(
    image: Floats,
    window: tuple[slice, slice],
    colour: RGB,
    weights: Floats,
) -> None:
    """Mix a colour into part of an image; weights are 0 to 1, one per dot."""
    part = image[window]
    part += (np.array(colour, np.float32) - part) * weights[..., None]


def area_weights(
    raster: Raster, area: Area, active: bool, *, flash: bool = False
) -> tuple[tuple[slice, slice], Floats, Floats] | None:
    """Return a window of dots, and an area's disc and rim weights there; None out of sight."""
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
        # Stripes are fixed to the map, so that they don't crawl when the view moves.
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


def shows_body(viewport: Viewport) -> bool:
    return ROBOT_RADIUS / viewport.units >= 2.2


def body_rows(viewport: Viewport) -> int:
    return round(ROBOT_RADIUS / (2 * viewport.units) - 0.2) if shows_body(viewport) else 0


def paint_robot(
    image: Floats, raster: Raster, robot: RobotState, colour: RGB, palette: Palette
) -> None:
    """Paint the body of a robot, in place, into the colours of the dots."""
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
    return (8, 8, 10) if luminance(colour) > 0.45 else (255, 255, 255)
