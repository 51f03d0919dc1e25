"""Numbers in sentences."""

from __future__ import annotations


def counted(number: int, what: str) -> str:
    """Return how many there are of something in words, such as ``1 row`` or ``1,200 rows``."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
