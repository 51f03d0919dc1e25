"""Where every game begins, and where it goes on if robots came or went."""

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
    """Frame 0 of a level: nobody has thought yet, and there need be no program to show it.

    Args:
        level: Where the robots stand.
        world: A new world of it, if there is one.
    """
    world = world or World(level)
    return fresh_frame(world, world.save(), {robot.name: "" for robot in level.robots})


def fresh_frame(world: World, state: WorldState, memories: Mapping[str, Value]) -> Frame:
    """The frame of a moment for which nobody has thought.

    Args:
        world: Where to look around; it stands in the state afterwards.
        state: The world at that moment.
        memories: Each robot's memory, by robot name.
    """
    world.restore(state)
    return Frame(state.tick, state, state, tuple(world.look()), memories, (), memories, 0.0)
