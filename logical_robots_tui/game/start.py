"""Where every game begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.world import World

if TYPE_CHECKING:
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level

__all__ = ["start_frame"]


def start_frame(level: Level) -> Frame:
    """Frame 0 of a level: nobody has thought yet, and there need be no program to show it."""
    world = World(level)
    state = world.save()
    memories: dict[str, Value] = {robot.name: "" for robot in level.robots}
    return Frame(0, state, state, tuple(world.look()), memories, (), memories, 0.0)
