"""Numbers and names in sentences."""

from __future__ import annotations

import re
from collections.abc import Iterable


def count_of(number: int, what: str) -> str:
    """Return a count in words, such as ``1 row`` or ``1,200 rows``."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def join_names(names: Iterable[str]) -> str:
    """Join names with commas; three or more numbered ones in order become ``Bee 1 … Bee 100``."""
    series: list[list[str]] = []
    for name in names:
        if series and name == _successor(series[-1][-1]):
            series[-1].append(name)
        else:
            series.append([name])
    return ", ".join(
        ", ".join(each) if len(each) < 3 else f"{each[0]} … {each[-1]}" for each in series
    )


def _successor(name: str) -> str | None:
    number = re.search(r"[0-9]+$", name)
    if number is None:
        return None
    return f"{name[: number.start()]}{int(number[0]) + 1:0{len(number[0])}}"
