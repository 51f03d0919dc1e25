"""The values that pass between the parts of the package, and how programs write them."""

from __future__ import annotations

import ast
import json
import math
import re
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


_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_TEXT_OR_FIELD = re.compile(
    r""""(?:[^"\\]|\\.)*+"?"""
    r"""|('(?:[^'\\]|\\.)*+')|'.*+"""
    r"""|(?<!\w)([A-Za-z_]\w*+)(?=\s*+:)""",
    re.ASCII | re.DOTALL,
)


def spell(value: Value, room: int = 1_000_000, *, is_rounded: bool = False) -> str:
    """Return a value as programs write it, on one line; longer than `room` it may be incomplete.

    Numbers have all digits, or six if `is_rounded`.
    """
    parts: list[str] = []
    _spell(value, parts, [room], is_rounded)
    return "".join(parts)


def read_value(text: str) -> Value:
    """Return the value that `spell` writes so, or JSON; raise ValueError."""
    try:
        value: Value = json.loads(_TEXT_OR_FIELD.sub(_as_json, text))
    except (SyntaxError, RecursionError) as error:  # a wrong escape, or brackets nested too deeply
        raise ValueError(str(error)) from None
    return value


def _as_json(match: re.Match[str]) -> str:
    text, field = match.groups()
    if text:
        return json.dumps(ast.literal_eval(text))
    return f'"{field}"' if field else match[0]


def _spell(value: Value, parts: list[str], room: list[int], is_rounded: bool) -> None:
    if isinstance(value, str):
        _put(_text(value[: room[0] + 1]), parts, room)
    elif isinstance(value, Mapping | Sequence):
        fields = iter(value) if isinstance(value, Mapping) else None
        _put("[" if fields is None else "{", parts, room)
        items = value.values() if isinstance(value, Mapping) else value
        for number, item in enumerate(items):
            if room[0] < 0:
                return
            _put(", " if number else "", parts, room)
            if fields is not None:
                name = str(next(fields))[: room[0] + 1]
                _put(f"{name if _NAME.fullmatch(name) else _text(name)}: ", parts, room)
            _spell(item, parts, room, is_rounded)
        _put("]" if fields is None else "}", parts, room)
    else:
        _put(_scalar(value, is_rounded), parts, room)


def _put(text: str, parts: list[str], room: list[int]) -> None:
    parts.append(text)
    room[0] = max(-1, room[0] - len(text))


def _text(value: str) -> str:
    """Return a text in quotes; only single ones know escapes."""
    if value.isprintable() and not any(sign in value for sign in '"\\'):
        return f'"{value}"'
    return "'{}'".format("".join(map(_escaped, value)))


def _escaped(character: str) -> str:
    if character in "\\'":
        return f"\\{character}"
    if character.isprintable():
        return character
    code = ord(character)
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _scalar(value: float | bool | None, is_rounded: bool) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        # Python refuses to print whole numbers of thousands of digits.
        return str(value) if value.bit_length() < 256 else f"{value:#x}"
    if not math.isfinite(value) or not is_rounded:
        return str(value)
    if value == int(value) and abs(value) < 1e6:
        return f"{value:.1f}"
    return f"{value:.6g}"


def is_same(left: Value, right: Value) -> bool:
    """Return whether two values are equal; a truth is not a number."""
    if left is right:
        return True
    if left != right:
        return False
    if isinstance(left, dict) and isinstance(right, dict):
        return all(is_same(value, right[name]) for name, value in left.items())
    if isinstance(left, list) and isinstance(right, list):
        return all(map(is_same, left, right))
    return isinstance(left, bool) == isinstance(right, bool)
