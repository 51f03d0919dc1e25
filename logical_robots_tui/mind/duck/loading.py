"""A moment as columns of numbers and texts, as DuckDB takes them from Python."""

from __future__ import annotations

from array import array
from itertools import chain
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from logical_robots_tui.mind.duck.scopes import INPUTS
from logical_robots_tui.mind.filling import KINDS
from logical_robots_tui.mind.tables import UnfitError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.mind.duck.terms import Kind
    from logical_robots_tui.mind.moment import Moment

__all__ = ["columns_of"]

_MOST_RAYS = 1000  # of a radar; by their numbers the first of equal ones is told
_IN_SELF = frozenset({"can_charge", "has_battery", "battery_level", "battery_capacity"})


def columns_of(table: str, moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The columns of a table, as many items in each as the table has rows.

    Args:
        table: One of `INPUTS`.
        moment: Where the rows come from.
        wanted: Columns of it, beside numbers.

    Raises:
        UnfitError: A value is not of the kind that the column is for.
    """
    try:
        if table == "Sensor":
            return _sensors(moment, wanted)
        if table == "Memory":
            return _memories(moment)
        return _rays(table, moment, wanted)
    except (TypeError, KeyError, AttributeError, ValueError, OverflowError) as error:
        raise UnfitError(str(error)) from None


def _sensors(moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    sensors = [row["sensor"] for row in moment.sensors]
    found: dict[str, NDArray[Any]] = {"id": np.arange(len(sensors))}
    for column in wanted:
        if column == "robot_name":
            values: list[Any] = moment.names
        else:
            places = [sensor["self"] for sensor in sensors] if column in _IN_SELF else sensors
            values = [place[column] for place in places]
        found[column] = _column(INPUTS["Sensor"][column], values)
    return found


def _memories(moment: Moment) -> dict[str, NDArray[Any]]:
    """Whose memories are seen by whom; where all see all of them, by nobody in particular."""
    stride = moment.stride
    return {
        "viewer": np.array([n // stride if stride else 0 for n, _ in moment.memories]),
        "robot_name": _column("text", [name for _, name in moment.memories]),
    }


def _rays(table: str, moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    radars: list[Sequence[Mapping[str, Any]]]
    if table in KINDS:
        numbered = moment.rays_to(KINDS[table])
        radars = [[ray for _, ray in items] for items in numbered]
        numbers: Iterable[int] = (number for items in numbered for number, _ in items)
    else:
        radars = [row["sensor"]["radar"] for row in moment.sensors]
        numbers = chain.from_iterable(range(len(radar)) for radar in radars)
    sizes = [len(radar) for radar in radars]
    rays = list(chain.from_iterable(radars))
    if not rays:
        return {**_NO_RAYS, **{column: _NO_VALUES[INPUTS[table][column]] for column in wanted}}
    found = {
        "sensor": np.repeat(np.arange(len(radars)), sizes),
        "ray": np.fromiter(numbers, np.int64, len(rays)),
    }
    if found["ray"].max() >= _MOST_RAYS:
        raise UnfitError("a radar of too many rays")
    for column in wanted:
        found[column] = _column(INPUTS[table][column], [*map(itemgetter(column), rays)])
    return found


def _column(kind: Kind, values: Sequence[Any]) -> NDArray[Any]:
    return _MAKERS[kind](values)


def _whole(values: Sequence[Any]) -> NDArray[Any]:
    return np.frombuffer(array("q", values), np.int64)  # takes no real numbers


def _real(values: Sequence[Any]) -> NDArray[Any]:
    if set(map(type, values)) != {float}:
        raise UnfitError("a number that is whole")
    found = np.array(values)
    if not np.isfinite(found).all():
        raise UnfitError("a number without end")
    return found


def _text(values: Sequence[Any]) -> NDArray[Any]:
    if set(map(type, values)) != {str}:
        raise UnfitError("not a text")
    found = np.empty(len(values), dtype=object)
    found[:] = values
    return found


_NOBODY = np.array([-1])
_NO_RAYS = {"sensor": _NOBODY, "ray": _NOBODY}
"""A ray of no robot: DuckDB could not tell of which kind the values of no rows are."""

_NO_VALUES: dict[Kind, NDArray[Any]] = {
    "whole": np.array([0]),
    "real": np.array([0.0]),
    "text": np.array([""], dtype=object),
}

_MAKERS: dict[Kind, Callable[[Sequence[Any]], NDArray[Any]]] = {
    "whole": _whole,
    "real": _real,
    "text": _text,
}
