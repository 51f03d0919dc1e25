"""Conversions to text and to other types, with the semantics of DuckDB's casts.

A type is JSON: ``"Num"``, ``"Int"``, ``"Str"``, ``"Bool"``, ``"Any"``, ``{"field": type}``
or ``[type]``.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterable
from functools import cmp_to_key, lru_cache
from typing import Any, TypeAlias

from logical_robots_tui.mind.sqlite.budget import MAX_ITEMS, check_long
from logical_robots_tui.mind.sqlite.stored import to_input, to_json

Scalar: TypeAlias = "int | float | str | None"

ENDLESS = "9.0e+999"
"""Infinity in JSON."""


def bound_value(text: str) -> str:
    """Return the text if a function may parse it; else raise TooLargeError."""
    if len(text) > MAX_ITEMS:
        check_long(text)
    return text


def list_in(text: Scalar) -> list[Any]:
    """Return the list in a value, or raise TypeError."""
    value = json.loads(bound_value(text)) if isinstance(text, str) else None
    if not isinstance(value, list):
        raise TypeError(f"not a list: {text!r}"[:200])
    return value


def element(value: Scalar) -> Any:
    if isinstance(value, str) and value[:1] in ("{", "["):
        try:
            return json.loads(bound_value(value))
        except ValueError:
            return value
    return value


def real_as_json(value: Any) -> str | None:
    """Return a number as JSON text with all digits, integers as reals; null stays null."""
    if value.__class__ is float:
        text = repr(value)
        if "n" not in text:
            return text
        return ENDLESS if value > 0 else f"-{ENDLESS}"
    return value_as_json(float(value) if isinstance(value, int) else value)


def value_as_json(value: Any) -> str | None:
    """Return a value as JSON text, parsing records and lists in texts; null stays null."""
    kind = value.__class__
    if kind is str:
        return value if element(value) is not value else to_input(value)
    if kind is float:
        return real_as_json(value)
    return None if value is None else str(value)


def compare(left: Scalar, right: Scalar) -> int:
    """Return -1, 0 or 1; fields in the left record's order, nested nulls are equal and last."""
    return in_json(element(left), element(right))


def in_json(left: Any, right: Any) -> int:
    """Compare values from JSON: -1, 0 or 1; a missing field counts as null."""
    ranks = _rank(left), _rank(right)
    if ranks[0] != ranks[1]:
        return -1 if ranks[0] < ranks[1] else 1
    if isinstance(left, dict):
        names = [*left, *(name for name in right if name not in left)]
        pairs = [(left.get(name), right.get(name)) for name in names]
    elif isinstance(left, list):
        pairs = list(zip(left, right, strict=False))
        pairs.append((len(left), len(right)))
    else:
        return 0 if left is None or left == right else -1 if left < right else 1
    return next((found for one, other in pairs if (found := in_json(one, other))), 0)


def _rank(value: Any) -> int:
    if value is None:
        return 4
    if isinstance(value, int | float):
        return 0
    return 1 if isinstance(value, str) else 2 if isinstance(value, list) else 3


_key = cmp_to_key(in_json)


def order(value: Any) -> tuple[int, Any]:
    """Return a sort key for values of all types: numbers, texts, the rest, then null."""
    if value is None:
        return (4, 0)
    if isinstance(value, int | float):
        return (1, value)
    if isinstance(value, str):
        return (2, value)
    return (3, _key(value))


def order_of_scalar(value: Scalar) -> tuple[int, Any]:
    return order(element(value))


def in_order(values: Iterable[Any]) -> list[Any]:
    values = list(values)
    types = {type(value) for value in values}
    if types <= {int, float} or types == {str}:
        return sorted(values)
    return sorted(values, key=order)


_LARGEST = 2**63  # above all of SQLite's integers


