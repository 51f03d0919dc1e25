"""Frames without decisions: the start of a game, and after robots were added or removed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.world import World

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level, WorldState

__all__ = ["fresh_frame", "start_frame"]


def start_frame(level: Level, world: World | None = None) -> Frame:
    """Return frame 0 of a level: nobody has thought yet, and no program is needed.

    Args:
        level: The level.
        world: A new world of the level, if there is one already.
    """
    world = world or World(level)
    return fresh_frame(world, world.save(), {robot.name: "" for robot in level.robots})


def fresh_frame(world: World, state: WorldState, memories: Mapping[str, Value]) -> Frame:
    """Return a frame without decisions.

    Args:
        world: The world to sense in; it is in this state afterwards.
        state: The state of the world.
        memories: Each robot's memory, by robot name.
    """
    world.restore(state)
    return Frame(state.tick, state, state, tuple(world.look()), memories, (), memories, 0.0)
