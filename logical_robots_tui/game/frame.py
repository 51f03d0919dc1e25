"""Frames: immutable records of finished ticks, and what happened in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.values import SensorRow, Value
from logical_robots_tui.world import Level, WorldState
from logical_robots_tui.world.dynamics import points

if TYPE_CHECKING:
    from logical_robots_tui.mind.decision import Decision, Notice


@dataclass(frozen=True, slots=True)
class Frame:
    """Everything that the screen, the inspector and a replay need from one tick.

    Frame 0 is the start: no decision yet, ``decisions`` is empty, ``before`` equals
    ``after``, and ``sensors`` shows what the robots see from their start (clock 0). The same holds
    for a tick at whose end an edit of the level added or removed robots or areas. After any other
    edit ``after`` is the edited world, and everything else is unchanged.

    Attributes:
        tick: Number of the tick, 0 for the start.
        before: The world from which the robots sensed.
        after: The world after they acted.
        sensors: The program's ``Sensor`` rows, one per robot in file order. Don't modify them.
        memories_before: Each robot's memory as the program saw it, by robot name.
        decisions: The program's decisions, one per robot in file order.
        memories: Each robot's memory afterwards, by robot name.
        think_milliseconds: How long thinking took; ignored when frames are compared.
    """

    tick: int
    before: WorldState
    after: WorldState
    sensors: tuple[SensorRow, ...]
    memories_before: Mapping[str, Value]
    decisions: tuple[Decision, ...]
    memories: Mapping[str, Value]
    think_milliseconds: float = field(compare=False)

    def decision_of(self, robot: str) -> Decision | None:
        """Return the program's decision for a robot; None in a frame without decisions."""
        return next((decision for decision in self.decisions if decision.robot_name == robot), None)

    @property
    def distance(self) -> float:
        """The total straight-line distance that all robots moved, in map units."""
        pairs = zip(self.before.robots, self.after.robots, strict=True)
        return sum(math.hypot(end.x - start.x, end.y - start.y) for start, end in pairs)

    @property
    def is_reliable(self) -> bool:
        """Whether the tick is the same on any machine: no time limit cut off a thought."""
        return all(decision.is_reliable for decision in self.decisions)


class NoSuchTickError(LogicalRobotsError):
    """History does not hold the requested tick."""

    title = "No such tick"


class Superseded(Exception):  # noqa: N818 - not an error: the player did something else meanwhile
    """The work belonged to a run that is over; its result was dropped."""


def events_between(level: Level, previous: Frame, frame: Frame) -> Iterator[str]:
    """Yield a sentence for each event between two consecutive ticks; names are not escaped."""
    obstacle = "a wall or a robot" if level.solid_robots else "a wall"
    immobile = {robot.name for robot in level.robots if robot.is_immobile}
    for old_robot, robot in zip(previous.after.robots, frame.after.robots, strict=True):
        name = robot.name
        if robot.blocked != old_robot.blocked:
            yield f"{name} is blocked by {obstacle}." if robot.blocked else f"{name} moves again."
        if robot.dead != old_robot.dead and name not in immobile:
            yield f"The battery of {name} is empty." if robot.dead else f"{name} has charge again."
    for old_area, area in zip(previous.after.areas, frame.after.areas, strict=True):
        if area.active is not old_area.active:
            yield f"{area.name} is switched {'on' if area.active else 'off'}."
        old_names, names = old_area.visitors, area.visitors
        yield from (f"{name} enters {area.name}." for name in names if name not in old_names)
        yield from (f"{name} leaves {area.name}." for name in old_names if name not in names)
    # Areas may share a name, so goals are identified by position.
    goal_indices = [index for index, area in enumerate(level.areas) if area.victory_robots]
    for index, goal in zip(goal_indices, goals(level, frame.after), strict=True):
        if previous.after.areas[index].visitors != frame.after.areas[index].visitors:
            yield goal.words
    for name, notice in new_notices(previous, frame):
        yield f"{name}: {notice.message}"
    if frame.after.won_at == frame.tick and previous.after.won_at is None:
        yield f"Won after {frame.tick} ticks."
    if is_match_over(level, frame.tick):
        yield f"The match is over: {standing_words(level, frame.after)}."