def to_text(value: Any) -> str:
    """Return a value as `ToString` writes it: ``1.0``, ``{'a': 1}``, ``[a, b]``."""
    parsed = _parse(value)
    return _spell(value if parsed is None else parsed, inside=False)


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
    cast = _cast(value, _type_of(_parse(example) or example))
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
    if not isinstance(wanted, dict | list):
        return _CASTS[wanted](value)
    parts = _parse(value)
    if parts is None and isinstance(value, str):
        return _cast_spelled(value, wanted)
    if isinstance(wanted, dict) and isinstance(parts, dict):
        return {field: _cast(parts.get(field), wanted[field]) for field in wanted}
    if isinstance(wanted, list) and isinstance(parts, list):
        return [_cast(part, wanted[0]) for part in parts]
    return None


def _cast_spelled(text: str, wanted: Any) -> Any:
    """Convert a record or list as DuckDB spells it; its parts are texts, whatever they spell."""

    def part(value: str | None, wanted: Any) -> Any:
        return value if wanted in ("Str", "Any") else _cast(value, wanted)

    if isinstance(wanted, list):
        items = read_list(text)
        return None if items is None else [part(item, wanted[0]) for item in items]
    fields = read_record(text)
    if fields is None or not fields.keys() <= wanted.keys():
        return None  # as on DuckDB
    return {name: part(fields.get(name), of) for name, of in wanted.items()}


def _parse(value: Any) -> Any:
    if isinstance(value, dict | list):
        return value
    if isinstance(value, str) and value.lstrip()[:1] in ("{", "["):
        try:
            return json.loads(value)
        except (ValueError, RecursionError):
            return None
    return None


def _number(value: Any) -> float | None:
    if isinstance(value, str) and not value.isascii():
        return None  # Python reads digits of all scripts
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def whole(value: Any) -> int | None:
    """Return a value as a whole number: like DuckDB's casts, halves of real numbers to even."""
    if not isinstance(value, int):
        number = _number(value)
        if number is None or not math.isfinite(number):
            return None
        away = math.floor(abs(number) + 0.5) * (1 if number >= 0 else -1)
        value = round(number) if isinstance(value, float) else away
    return int(value) if -_LARGEST <= value < _LARGEST else None


def _truth(value: Any) -> bool | None:
    if isinstance(value, str):
        return _TRUTHS.get(value.lower())
    return bool(value) if isinstance(value, int | float) else None


_TRUTHS = {
    **dict.fromkeys(("true", "t", "yes", "y", "1"), True),
    **dict.fromkeys(("false", "f", "no", "n", "0"), False),
}

_CASTS: dict[str, Callable[[Any], Any]] = {
    "Any": lambda value: value,
    "Num": _number,
    "Int": whole,
    "Str": to_text,
    "Bool": _truth,
}


def _spell(value: Any, *, inside: bool) -> str:
    if value is None:
        return "NULL"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        fields = (f"{_quote(k)}: {_spell(v, inside=True)}" for k, v in value.items())
        return "{" + ", ".join(fields) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_spell(v, inside=True) for v in value) + "]"
    if isinstance(value, float):
        return repr(value)  # also inf
    text = str(value)
    return _write(text) if inside else text


# -- records and lists in texts, as DuckDB writes them: {'n': 1, 'w': hi}, [a, 'b, c', NULL] ------

_SPACES = " \t\n\v\f\r"
_SPACE = re.compile(f"[{_SPACES}]*")
_SPECIAL = re.compile(r"""["'(),:=\[\\\]{}]""")
_ESCAPED = re.compile(r"""['\\]""")
_CLOSES = {"{": "}", "[": "]", "(": ")"}
_PLAIN = re.compile(r"""[^"',:\\{}()\[\]]+""")
_QUOTED = {quote: re.compile(rf"(?:[^\\{quote}]|\\.)*{quote}", re.DOTALL) for quote in "'\""}
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_SIGNS = re.compile(r"""'(?:[^\\']|\\.)*'|"(?:[^\\"]|\\.)*"|\\['"]|['"{}\[\]()]""", re.DOTALL)


def _quote(text: str) -> str:
    """Return a text in quotes, as the name of a field always is."""
    return "'" + _ESCAPED.sub(r"\\\g<0>", text) + "'"


