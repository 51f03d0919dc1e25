"""How far the robots have driven."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.world import WorldState

__all__ = ["driven"]


def driven(before: WorldState, after: WorldState) -> float:
    """Return the total straight-line distance of all robots between two states, in map units."""
    return sum(
        math.hypot(now.x - then.x, now.y - then.y)
        for then, now in zip(before.robots, after.robots, strict=True)
    )
