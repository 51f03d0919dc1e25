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
    return next(filter(None, (in_json(*pair) for pair in pairs)), 0)


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
    return _format(value if parsed is None else parsed, inside=False)


def try_cast(value: Any, type_json: str) -> Any:
    """Convert a value, or return null; a record gets exactly the type's fields. Cached."""
    if value.__class__ is str and len(value) < _MAX_CACHED_LENGTH:
        return _cast_text(value, type_json)
    return _cast_to(value, type_json)


_MAX_CACHED_LENGTH = 100_000  # characters


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


def _cast(value: Any, target_type: Any) -> Any:
    if value is None:
        return None
    if not isinstance(target_type, dict | list):
        return _CASTS[target_type](value)
    parts = _parse(value)
    if parts is None and isinstance(value, str):
        return _cast_spelled(value, target_type)
    if isinstance(target_type, dict) and isinstance(parts, dict):
        return {field: _cast(parts.get(field), target_type[field]) for field in target_type}
    if isinstance(target_type, list) and isinstance(parts, list):
        return [_cast(part, target_type[0]) for part in parts]
    return None


def _cast_spelled(text: str, target_type: Any) -> Any:
    """Convert a record or list as DuckDB spells it; its parts are texts, whatever they spell."""

    def part(value: str | None, target_type: Any) -> Any:
        return value if target_type in ("Str", "Any") else _cast(value, target_type)

    if isinstance(target_type, list):
        items = read_list(text)
        return None if items is None else [part(item, target_type[0]) for item in items]
    fields = read_record(text)
    if fields is None or not fields.keys() <= target_type.keys():
        return None  # as on DuckDB
    return {name: part(fields.get(name), field_type) for name, field_type in target_type.items()}


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
        rounded = math.floor(abs(number) + 0.5) * (1 if number >= 0 else -1)
        value = round(number) if isinstance(value, float) else rounded
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


def _format(value: Any, *, inside: bool) -> str:
    if value is None:
        return "NULL"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        fields = (f"{_quote(k)}: {_format(v, inside=True)}" for k, v in value.items())
        return "{" + ", ".join(fields) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_format(v, inside=True) for v in value) + "]"
    if isinstance(value, float):
        return repr(value)  # also inf
    text = str(value)
    return _quote_if_needed(text) if inside else text


# -- records and lists in texts, as DuckDB writes them: {'n': 1, 'w': hi}, [a, 'b, c', NULL] ------

_SPACES = " \t\n\v\f\r"
_SPACE = re.compile(f"[{_SPACES}]*")
_SPECIAL = re.compile(r"""["'(),:=\[\\\]{}]""")
_ESCAPED = re.compile(r"""['\\]""")
_CLOSES = {"{": "}", "[": "]", "(": ")"}
_PLAIN = re.compile(r"""[^"',:\\{}()\[\]]+""")
_QUOTED = {quote: re.compile(rf"(?:[^\\{quote}]|\\.)*{quote}", re.DOTALL) for quote in "'\""}
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_TOKENS = re.compile(r"""'(?:[^\\']|\\.)*'|"(?:[^\\"]|\\.)*"|\\['"]|['"{}\[\]()]""", re.DOTALL)


def _quote(text: str) -> str:
    """Quote a text, as the name of a field always is."""
    return "'" + _ESCAPED.sub(r"\\\g<0>", text) + "'"


def _quote_if_needed(text: str) -> str:
    """Quote a text in a record or list, but only if it could be misread."""
    is_plain = (
        text
        and text.strip(_SPACES) == text
        and text.upper() != "NULL"
        and not _SPECIAL.search(text)
    )
    return text if is_plain else _quote(text)


def read_record(text: str) -> dict[str, str | None] | None:
    """Return a record's fields as texts, or None if the text spells no record."""
    reader = _DuckDBReader(text, "{")
    fields: dict[str, str | None] = {}
    while not reader.is_at_end:
        name, separator = reader.part(":")
        if not name or separator != ":":
            return None
        fields[name], separator = reader.part(",")
        if separator == "," and reader.is_at_end:
            return None
    return fields if reader.is_complete else None


def read_list(text: str) -> list[str | None] | None:
    """Return a list's elements as texts, or None if the text spells no list."""
    reader = _DuckDBReader(text, "[")
    items: list[str | None] = []
    separator = "" if reader.is_at_end else ","
    while separator == ",":
        element, separator = reader.part(",")
        items.append(element)
    return items if reader.is_complete else None


class _DuckDBReader:
    """Reads the parts between two brackets in turn, as DuckDB writes them."""

    def __init__(self, text: str, opening: str) -> None:
        self._text = text.strip(_SPACES)
        self._closing = _CLOSES[opening]
        self._offset = 1
        self._is_broken = self._text[:1] != opening

    @property
    def is_at_end(self) -> bool:
        """Whether the closing bracket or the end of the text comes next."""
        space = _SPACE.match(self._text, self._offset)
        offset = space.end() if space else self._offset
        return self._is_broken or offset >= len(self._text) or self._text[offset] == self._closing

    @property
    def is_complete(self) -> bool:
        """Whether everything was read, and quotes and brackets match."""
        return not self._is_broken and self._text[self._offset :].strip(_SPACES) == self._closing

    def part(self, separator: str) -> tuple[str | None, str]:
        """Return the next part, or None for an unquoted null, and the separator after it, or ""."""
        text, pieces, quoted_indexes = self._text, list[str](), list[int]()
        separator_read = ""
        while (
            self._offset < len(text) and not self._is_broken and text[self._offset] != self._closing
        ):
            offset, character = self._offset, text[self._offset]
            if character == separator:
                self._offset += 1
                separator_read = separator
                break
            if character in _QUOTED:
                match = _QUOTED[character].match(text, offset + 1)
                self._move(match.end() if match else -1)
                quoted_indexes.append(len(pieces))
                pieces.append(_ESCAPE.sub(r"\1", match.group()[:-1]) if match else "")
            elif character in _CLOSES:
                self._move(_bracket_end(text, offset))
                pieces.append(text[offset : self._offset])
            elif character == "\\" and text[offset + 1 : offset + 2] in _QUOTED:
                self._move(offset + 2)
                pieces.append(text[offset + 1])
            else:
                plain = _PLAIN.match(text, offset)
                self._move(plain.end() if plain else offset + 1)
                pieces.append(text[offset : self._offset])
        if not quoted_indexes:
            text_value = "".join(pieces).strip(_SPACES)
            return None if text_value.upper() == "NULL" else text_value, separator_read
        first, last = quoted_indexes[0], quoted_indexes[-1]  # quoted text keeps its spaces
        begin, end = "".join(pieces[:first]), "".join(pieces[last + 1 :])
        inside = "".join(pieces[first : last + 1])
        return begin.lstrip(_SPACES) + inside + end.rstrip(_SPACES), separator_read

    def _move(self, offset: int) -> None:
        self._is_broken = offset < 0
        self._offset = max(self._offset, offset)


def _bracket_end(text: str, offset: int) -> int:
    """Return the offset after the bracket that closes the one at an offset, or -1."""
    closing: list[str] = []
    for match in _TOKENS.finditer(text, offset):
        token = match.group()
        if token in _CLOSES:
            closing.append(_CLOSES[token])
        elif token in _QUOTED:
            return -1  # it is not closed
        elif token == closing[-1]:
            closing.pop()
            if not closing:
                return match.end()
    return -1