def _write(text: str) -> str:
    """Return a text as it stands in a record or list: in quotes only if it could be misread."""
    is_plain = (
        text
        and text.strip(_SPACES) == text
        and text.upper() != "NULL"
        and not _SPECIAL.search(text)
    )
    return text if is_plain else _quote(text)


def read_record(text: str) -> dict[str, str | None] | None:
    """Return a record's fields as texts, or None if the text spells no record."""
    reader = _Reader(text, "{")
    found: dict[str, str | None] = {}
    while not reader.is_at_end:
        name, ended = reader.part(":")
        if not name or ended != ":":
            return None
        found[name], ended = reader.part(",")
        if ended == "," and reader.is_at_end:
            return None
    return found if reader.is_complete else None


def read_list(text: str) -> list[str | None] | None:
    """Return a list's elements as texts, or None if the text spells no list."""
    reader = _Reader(text, "[")
    found: list[str | None] = []
    ended = "" if reader.is_at_end else ","
    while ended == ",":
        element, ended = reader.part(",")
        found.append(element)
    return found if reader.is_complete else None


class _Reader:
    """Reads the parts between two brackets, one after the other."""

    def __init__(self, text: str, opening: str) -> None:
        self._text = text.strip(_SPACES)
        self._closing = _CLOSES[opening]
        self._at = 1
        self._is_broken = self._text[:1] != opening

    @property
    def is_at_end(self) -> bool:
        """Whether there is nothing more before the closing bracket, or in the text."""
        rest = _SPACE.match(self._text, self._at)
        at = rest.end() if rest else self._at
        return self._is_broken or at >= len(self._text) or self._text[at] == self._closing

    @property
    def is_complete(self) -> bool:
        """Whether everything was read, and quotes and brackets match."""
        return not self._is_broken and self._text[self._at :].strip(_SPACES) == self._closing

    def part(self, separator: str) -> tuple[str | None, str]:
        """Return the next part, or None for an unquoted null; and what it ended with."""
        text, pieces, quoted = self._text, list[str](), list[int]()
        ended = ""
        while self._at < len(text) and not self._is_broken and text[self._at] != self._closing:
            at, character = self._at, text[self._at]
            if character == separator:
                self._at += 1
                ended = separator
                break
            if character in _QUOTED:
                match = _QUOTED[character].match(text, at + 1)
                self._move(match.end() if match else -1)
                quoted.append(len(pieces))
                pieces.append(_ESCAPE.sub(r"\1", match.group()[:-1]) if match else "")
            elif character in _CLOSES:
                self._move(_closed(text, at))
                pieces.append(text[at : self._at])
            elif character == "\\" and text[at + 1 : at + 2] in _QUOTED:
                self._move(at + 2)
                pieces.append(text[at + 1])
            else:
                plain = _PLAIN.match(text, at)
                self._move(plain.end() if plain else at + 1)
                pieces.append(text[at : self._at])
        if not quoted:
            part = "".join(pieces).strip(_SPACES)
            return None if part.upper() == "NULL" else part, ended
        first, last = quoted[0], quoted[-1]  # what is in quotes keeps its spaces
        begin, end = "".join(pieces[:first]), "".join(pieces[last + 1 :])
        inside = "".join(pieces[first : last + 1])
        return begin.lstrip(_SPACES) + inside + end.rstrip(_SPACES), ended

    def _move(self, at: int) -> None:
        self._is_broken = at < 0
        self._at = max(self._at, at)


def _closed(text: str, at: int) -> int:
    """Return the offset after the bracket that closes the one at an offset, or -1."""
    waiting: list[str] = []
    for found in _SIGNS.finditer(text, at):
        sign = found.group()
        if sign in _CLOSES:
            waiting.append(_CLOSES[sign])
        elif sign in _QUOTED:
            return -1  # it is not closed
        elif sign == waiting[-1]:
            waiting.pop()
            if not waiting:
                return found.end()
    return -1
