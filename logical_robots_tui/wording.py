"""Words on the screen: numbers and names in sentences, text made safe for a terminal."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable, Sequence

_PICTURES = {code: 0x2400 + code for code in range(32)} | {0x7F: 0x2421}
_PICTURES |= dict.fromkeys(range(0x80, 0xA0), 0xFFFD)
_KEEP_TABS = {code: picture for code, picture in _PICTURES.items() if code != 0x09}
_INVISIBLE = {"Cf", "Zl", "Zp", "Cs"}

_PREVIEW = 4_000


def count_of(number: int, noun: str) -> str:
    """Return a count in words, such as ``1 row`` or ``1,200 rows``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def join_names(names: Iterable[str]) -> str:
    """Join names with commas; three or more numbered ones in order become ``Bee 1 … Bee 100``."""
    series: list[list[str]] = []
    for name in names:
        if series and name == _successor(series[-1][-1]):
            series[-1].append(name)
        else:
            series.append([name])
    return ", ".join(", ".join(run) if len(run) < 3 else f"{run[0]} … {run[-1]}" for run in series)


def _successor(name: str) -> str | None:
    number = re.search(r"[0-9]+$", name)
    if number is None:
        return None
    return f"{name[: number.start()]}{int(number[0]) + 1:0{len(number[0])}}"


def visible(text: str, *, tabs: bool = False) -> str:
    """Replace each character that a terminal would interpret, keeping the length."""
    text = text.translate(_KEEP_TABS if tabs else _PICTURES)
    if text.isascii():
        return text
    return "".join("\ufffd" if unicodedata.category(c) in _INVISIBLE else c for c in text)


def one_line(text: str) -> str:
    """Return the text on one line: every run of white space becomes one space."""
    return visible(" ".join(text.split()))


def clip(text: str, width: int) -> str:
    """Return at most `width` characters of a text, ending in `…` if it is cut."""
    return text if len(text) <= width else text[: max(width - 1, 0)] + "…"[:width]


def visible_lines(text: str) -> str:
    """Return a text of several lines, cut for a preview and safe to show."""
    return "\n".join(visible(line) for line in text[:_PREVIEW].splitlines())


def align(rows: Sequence[Sequence[str]], right: Collection[int] = ()) -> list[str]:
    """Return rows as lines of aligned columns, two spaces apart; some at the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if n in right else cell.ljust(width)
            for n, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
