"""The events of a tick and the goals of a level, as sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.world import Level, WorldState
    from logical_robots_tui.world.state import AreaState, RobotState

__all__ = ["Goal", "events_between", "goals"]


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


class Goal(NamedTuple):
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