def new_notices(previous: Frame, frame: Frame) -> Iterator[tuple[str, Notice]]:
    """Yield the notices of kinds that a robot had not in the previous tick, with its name."""
    old_kinds = {(d.robot_name, notice.kind) for d in previous.decisions for notice in d.notices}
    for decision in frame.decisions:
        for notice in decision.notices:
            if (decision.robot_name, notice.kind) not in old_kinds:
                yield decision.robot_name, notice


def ends(level: Level, frame: Frame) -> bool:
    """Return whether a run stops after a tick: the level was just won, or the match is over."""
    return frame.after.won_at == frame.tick or is_match_over(level, frame.tick)


def is_match_over(level: Level, tick: int) -> bool:
    """Return whether a tick is the last one that counts in a match of teams."""
    return tick > 0 and tick == level.match_ticks


def standing(level: Level, state: WorldState) -> dict[str, float]:
    """Return the points of each team, in the order of the level; {} where nothing is scored."""
    return {team: sum(parts) for team, parts in points(level, state).items() if parts}


def standing_words(level: Level, state: WorldState) -> str:
    """Return the points of the teams in words, the best first: ``red 12, blue 7``."""
    ranking = sorted(standing(level, state).items(), key=lambda entry: -entry[1])
    return ", ".join(f"{team} {round(score, 1):,.10g}" for team, score in ranking)


class Goal(NamedTuple):
    """One goal area and the robots in it."""

    area_name: str
    active: bool
    robots: tuple[str, ...]
    inside: tuple[str, ...]

    @property
    def is_reached(self) -> bool:
        """Whether all required robots are inside while the area is active."""
        return self.active and len(self.inside) == len(self.robots)

    @property
    def words(self) -> str:
        """Which of the required robots are inside, one sentence."""
        if len(self.robots) == 1:
            return f"{self.area_name}: {self.robots[0]} is {'in' if self.inside else 'not in yet'}."
        return f"{self.area_name}: {len(self.inside)} of {len(self.robots)} are in."


class Peak(NamedTuple):
    """The most robots that were in their goals at once, of how many, and the first such tick.

    That is in all goals, or in the one with the most if one is enough.
    """

    inside: int = 0
    total: int = 0
    tick: int = 0

    def with_tick(self, level: Level, state: WorldState) -> Peak:
        """Return the peak up to a tick after those of this one."""
        inside, total = max(count_home(level, state), default=(0, 0))
        return Peak(inside, total, state.tick) if inside > self.inside else self

    @property
    def words(self) -> str:
        """The peak in words, or "" if nobody was there, or one robot wins alone."""
        if not self.inside or self.total == 1:
            return ""
        return f"most at once: {self.inside} of {self.total}, tick {self.tick}"


def count_home(level: Level, state: WorldState, *, is_open: bool = False) -> list[tuple[int, int]]:
    """Return how many robots of a goal are in it, and of how many, by goal.

    Where all goals are needed, they count together. None is in a goal that is switched off, unless
    `is_open`.
    """
    counts = [
        (len({*robots}.intersection(area_state.visitors)), len(robots))
        if area_state.active or is_open
        else (0, len(robots))
        for area, area_state in zip(level.areas, state.areas, strict=True)
        if (robots := area.victory_robots)
    ]
    if not level.all_goals:
        return counts
    return [(sum(inside for inside, _ in counts), sum(total for _, total in counts))]


def goals(level: Level, state: WorldState) -> tuple[Goal, ...]:
    """Return the goals of a level in their present state."""
    goal_states = []
    for area, area_state in zip(level.areas, state.areas, strict=True):
        if names := area.victory_robots:
            inside = tuple(name for name in names if name in area_state.visitors)
            goal_states.append(Goal(area.name, area_state.active, names, inside))
    return tuple(goal_states)
