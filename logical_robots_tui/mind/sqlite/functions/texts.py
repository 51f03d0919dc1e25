"""Texts as DuckDB formats them: numbers, format strings, upper and lower case."""

from __future__ import annotations

import math
import re
from typing import Any

from logical_robots_tui.mind.sqlite.bounds import check_text

__all__ = ["decimal_to_text", "formatted", "lower", "round_to", "upper"]

_DIRECTIVE = re.compile(r"%([-+ 0#]*)(\d*)(?:\.(\d*))?[hlLqjzt]*(.)", re.DOTALL)
_WHOLE = frozenset("diuoxXc")
_REAL = frozenset("eEfFgG")

_CAPITALS = {"ß": "ẞ"}  # Python has no single upper-case character for these


def decimal_to_text(value: float, scale: int) -> str:
    """Return a decimal number with a fixed number of digits after the point."""
    if not math.isfinite(value):
        return str(value)
    return f"{value + 0.0 if value else 0.0:.{scale}f}"


def formatted(template: str, *values: Any) -> str:
    """Return a text with each directive, as in C's printf, replaced by a value.

    Raises:
        ValueError: There is no such directive, or no value for it.
    """
    waiting = list(values)

    def written(found: re.Match[str]) -> str:
        flags, width, digits, kind = found.groups()
        if kind == "%":
            return "%"
        check_text(int(width or 0) + int(digits or 0))
        value = waiting.pop(0) if waiting else None
        if value is None:
            raise ValueError(f"no value for {found.group()}")
        precision = "" if digits is None else f".{digits or 0}"
        if kind in _WHOLE:
            value = value if kind == "c" and isinstance(value, str) else int(float(value))
        elif kind in _REAL:
            value = float(value)
        elif kind != "s":
            raise ValueError(f"no directive {found.group()}")
        return f"%{flags}{width}{precision}{kind}" % value

    return _DIRECTIVE.sub(written, template)


def round_to(value: float, digits: float) -> float:
    """Round halves away from zero, to digits after the point or, if negative, before it."""
    factor = 10 ** abs(int(digits))
    scaled = abs(value * factor if digits >= 0 else value / factor)
    if not math.isfinite(scaled):
        return value
    rounded = math.copysign(math.floor(scaled + 0.5), value)
    found = rounded / factor if digits >= 0 else rounded * factor
    return int(found) if isinstance(value, int) else found


def upper(text: str) -> str:
    """Return a text in upper case, character by character."""
    return text.upper() if text.isascii() else "".join(map(_capital, text))


def _capital(character: str) -> str:
    capital = character.upper()
    return capital if len(capital) == 1 else _CAPITALS.get(character, character)


def lower(text: str) -> str:
    """Return a text in lower case, character by character."""
    return text.lower() if text.isascii() else "".join(c.lower()[:1] for c in text)
