"""Formatting arbitrary text and values for a terminal."""

from __future__ import annotations

import json
import math
import unicodedata
from typing import Any

__all__ = ["UNRELIABLE", "columns", "finite", "harmless", "line_of_json", "written"]

UNRELIABLE = "A time limit ended a thought: another run may differ."

_UNPRINTABLE = {"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"}


def harmless(text: str) -> str:
    r"""Make text from a file or program safe to print: control characters become ``\x1b``."""
    return "".join(repr(c)[1:-1] if unicodedata.category(c) in _UNPRINTABLE else c for c in text)


def columns(rows: list[tuple[str, ...]]) -> list[str]:
    """Format rows as aligned columns, two spaces apart, with `harmless` cells."""
    clean = [tuple(harmless(cell) for cell in row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*clean, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in clean
    ]


def finite(value: Any) -> Any:
    """Replace infinities and NaN, which JSON does not have, by null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): finite(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [finite(inner) for inner in value]
    return value


def line_of_json(value: Any) -> str:
    r"""Format a value as one line of JSON, with control characters escaped as in ``\u009b``."""
    text = json.dumps(finite(value), ensure_ascii=False, allow_nan=False)
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else json.dumps(c)[1:-1] for c in text)


def written(value: Any, width: int | None = None) -> str:
    """Format a value as one line of JSON, cut to a width in characters if one is given."""
    text = harmless(json.dumps(finite(value), ensure_ascii=False, allow_nan=False))
    return text if width is None or len(text) <= width else f"{text[: width - 3]}..."
