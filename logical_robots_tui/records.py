"""Reading what was written earlier: dataclasses from JSON, checked, and older forms."""

from __future__ import annotations

import json
import types
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")


def record(kind: type[T], data: Any) -> T:
    """Return a dataclass from JSON data of `dataclasses.asdict`, or raise ValueError.

    Its module must import the types of its fields at run time, except Mapping and Sequence.
    """
    value: T = _check(kind, data, kind.__name__)
    return value


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind, localns={"Mapping": Mapping, "Sequence": Sequence})


def _check(wanted: Any, data: Any, where: str) -> Any:
    origin, arguments = get_origin(wanted), get_args(wanted)
    if is_dataclass(wanted):
        return _dataclass(wanted, data, where)
    if origin is Literal:
        if data in arguments:
            return data
    elif origin in (Union, types.UnionType):
        for argument in arguments:
            try:
                return _check(argument, data, where)
            except ValueError:
                continue
    elif origin is tuple and isinstance(data, list):
        if arguments[1:] == (...,):
            return tuple(_check(arguments[0], item, where) for item in data)
        if len(arguments) == len(data):
            pairs = zip(arguments, data, strict=True)
            return tuple(_check(argument, item, where) for argument, item in pairs)
    elif origin in (Mapping, dict) and isinstance(data, dict):
        return {key: _check(arguments[1], item, where) for key, item in data.items()}
    elif wanted is float and type(data) is int:
        return float(data)
    elif isinstance(wanted, type) and type(data) is wanted:
        return data
    raise ValueError(f"{where} is not {wanted}")


def _dataclass(wanted: Any, data: Any, where: str) -> Any:
    if not isinstance(data, dict):
        raise ValueError(f"{where} is not a record")
    hints = _hints(wanted)
    known = {field.name: field for field in fields(wanted)}
    needed = {
        name
        for name, field in known.items()
        if field.default is MISSING and field.default_factory is MISSING
    }
    if not needed <= data.keys() <= known.keys():
        raise ValueError(f"{where} has other fields than {wanted.__name__}")
    return wanted(
        **{name: _check(hints[name], value, f"{where}.{name}") for name, value in data.items()}
    )


_HEAD = "# teams: "
_LONGEST = 100_000  # characters of the table


def texts_of(text: str) -> dict[str, str]:
    """Return the programs by team in a text that an older version wrote.

    Its first line says how many lines each team has; otherwise it is the program of "".
    """
    head, _, rest = text.partition("\n")
    lines, texts, begin = rest.split("\n"), {}, 0
    if head.startswith(_HEAD) and len(head) < _LONGEST:
        try:
            for team, count in json.loads(head.removeprefix(_HEAD)).items():
                end = begin + max(count, 0)
                texts[team], begin = "\n".join(lines[begin:end]), end
        except (AttributeError, RecursionError, TypeError, ValueError):
            return {"": text}
    return {"": text} if begin < len(lines) or not texts else texts
