"""A moment as columns of numbers and texts, as DuckDB takes them from Python."""

from __future__ import annotations

from array import array
from itertools import chain
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from logical_robots_tui.mind.duck.scopes import INPUTS
from logical_robots_tui.mind.sqlite.filling import IN_SELF, KINDS, RAYS
from logical_robots_tui.mind.sqlite.tables import UnfitError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from logical_robots_tui.mind.duck.terms import Kind
    from logical_robots_tui.mind.sqlite.moment import Moment

__all__ = ["columns_of", "filled"]


def columns_of(table: str, moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    """The columns of a table.

    Where their length would change from tick to tick they are longer, and the last rows nobody's.

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
        if table in KINDS:
            return _rays_of_kind(table, moment, wanted)
        return _rays(moment, wanted)
    except (TypeError, KeyError, AttributeError, ValueError, OverflowError) as error:
        raise UnfitError(str(error)) from None


def filled(kept: Mapping[str, NDArray[Any]], new: Mapping[str, NDArray[Any]]) -> bool:
    """Put new values into columns that are kept, if they fit; tell whether they did."""
    if kept.keys() != new.keys():
        return False
    if any(len(kept[name]) != len(column) for name, column in new.items()):
        return False
    for name, column in new.items():
        kept[name][:] = column
    return True


def _sensors(moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    sensors = [row["sensor"] for row in moment.sensors]
    found: dict[str, NDArray[Any]] = {"id": np.arange(len(sensors))}
    for column in wanted:
        if column == "robot_name":
            values: Sequence[Any] = moment.names
        else:
            places = [sensor["self"] for sensor in sensors] if column in IN_SELF else sensors
            values = [place[column] for place in places]
        found[column] = _column(INPUTS["Sensor"][column], values)
    return found


def _memories(moment: Moment) -> dict[str, NDArray[Any]]:
    """Whose memories are seen by whom; where all see all of them, by nobody in particular."""
    stride = moment.stride or len(moment.names)
    return _with_room(
        {
            "viewer": np.array([number // stride for number, _ in moment.memories]),
            "robot_name": _column("text", [name for _, name in moment.memories]),
        },
        "viewer",
        exactly=not moment.stride or len(moment.memories) == len(moment.names),
    )


def _rays(moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    radars = [row["sensor"]["radar"] for row in moment.sensors]
    size = len(radars[0])
    if not 0 < size < RAYS or any(len(radar) != size for radar in radars):
        raise UnfitError("radars of different size")
    count = len(radars)
    found: dict[str, NDArray[Any]] = {
        "sensor": np.repeat(np.arange(count), size),
        "ray": np.tile(np.arange(size), count),
    }
    for column in wanted:
        values = [ray[column] for radar in radars for ray in radar]
        found[column] = _column(INPUTS["Ray"][column], values)
    return found


def _rays_of_kind(table: str, moment: Moment, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    numbered = moment.rays_to(KINDS[table])
    items = [*chain.from_iterable(numbered)]
    rays = [ray for _, ray in items]
    found = {
        "sensor": np.repeat(np.arange(len(numbered)), [*map(len, numbered)]),
        "ray": np.fromiter((number for number, _ in items), np.int64, len(items)),
    }
    if items and found["ray"].max() >= RAYS:
        raise UnfitError("a radar of too many rays")
    for column in wanted:
        found[column] = _column(INPUTS[table][column], [*map(itemgetter(column), rays)])
    return _with_room(found, "sensor")


def _with_room(
    columns: dict[str, NDArray[Any]], whose: str, *, exactly: bool = False
) -> dict[str, NDArray[Any]]:
    """Columns of a length that seldom changes, and of at least one row."""
    count = len(columns[whose])
    missing = 0 if exactly and count else (1 << count.bit_length()) - count
    longer = {}
    for name, column in columns.items():
        nothing = np.full(missing, "" if column.dtype == object else -1, column.dtype)
        longer[name] = np.concatenate([column, nothing])
    return longer


def _column(kind: Kind, values: Sequence[Any]) -> NDArray[Any]:
    return _MAKERS[kind](values)


def _whole(values: Sequence[Any]) -> NDArray[Any]:
    return np.array(array("q", values))  # takes no real numbers


def _real(values: Sequence[Any]) -> NDArray[Any]:
    found = np.array(array("d", values))
    if not np.isfinite(found).all():
        raise UnfitError("a number without end")
    if any(
        values[place].__class__ is not float for place in np.flatnonzero(found % 1 == 0).tolist()
    ):
        raise UnfitError("a number that is whole")
    return found


def _text(values: Sequence[Any]) -> NDArray[Any]:
    if values and set(map(type, values)) != {str}:
        raise UnfitError("not a text")
    found = np.empty(len(values), dtype=object)
    found[:] = values
    return found


_MAKERS: dict[Kind, Callable[[Sequence[Any]], NDArray[Any]]] = {
    "whole": _whole,
    "real": _real,
    "text": _text,
}
