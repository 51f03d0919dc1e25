"""The world of whichever level is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.world import World

if TYPE_CHECKING:
    from logical_robots_tui.world import Level

__all__ = ["Worlds"]


class Worlds:
    """One world at a time; one of a level that differs little is made from it quickly.

    Args:
        level: What is asked for first.
    """

    def __init__(self, level: Level) -> None:
        self._world = World(level)

    def of(self, level: Level) -> World:
        """The world of a level, in whatever state it was left."""
        if self._world.level is not level:
            self._world = World(level, like=self._world)
        return self._world
