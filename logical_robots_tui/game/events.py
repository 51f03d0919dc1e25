"""The events of a tick, as sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.game.goal import goals

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.world import Level
    from logical_robots_tui.world.state import AreaState, RobotState

__all__ = ["events_between"]


def events_between(level: Level, past: Frame, frame: Frame) -> Iterator[str]:
    """Yield a sentence for each event between two consecutive ticks.

    Names and messages are as given by the level and the program.

    Args:
        level: The level.
        past: The tick before.
        frame: The tick.
    """
    for before, now in zip(past.after.robots, frame.after.robots, strict=True):
        yield from _of_robot(before, now)
    for old, area in zip(past.after.areas, frame.after.areas, strict=True):
        yield from _of_area(old, area)
    # Areas may share a name, so goals are identified by position.
    wanted = [place for place, area in enumerate(level.areas) if area.victory_robots]
    for place, goal in zip(wanted, goals(level, frame.after), strict=True):
        if past.after.areas[place].visitors != frame.after.areas[place].visitors:
            yield goal.words
    known = {(d.robot_name, notice.kind) for d in past.decisions for notice in d.notices}
    for decision in frame.decisions:
        for notice in decision.notices:
            if (decision.robot_name, notice.kind) not in known:
                yield f"{decision.robot_name}: {notice.message}"
    if frame.after.won_at == frame.tick and past.after.won_at is None:
        yield f"Won after {frame.tick} ticks."


def _of_robot(before: RobotState, now: RobotState) -> Iterator[str]:
    if now.blocked and not before.blocked:
        yield f"{now.name} is blocked by a wall."
    if before.blocked and not now.blocked:
        yield f"{now.name} moves again."
    if now.dead and not before.dead:
        yield f"The battery of {now.name} is empty."
    if before.dead and not now.dead:
        yield f"{now.name} has charge again."


def _of_area(old: AreaState, area: AreaState) -> Iterator[str]:
    if area.active is not old.active:
        yield f"{area.name} is switched {'on' if area.active else 'off'}."
    for name in area.visitors:
        if name not in old.visitors:
            yield f"{name} enters {area.name}."
    for name in old.visitors:
        if name not in area.visitors:
            yield f"{name} leaves {area.name}."
