"""Whether what was read from a file can be what a tick of a level left behind."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, get_args

from logical_robots_tui.mind import NoticeKind

if TYPE_CHECKING:
    from logical_robots_tui.game.packing import Moment
    from logical_robots_tui.world import Level

__all__ = ["is_moment"]

_DEEPEST = 200  # that a memory may be nested


def is_moment(moment: Moment, tick: int, level: Level) -> bool:
    """Whether a moment can be what a tick left behind in a level, down to every type."""
    after, names = moment.after, [robot.name for robot in level.robots]
    return (
        type(after.tick) is int
        and after.tick == tick
        and (after.won_at is None or (type(after.won_at) is int and 0 < after.won_at <= tick))
        and [robot.name for robot in after.robots] == names
        and all(_is_body(robot) for robot in after.robots)
        and [area.name for area in after.areas] == [area.name for area in level.areas]
        and all(
            type(area.active) is bool and set(area.visitors) <= set(names) for area in after.areas
        )
        and _are_numbers(moment.think_milliseconds, moment.driven)
        and type(moment.weight) is int
        and moment.weight >= 0
        and list(moment.memories) == names
        and all(_is_value(memory, _DEEPEST) for memory in moment.memories.values())
        and [each.robot_name for each in moment.decisions] == (names if tick else [])
        and all(_is_decision(each) for each in moment.decisions)
    )


def _is_body(robot: Any) -> bool:
    numbers = (robot.x, robot.y, robot.angle, robot.battery_level)
    return (
        _are_numbers(*numbers, robot.left_engine, robot.right_engine)
        and type(robot.blocked) is bool
        and type(robot.dead) is bool
    )


def _is_decision(decision: Any) -> bool:
    desire = decision.desire
    return (desire is None or _are_numbers(desire.left_engine, desire.right_engine)) and all(
        notice.kind in get_args(NoticeKind) and type(notice.message) is str
        for notice in decision.notices
    )


def _are_numbers(*values: Any) -> bool:
    return all(type(value) in (int, float) and math.isfinite(value) for value in values)


def _is_value(value: Any, depth: int) -> bool:
    """Whether a value is nested no deeper than that; it is out of JSON, so its type is right."""
    if type(value) not in (list, dict):
        return True
    inside = value.values() if type(value) is dict else value
    return depth > 0 and all(_is_value(each, depth - 1) for each in inside)
