"""Packing: compressing finished ticks so that each can be restored exactly."""

from __future__ import annotations

import marshal
import math
import zlib
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from itertools import groupby
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Protocol, get_args

from logical_robots_tui.mind import Decision, Notice, NoticeKind
from logical_robots_tui.values import Desire, Value
from logical_robots_tui.world import AreaState, Level, RobotState, WorldState
from logical_robots_tui.world.dynamics import Mover, body_of

if TYPE_CHECKING:
    from logical_robots_tui.game.frame import Frame

_QUICKEST = 1  # zlib level; so little changes from tick to tick that more is not needed
_BODY_BYTES = 1_000  # of a robot's state and decision
_DEEPEST = 200  # that a value read from a file may be nested
_HEAVIEST_OPEN = 24_000_000  # bytes of objects in all packs that are kept open

_FLAGS = [type(part.default) is bool for part in fields(Mover)]
"""Which values of a body are true or false, not numbers."""

_facts_of = attrgetter("think_milliseconds", "driven", "weight")


@dataclass(frozen=True, slots=True)
class Moment:
    """The state after a finished tick, without sensors, because the world can sense again.

    `driven` is in map units of all robots since the start, `weight` the approximate bytes of
    objects that are not in the previous moment.
    """

    after: WorldState
    memories: Mapping[str, Value]
    decisions: tuple[Decision, ...]
    think_milliseconds: float
    driven: float
    weight: int = field(default=0, compare=False)

    @classmethod
    def from_frame(cls, frame: Frame, driven: float) -> Moment:
        old_memories, decisions = frame.memories_before, frame.decisions
        weight = sum(d.weight for d in decisions if d.memory is not old_memories.get(d.robot_name))
        weight += sum(len(notice.message) for d in decisions for notice in d.notices)
        weight += _BODY_BYTES * len(decisions)
        milliseconds = frame.think_milliseconds
        return cls(frame.after, frame.memories, decisions, milliseconds, driven, weight)

    @property
    def is_reliable(self) -> bool:
        """Whether the tick is the same on any machine: no time limit cut off a thought."""
        return all(decision.is_reliable for decision in self.decisions)


class Packed:
    """Consecutive moments, grouped by robot because similar values compress well.

    `weight` is the approximate number of bytes when unpacked.
    """

    __slots__ = ("_bytes", "first", "weight")

    def __init__(self, moments: Sequence[Moment]) -> None:
        self.first = moments[0].after.tick
        self.weight = sum(moment.weight for moment in moments)
        self._bytes = zlib.compress(marshal.dumps(lay_out(moments)), _QUICKEST)

    def __len__(self) -> int:
        """Return its size in bytes."""
        return len(self._bytes)

    def moment(self, index: int) -> Moment:
        return _open_packs.moment(self, index)

    def memory(self, index: int, robot: str) -> Value:
        return _open_packs.memory(self, index, robot)

    def unpack(self) -> tuple[int, list[Any]]:
        """Return its segments, and the approximate bytes of their objects."""
        return self.weight, marshal.loads(zlib.decompress(self._bytes))  # noqa: S302 - our own bytes


class Unpackable(Protocol):
    """Packed moments: segments in which the names of robots and areas stay the same."""

    def unpack(self) -> tuple[int, list[Any]]: ...


class OpenPacks:
    """A cache of unpacked segments, bounded by the bytes of their objects."""

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self._packs: OrderedDict[Unpackable, tuple[int, list[Any]]] = OrderedDict()

    def moment(self, pack: Unpackable, index: int) -> Moment:
        iterator = iter(self._segments(pack))
        begin, names, area_names, facts, areas, bodies, thoughts, values = next(iterator)
        while index >= len(facts):
            index -= len(facts)
            begin, names, area_names, facts, areas, bodies, thoughts, values = next(iterator)
        won_at, tallies, milliseconds, driven, weight, has_decided = facts[index]
        robots = [RobotState(name, *body[index]) for name, body in zip(names, bodies, strict=True)]
        area_states = [
            AreaState(name, active, tuple(visitors))
            for name, (active, visitors) in zip(area_names, areas[index], strict=True)
        ]
        team_tallies = tuple(map(tuple, tallies))
        state = WorldState(begin + index, tuple(robots), tuple(area_states), won_at, team_tallies)
        memories, decisions = {}, []
        for name, thought in zip(names, thoughts, strict=True):
            places, engines, notices = thought[index]
            memories[name] = memory = _memory(places, values)
            if has_decided:
                desire = None if engines is None else Desire(*engines)
                decision_notices = tuple([Notice(*notice) for notice in notices])
                decisions.append(Decision(name, desire, memory, decision_notices))
        return Moment(state, memories, tuple(decisions), milliseconds, driven, weight)

    def memory(self, pack: Unpackable, index: int, robot: str) -> Value:
        """Return a robot's memory in one moment; raise LookupError if it is not there."""
        for _, names, _, facts, _, _, thoughts, values in self._segments(pack):
            if index < len(facts) and robot in names:
                return _memory(thoughts[names.index(robot)][index][0], values)
            index -= len(facts)
        raise LookupError(robot)

    def _segments(self, pack: Unpackable) -> list[Any]:
        """Return what a pack holds, in the layout of `lay_out`, perhaps through JSON."""
        is_new = pack not in self._packs
        self._packs[pack] = entry = self._packs.pop(pack, None) or pack.unpack()
        while is_new and sum(weight for weight, _ in self._packs.values()) > self._most_bytes:
            self._packs.popitem(last=False)
        return entry[1]


