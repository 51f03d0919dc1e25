"""A cached world for the requested level."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.world import World

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

__all__ = ["Worlds"]


class Worlds:
    """Holds one world; a world for a similar level is created from it quickly.

    Args:
        level: The first level.
    """

    def __init__(self, level: Level) -> None:
        self._world = World(level)

    def of(self, level: Level) -> World:
        """Return the world of a level, in the state it was left in."""
        if self._world.level is not level:
            self._world = World(level, like=self._world)
        return self._world
