"""Where rays meet a handful of circles: one after the other is quicker than with numpy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from logical_robots_tui.world.rays import FORWARD, MIDDLE, PER_RADIAN, RADAR_RAYS, SENSOR_RANGE

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import NDArray

    from logical_robots_tui.world.rays import Circles, Rays

__all__ = ["take_singly"]

_ALL_RAYS = range(RADAR_RAYS + 1)


def take_singly(
    hits: NDArray[np.int64], codes: int, rays: Rays, circles: Circles, most: int
) -> bool:
    """Lower hits where robots meet circles, as `take_nearer_circles` does it at once.

    Args:
        hits: As there.
        codes: As there.
        rays: As there.
        circles: As there.
        most: Pairs of a robot and a circle within its reach; with more nothing is done.

    Returns:
        Whether it was done.
    """
    found = hits.tolist()
    each = list(zip(*(part.tolist() for part in circles), strict=True))
    starts = zip(rays.robot.tolist(), rays.x.tolist(), rays.y.tolist(), strict=True)
    pairs = []
    for row, (robot, x, y) in enumerate(starts):
        reach = max(found[row]) // codes
        for number, center_x, center_y, radius in each:
            away = math.hypot(center_x - x, center_y - y)
            if away <= radius + reach and number != robot:
                pairs.append((row, number, center_x, center_y, radius, away))
    if len(pairs) > most:
        return False
    for row, number, center_x, center_y, radius, away in pairs:
        hit, cos, sin = found[row], rays.cos[row].tolist(), rays.sin[row].tolist()
        angle, x, y = rays.angle.item(row), rays.x.item(row), rays.y.item(row)
        dx, dy = center_x - x, center_y - y
        ahead, right = dx * cos[FORWARD] + dy * sin[FORWARD], dy * cos[FORWARD] - dx * sin[FORWARD]
        least = max(math.floor(away - radius), 1) * codes + number + 1
        for ray in _between_tangents(ahead, right, radius, angle):
            if least >= hit[ray]:
                continue
            for step in _steps_around_entry(
                dx * cos[ray] + dy * sin[ray], dx * sin[ray] - dy * cos[ray], radius
            ):
                to_x, to_y = cos[ray] * step + x - center_x, sin[ray] * step + y - center_y
                if math.hypot(to_x, to_y) < radius:
                    hits[row, ray] = hit[ray] = min(hit[ray], step * codes + number + 1)
                    break
    return True


def _between_tangents(ahead: float, right: float, radius: float, angle: float) -> Iterable[int]:
    """The rays that may meet a circle whose centre lies so far ahead and to the right."""
    away = math.hypot(ahead, right)
    if radius >= away * (1 - 1e-9):
        return _ALL_RAYS
    center = math.atan2(right, ahead) * PER_RADIAN + MIDDLE
    # As far as rounding can matter.
    half = math.asin(radius / away) * PER_RADIAN + 1e-13 * abs(angle) + 1e-3
    first = math.ceil(max(center - half, 0.0))
    last = math.floor(min(center + half, RADAR_RAYS - 1.0))
    # The forward ray stands behind the middle one.
    return range(first + (first >= FORWARD), last + (last >= FORWARD - 1) + 1)


def _steps_around_entry(along: float, aside: float, radius: float) -> Iterable[int]:
    """The steps of which one is the first inside the circle, if any is."""
    half_squared = radius * radius - aside * aside
    half_squared += 1e-9 * radius + 1e-14 * (along * along + radius * radius)
    if half_squared < 0:
        return ()
    half = math.sqrt(half_squared)
    if along + half <= 0.5:
        return ()
    entry = max(math.floor(along - half - 1e-6), 1)
    return range(entry, min(entry + 3, SENSOR_RANGE))
