"""Observations of a run: notices, movement and memories."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from logical_robots_tui.game.diagnosis.movement import stretches

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.game.diagnosis.movement import Stretch
    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind.decision import NoticeKind
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import RobotState

__all__ = ["Loss", "Observations", "observe"]

_AT_ONCE = 200  # ticks before yielding to others
_MOST_TEXTS = 10_000
_MOST_STRETCHES = 4  # of each kind, because in a crowd many robots do the same


@dataclass(frozen=True, slots=True)
class Loss:
    """A field that a robot's memory lost."""

    robot: str
    field: str
    tick: int


@dataclass(slots=True)
class Observations:
    """What was observed in a run.

    Attributes:
        first: The first tick.
        last: The last one.
        won_at: The tick of victory, or None.
        notices: By kind and robot, the first tick of a notice, their number, and the message.
        fields: The fields that memories had, each with its first tick.
        texts: Texts that were in memories.
        losses: For each field and robot, the first loss.
        stretches: The ticks in which robots made no progress.
    """

    first: int
    last: int
    won_at: int | None = None
    notices: dict[tuple[NoticeKind, str], tuple[int, int, str]] = field(default_factory=dict)
    fields: dict[str, int] = field(default_factory=dict)
    texts: set[str] = field(default_factory=set)
    losses: dict[tuple[str, str], Loss] = field(default_factory=dict)
    stretches: list[Stretch] = field(default_factory=list)

    def first_notice(self, kind: NoticeKind) -> tuple[int, str]:
        """Return tick and robot of the first notice of a kind."""
        return min((each[0], robot) for (of, robot), each in self.notices.items() if of == kind)

    def first_losses(self) -> list[Loss]:
        """Return the first loss of each field."""
        first: dict[str, Loss] = {}
        for loss in sorted(self.losses.values(), key=lambda each: (each.tick, each.robot)):
            first.setdefault(loss.field, loss)
        return list(first.values())


async def observe(history: History, first: int, last: int) -> Observations:
    """Observe the ticks of a history."""
    found = Observations(first, last)
    paths: dict[str, list[RobotState]] = {}
    level = history.level_at(last)
    at_home = {name: area.name for area in level.areas for name in area.victory_robots}
    before: dict[str, Value] = dict(history.around(first)[0].memories)
    for tick in range(first, last + 1):
        moment = history.around(tick)[1]
        found.won_at = moment.after.won_at
        for robot in moment.after.robots:
            paths.setdefault(robot.name, []).append(robot)
        for decision in moment.decisions:
            for notice in decision.notices:
                key = (notice.kind, decision.robot_name)
                begin, count, message = found.notices.get(key, (tick, 0, notice.message))
                found.notices[key] = (begin, count + 1, message)
        if moment.memories != before:
            _remembered(found, tick, before, moment.memories)
            before = dict(moment.memories)
        if not tick % _AT_ONCE:
            await asyncio.sleep(0)
    visitors = {area.name: area.visitors for area in history.around(last)[1].after.areas}
    kinds: Counter[str] = Counter()
    for name, path in paths.items():
        is_home = name in visitors.get(at_home.get(name, ""), ())
        for stretch in stretches(path, first) if len(path) > last - first and not is_home else ():
            kinds[stretch.kind] += 1
            if kinds[stretch.kind] <= _MOST_STRETCHES:
                found.stretches.append(stretch)
    return found


def _remembered(found: Observations, tick: int, before: Any, after: Any) -> None:
    for robot, memory in after.items():
        old = before.get(robot)
        if memory == old:
            continue
        if len(found.texts) < _MOST_TEXTS:
            found.texts.update(_texts(memory))
        fields = memory if isinstance(memory, dict) else {}
        for name in fields:
            found.fields.setdefault(str(name), tick)
        for name in old if isinstance(old, dict) else ():
            if name not in fields and old[name] is not None:
                found.losses.setdefault((robot, str(name)), Loss(robot, str(name), tick))


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for inner in value.values():
            yield from _texts(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _texts(inner)