_open_packs = OpenPacks(_HEAVIEST_OPEN)


def lay_out(moments: Sequence[Moment]) -> list[Any]:
    """Return moments as lists; equal parts of memories are there only once."""
    segments: list[Any] = []
    # Robots and areas may come and go when the level is edited.
    for names, group in groupby(moments, _names_of):
        segment, values, robots = list(group), _Values(), [*enumerate(names[0])]
        facts = [
            (m.after.won_at, m.after.tallies, *_facts_of(m), bool(m.decisions)) for m in segment
        ]
        areas = [[(area.active, area.visitors) for area in m.after.areas] for m in segment]
        bodies = [[body_of(m.after.robots[i]) for m in segment] for i, _ in robots]
        thoughts = [[_thought_of(m, i, name, values) for m in segment] for i, name in robots]
        segments.append((segment[0].after.tick, *names, facts, areas, bodies, thoughts, values.all))
    return segments


def _memory(places: Any, values: Sequence[Value]) -> Value:
    if isinstance(places, dict):
        return {name: values[place] for name, place in places.items()}
    memory: Value = values[places]
    return memory


def _names_of(moment: Moment) -> tuple[list[str], list[str]]:
    state = moment.after
    return [robot.name for robot in state.robots], [area.name for area in state.areas]


class _Values:
    """The parts of memories, each different one once."""

    def __init__(self) -> None:
        self.all: list[Value] = []
        self._places: dict[bytes, int] = {}  # by what is written, because 1, 1.0 and true are equal

    def places(self, memory: Value) -> object:
        """Return the places of a memory's fields, or the place of a memory without fields."""
        if isinstance(memory, dict):
            return {name: self._place(value) for name, value in memory.items()}
        return self._place(memory)

    def _place(self, value: Any) -> int:
        place = self._places.setdefault(marshal.dumps(value, 2), len(self.all))
        if place == len(self.all):
            self.all.append(value)
        return place


def _thought_of(moment: Moment, index: int, name: str, values: _Values) -> tuple[object, ...]:
    if not moment.decisions:
        return values.places(moment.memories[name]), None, ()
    decision = moment.decisions[index]
    desire = decision.desire
    return (
        values.places(decision.memory),
        None if desire is None else (desire.left_engine, desire.right_engine),
        tuple([(notice.kind, notice.message) for notice in decision.notices]),
    )


def is_moment(moment: Moment, tick: int, level: Level) -> bool:
    """Return whether a moment from a file is valid, but for the depth of its memories.

    Raises TypeError for a list as a name.
    """
    names = [robot.name for robot in level.robots]
    return (
        is_state(moment.after, moment.memories, tick, level)
        and _are_numbers(moment.think_milliseconds, moment.driven)
        and type(moment.weight) is int
        and moment.weight >= 0
        and [decision.robot_name for decision in moment.decisions] == (names if tick else [])
        and all(
            decision.desire is None
            or _are_numbers(decision.desire.left_engine, decision.desire.right_engine)
            for decision in moment.decisions
        )
        and all(
            notice.kind in get_args(NoticeKind) and type(notice.message) is str
            for decision in moment.decisions
            for notice in decision.notices
        )
    )


def is_state(state: WorldState, memories: Any, tick: int, level: Level) -> bool:
    """Return whether a state from a file is valid, as `is_moment` does."""
    names = [robot.name for robot in level.robots]
    return (
        type(state.tick) is int
        and state.tick == tick
        and (state.won_at is None or (type(state.won_at) is int and 0 < state.won_at <= tick))
        and [robot.name for robot in state.robots] == names
        and all(
            type(value) is bool if is_flag else _are_numbers(value)
            for robot in state.robots
            for value, is_flag in zip(body_of(robot), _FLAGS, strict=True)
        )
        and [area.name for area in state.areas] == [area.name for area in level.areas]
        and all(
            type(area.active) is bool and set(area.visitors) <= set(names) for area in state.areas
        )
        and [len(row) for row in state.tallies] == [len(level.teams)] * len(level.scores)
        and all(type(n) is int and 0 <= n < 1 << 63 for row in state.tallies for n in row)
        and type(memories) is dict
        and list(memories) == names
    )


def _are_numbers(*values: Any) -> bool:
    return all(type(value) in (int, float) and math.isfinite(value) for value in values)


def is_shallow(value: Any, depth: int = _DEEPEST) -> bool:
    """Return whether a value from a file is not nested too deeply."""
    if type(value) not in (list, dict):
        return True
    inside = value.values() if type(value) is dict else value
    return depth > 0 and all(is_shallow(element, depth - 1) for element in inside)
