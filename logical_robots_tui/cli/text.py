"""Text for a terminal that may hold anything."""

from __future__ import annotations

import unicodedata

__all__ = ["columns", "harmless"]

_UNPRINTABLE = {"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"}


def harmless(text: str) -> str:
    r"""Make text from a file or program safe to print: control characters become ``\x1b``."""
    return "".join(repr(c)[1:-1] if unicodedata.category(c) in _UNPRINTABLE else c for c in text)


def columns(rows: list[tuple[str, ...]]) -> list[str]:
    """Lay out rows as aligned columns, two spaces apart; the cells are made harmless."""
    clean = [tuple(harmless(cell) for cell in row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*clean, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in clean
    ]
