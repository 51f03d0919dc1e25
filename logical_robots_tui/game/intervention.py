"""Changing the level under way: how the present frame looks afterwards."""

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
    """A frame whose tick ends in another level; what was thought in the tick stays, if it can.

    Args:
        worlds: Where to look around.
        frame: The frame as it was.
        before: The level at the end of its tick so far.
        after: The level from now on.
        poses: Where robots are put, by their name in the level after.

    Raises:
        ValueError: A pose is for nobody.
    """
    state = changed_state(frame.after, before, after, poses)
    if frame.decisions and _is_thought_alike(before, after):
        return replace(frame, after=state)
    former = former_names(before, after)
    known: dict[str, Value] = {name: frame.memories[old] for name, old in former.items()}
    memories = {robot.name: known.get(robot.name, "") for robot in after.robots}
    return fresh_frame(worlds.of(after), state, memories)


def _is_thought_alike(before: Level, after: Level) -> bool:
    """Whether the same robots think of the same areas, and may see the same of each other."""
    return before.visibility == after.visibility and all(
        [thing.name for thing in one] == [thing.name for thing in other]
        for one, other in ((before.robots, after.robots), (before.areas, after.areas))
    )
