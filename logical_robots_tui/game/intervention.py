"""Changing the level of a running game."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.game.start import fresh_frame
from logical_robots_tui.world.changing import changed_state, former_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.worlds import Worlds
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.changing import Pose

__all__ = ["changed_frame"]


def changed_frame(
    worlds: Worlds, frame: Frame, before: Level, after: Level, poses: Mapping[str, Pose]
) -> Frame:
    """Return a frame whose tick ends in another level; keeps its decisions if possible.

    Args:
        worlds: The worlds to sense in.
        frame: The frame.
        before: The old level.
        after: The new level.
        poses: New poses of robots, by their name in the new level.

    Raises:
        ValueError: A pose is for an unknown robot.
    """
    state = changed_state(frame.after, before, after, poses)
    if frame.decisions and _is_thought_alike(before, after):
        return replace(frame, after=state)
    former = former_names(before, after)
    known: dict[str, Value] = {name: frame.memories[old] for name, old in former.items()}
    memories = {robot.name: known.get(robot.name, "") for robot in after.robots}
    return fresh_frame(worlds.of(after), state, memories)


def _is_thought_alike(before: Level, after: Level) -> bool:
    """Return whether robots, areas and visibility are the same, so that decisions stay valid."""
    return before.visibility == after.visibility and all(
        [thing.name for thing in one] == [thing.name for thing in other]
        for one, other in ((before.robots, after.robots), (before.areas, after.areas))
    )
