"""The values that pass between the parts of the package."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

Value: TypeAlias = "bool | int | float | str | Sequence[Value] | Mapping[str, Value] | None"
"""A value that a program can compute or remember: null, text, number, list or record."""

SensorRow: TypeAlias = dict[str, Any]
"""``{"robot_name": str, "sensor": {...}}``, as the program's ``Sensor`` predicate sees it."""


@dataclass(frozen=True, slots=True)
class Desire:
    """The engine power that a program wants for one robot.

    Values outside [-1, 1] are legal: driving clamps them, but the battery pays for the given value.

    Attributes:
        left_engine: Wanted power of the left engine; 1.0 is one map unit a tick.
        right_engine: Wanted power of the right engine.
    """

    left_engine: float
    right_engine: float
