"""What the expressions of a query can name."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from logical_robots_tui.mind.duck.terms import Kind, UnlikeError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["INPUTS", "Scope", "Source", "input_source"]

_RAY: dict[str, Kind] = {"angle": "real", "distance": "whole", "object": "text", "label": "text"}

INPUTS: dict[str, Mapping[str, Kind]] = {
    "Sensor": {
        "id": "whole",
        "robot_name": "text",
        "forward_distance": "whole",
        "forward_object": "text",
        "forward_label": "text",
        "clock": "whole",
        "can_charge": "whole",
        "has_battery": "whole",
        "battery_level": "real",
        "battery_capacity": "real",
    },
    "Memory": {"robot_name": "text"},
    "Ray": _RAY,
    "RobotRay": _RAY,
    "BeaconRay": _RAY,
}
"""Columns of the tables that `loading` fills, with the kinds of their values, none of them null.

Beside these a memory has the number of its `viewer`, and a ray those of its `sensor` and, in the
order of the radar, its own, `ray`."""


@dataclass(frozen=True, slots=True)
class Source:
    """Something that a select reads.

    Attributes:
        name: Under which name.
        columns: By the name that the program has for it, each column's name and the kind of its
            values.
        table: ``sensor``, ``memory`` or ``ray`` if it is an input, else "".
    """

    name: str
    columns: Mapping[str, tuple[str, Kind]]
    table: str = ""

    def called(self, name: str) -> Source:
        """The same under another name."""
        return replace(self, name=name)


@dataclass(frozen=True, slots=True)
class Scope:
    """What a select reads, inside of what the selects around it read.

    Attributes:
        sources: By the program's name in lower case.
        outer: What is around it.
        named: Named queries, likewise.
    """

    sources: dict[str, Source]
    outer: Scope | None
    named: dict[str, Source] = field(default_factory=dict)

    def find(self, name: str) -> Source:
        """The source of that name, the innermost one.

        Raises:
            UnlikeError: There is none.
        """
        scope: Scope | None = self
        while scope is not None:
            if name.lower() in scope.sources:
                return scope.sources[name.lower()]
            scope = scope.outer
        raise UnlikeError("names a table that is not there")

    def find_named(self, name: str) -> Source | None:
        """The named query of that name, or None."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.named:
                return scope.named[name]
            scope = scope.outer
        return None


def input_source(table: str, name: str) -> Source:
    """An input as a source.

    Raises:
        UnlikeError: There is no such input.
    """
    kinds = next((INPUTS[known] for known in INPUTS if known.lower() == table.lower()), None)
    if kinds is None:
        raise UnlikeError("names a table that is not there")
    kind = table.lower() if table.lower() in ("sensor", "memory") else "ray"
    return Source(name, {column: (column, of) for column, of in kinds.items()}, kind)
