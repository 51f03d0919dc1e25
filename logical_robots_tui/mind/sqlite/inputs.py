"""The sensors and memories of one tick, and who sees which of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, Literal, NamedTuple

from logical_robots_tui.values import SensorRow, Value


class View(NamedTuple):
    """Robots with the same inputs, and the first and last numbers of the rows that they see."""

    viewers: tuple[str, ...]
    sensors: tuple[int, int]
    memories: tuple[int, int]


class Inputs:
    """The sensors and memories of one tick; the rows that a robot sees are adjacent.

    Attributes:
        sensor_rows: The sensor rows, numbered from 0.
        names: Names of the robots, in the same order.
        memory_values: Memories by name.
        memory_rows: Ascending numbers and names of the visible memories: robot m's memory, as
            seen by robot n, has number n * `stride` + m.
        stride: The number of robots; 0 if all see the same memories.
        has_private_sensors: Whether each robot sees only its own sensor.
    """

    def __init__(
        self,
        rows: Sequence[SensorRow],
        memories: Mapping[str, Value],
        memory: Literal["own", "seen", "all"],
        sensor: Literal["own", "all"],
    ) -> None:
        self._objects: list[list[Any]] | None = None
        self._rays_by_kind: dict[str, Sequence[Sequence[tuple[int, Mapping[str, Any]]]]] = {}
        self.sensor_rows = rows
        self.memory_values = memories
        self.names = names = [row["robot_name"] for row in rows]
        self.has_private_sensors = sensor == "own"
        self.stride = 0 if memory == "all" else len(rows)
        if memory == "seen":
            self.memory_rows = self._rows_in_sight()
        else:
            step = self.stride + 1
            self.memory_rows = [(n * step, name) for n, name in enumerate(names)]
        last = len(rows) - 1
        if not rows:
            self.views: list[View] = []
        elif memory == "all" and sensor == "all":
            self.views = [View(tuple(names), (0, last), (0, last))]
        else:
            self.views = [
                View(
                    (name,),
                    (n, n) if self.has_private_sensors else (0, last),
                    (n * self.stride, n * self.stride + last),
                )
                for n, name in enumerate(names)
            ]

    @classmethod
    def stack(cls, parts: Sequence[Inputs]) -> Inputs:
        """Combine the inputs of several ticks, in which each robot sees only its own sensor.

        The robots are those of all ticks in turn; each sees what it sees in its tick.
        """
        rows = [row for inputs in parts for row in inputs.sensor_rows]
        combined = cls(rows, {}, "own", "own")
        memory_values: dict[str, Value] = {}
        memory_rows: list[tuple[int, str]] = []
        offset = 0
        for inputs in parts:
            size = len(inputs.sensor_rows)
            owners = [_UniqueName(name) for name in inputs.names]
            for name in owners:
                memory_values[name] = inputs.memory_values.get(str(name))
            visible_numbers = [number for number, _ in inputs.memory_rows]
            if not inputs.stride:
                visible_numbers = [n * size + m for n in range(size) for m in visible_numbers]
            for number in visible_numbers:
                viewer, owner = divmod(number, size)
                memory_rows.append(((offset + viewer) * len(rows) + offset + owner, owners[owner]))
            offset += size
        combined.memory_values, combined.memory_rows = memory_values, memory_rows
        return combined

    def rays_to(self, kind: str) -> Sequence[Sequence[tuple[int, Mapping[str, Any]]]]:
        rays = self._rays_by_kind.get(kind)
        if rays is None:
            if self._objects is None:
                self._objects = [
                    [*map(_object_of, row["sensor"]["radar"])] for row in self.sensor_rows
                ]
            rays = self._rays_by_kind[kind] = [
                _rays_at(kind, objects, row) if kind in objects else ()
                for objects, row in zip(self._objects, self.sensor_rows, strict=True)
            ]
        return rays

    def single_views(self, view: View) -> Iterator[View]:
        for name in view.viewers if len(view.viewers) > 1 else ():
            number = next(i for i, row in enumerate(self.sensor_rows) if row["robot_name"] == name)
            yield View((name,), (number, number), (number, number))

    def _rows_in_sight(self) -> list[tuple[int, str]]:
        names = self.names
        numbers = {name: number for number, name in enumerate(names)}
        memory_rows = []
        for number, rays in enumerate(self.rays_to("robot")):
            visible = {numbers.get(ray["label"], number) for _, ray in rays}
            memory_rows += [(number * len(names) + m, names[m]) for m in sorted(visible | {number})]
        return memory_rows


class _UniqueName(str):
    """The name of a memory's owner in one of several inputs, different from all others."""

    __slots__ = ()
    __eq__ = object.__eq__
    __hash__ = object.__hash__


_object_of = itemgetter("object")


def _rays_at(
    kind: str, objects: Sequence[Any], row: SensorRow
) -> Sequence[tuple[int, Mapping[str, Any]]]:
    radar = row["sensor"]["radar"]
    return [(n, radar[n]) for n, object_kind in enumerate(objects) if object_kind == kind]
