"""Which areas are on, and when the level is won."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from collections.abc import Set as AbstractSet

    from logical_robots_tui.world.level import Area
    from logical_robots_tui.world.state import AreaState

__all__ = ["is_won", "starts_active", "switched"]


def starts_active(area: Area) -> bool:
    """Return whether an area is on at the start: it is, unless a beacon switches it on."""
    return not area.on_beacon


def switched(area: Area, active: bool, seen: AbstractSet[str]) -> bool:
    """Return whether an area is on after this tick.

    Args:
        area: The area.
        active: Whether it was on before.
        seen: Names of the beacons on any robot's radar in this tick.
    """
    if area.off_beacon and area.off_beacon in seen:
        return False
    if area.on_beacon and area.on_beacon in seen:
        return True
    if area.sticky_switch and (area.on_beacon or area.off_beacon):
        return active
    return starts_active(area)


def is_won(areas: Iterable[tuple[Area, AreaState]]) -> bool:
    """Return whether some active goal contains all the robots that it is for."""
    return any(
        state.active and area.victory_robots and set(area.victory_robots) <= set(state.visitors)
        for area, state in areas
    )
