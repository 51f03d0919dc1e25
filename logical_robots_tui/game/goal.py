"""Goals of a level, and their state at a tick."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.world import Level, WorldState

__all__ = ["Goal", "goals"]


@dataclass(frozen=True, slots=True)
class Goal:
    """One goal area and the robots in it.

    Attributes:
        area_name: Name of the area.
        active: Whether it counts at this tick.
        wanted: Names of the robots that must all be inside at once.
        inside: Names of those that are inside.
    """

    area_name: str
    active: bool
    wanted: tuple[str, ...]
    inside: tuple[str, ...]

    @property
    def reached(self) -> bool:
        """Whether all required robots are inside while the area is active."""
        return self.active and len(self.inside) == len(self.wanted)

    @property
    def words(self) -> str:
        """Which of the required robots are inside, one sentence."""
        if len(self.wanted) == 1:
            return f"{self.area_name}: {self.wanted[0]} is {'in' if self.inside else 'not in yet'}."
        return f"{self.area_name}: {len(self.inside)} of {len(self.wanted)} are in."


def goals(level: Level, state: WorldState) -> tuple[Goal, ...]:
    """Return the goal areas of a level in file order, with their state after a tick."""
    return tuple(
        Goal(
            area.name,
            now.active,
            area.victory_robots,
            tuple(name for name in area.victory_robots if name in now.visitors),
        )
        for area, now in zip(level.areas, state.areas, strict=True)
        if area.victory_robots
    )
