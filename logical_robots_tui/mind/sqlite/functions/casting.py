"""Conversions to text and to other types, with the semantics of DuckDB's casts.

A type is JSON: ``"Num"``, ``"Int"``, ``"Str"``, ``"Bool"``, ``"Any"``, ``{"field": type}``
or ``[type]``.
"""

from __future__ import annotations

import json
import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.sqlite.stored import to_json

if TYPE_CHECKING:
    from collections.abc import Callable

_LARGEST = 2**63  # above all of SQLite's integers


def to_text(value: Any) -> str:
    """Return a value as `ToString` writes it: ``1.0``, ``{'a': 1}``, ``[a, b]``."""
    parsed = _parsed(value)
    return _written(value if parsed is None else parsed, inside=False)


def try_cast(value: Any, type_json: str) -> Any:
    """Convert a value, or return null; a record gets exactly the type's fields. Cached."""
    if value.__class__ is str and len(value) < _LONGEST_KEPT:
        return _cast_text(value, type_json)
    return _cast_to(value, type_json)


_LONGEST_KEPT = 100_000  # characters


def _cast_to(value: Any, type_json: str) -> Any:
    cast = _cast(value, _type(type_json))
    return to_json(cast) if isinstance(cast, dict | list) else cast


_cast_text = lru_cache(maxsize=64)(_cast_to)
_type = lru_cache(maxsize=64)(json.loads)


def try_cast_like(value: Any, example: Any) -> Any:
    cast = _cast(value, _type_of(_parsed(example) or example))
    return to_json(cast) if isinstance(cast, dict | list) else cast


def _type_of(example: Any) -> Any:
    """Return the type of an example; null and the elements of an empty list have any type."""
    if isinstance(example, dict):
        return {name: _type_of(value) for name, value in example.items()}
    if isinstance(example, list):
        return [_type_of(example[0] if example else None)]
    if isinstance(example, bool):
        return "Bool"
    return "Any" if example is None else "Str" if isinstance(example, str) else "Num"


def _cast(value: Any, wanted: Any) -> Any:
    if value is None:
        return None
    if isinstance(wanted, dict):
        record = _parsed(value)
        if not isinstance(record, dict):
            return None
        return {field: _cast(record.get(field), wanted[field]) for field in wanted}
    if isinstance(wanted, list):
        items = _parsed(value)
        return [_cast(i, wanted[0]) for i in items] if isinstance(items, list) else None
    return _CASTS[wanted](value)


def _parsed(value: Any) -> Any:
    if isinstance(value, dict | list):
        return value
    if isinstance(value, str) and value.lstrip()[:1] in ("{", "["):
        try:
            return json.loads(value)
        except (ValueError, RecursionError):
            return None
    return None


def _number(value: Any) -> float | None:
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def _whole(value: Any) -> int | None:
    if not isinstance(value, int):
        number = _number(value)
        if number is None or not math.isfinite(number):
            return None
        value = math.floor(abs(number) + 0.5) * (1 if number >= 0 else -1)
    return int(value) if -_LARGEST <= value < _LARGEST else None


def _truth(value: Any) -> bool | None:
    if isinstance(value, int | float):
        return bool(value)
    spelled = value.lower() if isinstance(value, str) else ""
    return {"true": True, "t": True, "1": True, "false": False, "f": False, "0": False}.get(spelled)


_CASTS: dict[str, Callable[[Any], Any]] = {
    "Any": lambda value: value,
    "Num": _number,
    "Int": _whole,
    "Str": to_text,
    "Bool": _truth,
}


def _written(value: Any, *, inside: bool) -> str:
    if value is None:
        return "NULL"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        fields = (f"'{k}': {_written(v, inside=True)}" for k, v in value.items())
        return "{" + ", ".join(fields) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_written(v, inside=True) for v in value) + "]"
    if isinstance(value, float):
        return _float(value)
    text = str(value)
    return f"'{text}'" if inside and (not text or text != text.strip()) else text


def _float(value: float) -> str:
    if math.isfinite(value):
        return repr(value)
    return "inf" if value > 0 else "-inf"
