"""Observations of a run: notices, memories, and robots that made no progress."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.game.history.rounds import last_rounds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from logical_robots_tui.game.history.history import History
    from logical_robots_tui.mind.decision import NoticeKind
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import RobotState

_LONG = 150
"""Ticks for which a robot must be blocked or stand still to be reported."""

_AT_ONCE = 200  # ticks before yielding to others
_MOST_TEXTS = 10_000
_MOST_STRETCHES = 4  # of each kind, because in a crowd many robots do the same


@dataclass(frozen=True, slots=True)
class Loss:
    robot: str
    field: str
    tick: int


@dataclass(frozen=True, slots=True)
class Stretch:
    """Ticks in which a robot made no progress; `period` is in ticks per round, or 0."""

    kind: Literal["blocked", "still", "circle", "unfinished"]
    robot: str
    first: int
    last: int
    period: int = 0


@dataclass(slots=True)
class Observations:
    """What was observed in a run.

    Attributes:
        notices: By kind and robot, the first tick of a notice, their number, and the message.
        fields: The fields that memories had, each with its first tick.
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
        return min((each[0], robot) for (of, robot), each in self.notices.items() if of == kind)

    def first_losses(self) -> list[Loss]:
        first: dict[str, Loss] = {}
        for loss in sorted(self.losses.values(), key=lambda each: (each.tick, each.robot)):
            first.setdefault(loss.field, loss)
        return list(first.values())


async def observe(history: History, first: int, last: int) -> Observations:
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
        for stretch in _stretches(path, first) if len(path) > last - first and not is_home else ():
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


def _stretches(path: Sequence[RobotState], first: int) -> Iterator[Stretch]:
    """Yield the longest stretch of each kind in which a robot made no progress."""
    name = path[-1].name if path else ""
    kinds: tuple[tuple[Literal["blocked", "still"], Callable[[RobotState], bool]], ...] = (
        ("blocked", lambda robot: robot.blocked),
        ("still", lambda robot: not (robot.left_engine or robot.right_engine or robot.dead)),
    )
    for kind, is_so in kinds:
        begin, end = _longest([is_so(robot) for robot in path])
        if end - begin >= _LONG and (kind == "blocked" or end == len(path)):
            yield Stretch(kind, name, first + begin, first + end - 1)
            return
    if (found := last_rounds(path)) is not None:
        begin, period = found
        yield Stretch("circle", name, first + begin, first + len(path) - 1, period)
    elif len(path) > _LONG:
        yield Stretch("unfinished", name, first + len(path) - _LONG, first + len(path) - 1)


def _longest(holds: Sequence[bool]) -> tuple[int, int]:
    """Return start and end of the longest stretch of True; the last of equally long ones."""
    best, begin = (0, 0), 0
    for at, each in enumerate([*holds, False]):
        if not each:
            if at - begin >= best[1] - best[0]:
                best = (begin, at)
            begin = at + 1
    return best
