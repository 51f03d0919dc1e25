"""The sensors and memories of one tick, and who sees which of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, Literal, NamedTuple

from logical_robots_tui.values import SensorRow, Value


class View(NamedTuple):
    """Robots that think alike, and the first and last numbers of the rows that they see."""

    viewers: tuple[str, ...]
    sensors: tuple[int, int]
    memories: tuple[int, int]


class Moment:
    """The sensors and memories of one tick; the rows that a robot sees are adjacent.

    Attributes:
        sensors: The sensor rows, numbered from 0.
        names: Names of the robots, in the same order.
        memories: Ascending numbers and names of the visible memories: robot m's memory, as
            seen by robot n, has number n * `stride` + m.
        stride: The number of robots; 0 if all see the same memories.
        apart: Whether each robot sees only its own sensor.
    """

    def __init__(
        self,
        rows: Sequence[SensorRow],
        memories: Mapping[str, Value],
        memory: Literal["own", "seen", "all"],
        sensor: Literal["own", "all"],
    ) -> None:
        self._objects: list[list[Any]] | None = None
        self._rays_to: dict[str, Sequence[Sequence[tuple[int, Mapping[str, Any]]]]] = {}
        self.sensors = rows
        self.remembered = memories
        self.names = names = [row["robot_name"] for row in rows]
        self.apart = sensor == "own"
        self.stride = 0 if memory == "all" else len(rows)
        if memory == "seen":
            self.memories = self._met()
        else:
            own = self.stride + 1
            self.memories = [(n * own, name) for n, name in enumerate(names)]
        last = len(rows) - 1
        if not rows:
            self.views: list[View] = []
        elif memory == "all" and sensor == "all":
            self.views = [View(tuple(names), (0, last), (0, last))]
        else:
            self.views = [
                View(
                    (name,),
                    (n, n) if self.apart else (0, last),
                    (n * self.stride, n * self.stride + last),
                )
                for n, name in enumerate(names)
            ]

    @classmethod
    def stacked(cls, moments: Sequence[Moment]) -> Moment:
        """Return several moments, in which each robot sees only its own sensor, as one.

        Its robots are those of all moments in turn; each sees what it sees in its moment.
        """
        rows = [row for moment in moments for row in moment.sensors]
        stack = cls(rows, {}, "own", "own")
        remembered: dict[str, Value] = {}
        memories: list[tuple[int, str]] = []
        first = 0
        for moment in moments:
            size = len(moment.sensors)
            owners = [_Owner(name) for name in moment.names]
            for owner in owners:
                remembered[owner] = moment.remembered.get(str(owner))
            seen = [number for number, _ in moment.memories]
            if not moment.stride:
                seen = [n * size + m for n in range(size) for m in seen]
            for number in seen:
                viewer, mine = divmod(number, size)
                memories.append(((first + viewer) * len(rows) + first + mine, owners[mine]))
            first += size
        stack.remembered, stack.memories = remembered, memories
        return stack

    def rays_to(self, kind: str) -> Sequence[Sequence[tuple[int, Mapping[str, Any]]]]:
        found = self._rays_to.get(kind)
        if found is None:
            if self._objects is None:
                self._objects = [[*map(_OBJECT, row["sensor"]["radar"])] for row in self.sensors]
            found = self._rays_to[kind] = [
                _pick(kind, objects, row) if kind in objects else ()
                for objects, row in zip(self._objects, self.sensors, strict=True)
            ]
        return found

    def one_by_one(self, view: View) -> Iterator[View]:
        for name in view.viewers if len(view.viewers) > 1 else ():
            number = next(i for i, row in enumerate(self.sensors) if row["robot_name"] == name)
            yield View((name,), (number, number), (number, number))

    def _met(self) -> list[tuple[int, str]]:
        names = self.names
        numbers = {name: number for number, name in enumerate(names)}
        found = []
        for number, rays in enumerate(self.rays_to("robot")):
            seen = {numbers.get(ray["label"], number) for _, ray in rays}
            found += [(number * len(names) + m, names[m]) for m in sorted(seen | {number})]
        return found


class _Owner(str):
    """The name of a memory's owner at one of several moments, different from all others."""

    __slots__ = ()
    __eq__ = object.__eq__
    __hash__ = object.__hash__


_OBJECT = itemgetter("object")


def _pick(
    kind: str, objects: Sequence[Any], row: SensorRow
) -> Sequence[tuple[int, Mapping[str, Any]]]:
    radar = row["sensor"]["radar"]
    return [(n, radar[n]) for n, found in enumerate(objects) if found == kind]
