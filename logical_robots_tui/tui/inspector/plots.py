"""Small plots in characters: a radar, and the values of an expression over many ticks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from textual.content import Content

from logical_robots_tui.schema import SENSOR_RANGE
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.values import Value, spell
from logical_robots_tui.wording import clip, visible

FULL = 20_000
"""Characters after which even the full view of a value ends."""

_WORDS = {"null", "true", "false", ""}


def is_number(value: Value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def cell(value: Value, limit: int = 120) -> tuple[str, str]:
    """A value's text and colour, by kind; text without quotes where that is clear."""
    if isinstance(value, str) and not _could_be_taken_for_another(value):
        return clip(visible(value[: limit + 1]), limit), INK.string
    return ink_value(value, limit)


def ink_value(value: Value, limit: int = 120) -> tuple[str, str]:
    """Return a value in program syntax, in at most `limit` characters, and its colour."""
    if value is None:
        ink = INK.dim
    elif isinstance(value, str):
        ink = INK.string
    else:
        ink = INK.number if isinstance(value, (bool, int, float)) else INK.record
    return format_value(value, limit), ink


def format_value(value: Value, limit: int = FULL) -> str:
    """Return a value in program syntax, in at most `limit` characters."""
    return clip(spell(value, limit, is_rounded=True), limit)


def _could_be_taken_for_another(text: str) -> bool:
    if text in _WORDS or text[0] in '{["' or text != text.strip():
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True


_BRAILLE = 0x2800
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
OBJECT_INKS = {"wall": INK.wall, "beacon": INK.beacon, "robot": INK.robot}

BARS = "▁▂▃▄▅▆▇█"
_PLAIN_BARS = "_.-:=+*#"
_SAME, _OTHER, _NONE, _UNKNOWN = "─", "┼", "·", " "
_PLAIN = {_SAME: "-", _OTHER: "|", _NONE: "."}


def radar_plot(radar: Sequence[Mapping[str, Any]], rows: int) -> list[Content]:
    """Plot a radar, looking up, 4 * rows cells wide; angles in radians, positive to the left."""
    columns = 4 * rows
    across, down = 2 * columns, 4 * rows
    dots: dict[tuple[int, int], int] = {}
    colours: dict[tuple[int, int], str] = {}
    scale = (down - 1) / SENSOR_RANGE

    def put(distance: float, angle: float, colour: str) -> None:
        x = round(across / 2 - math.sin(angle) * distance * scale)
        y = round(down - 1 - math.cos(angle) * distance * scale)
        if 0 <= x < across and 0 <= y < down:
            cell = y // 4, x // 2
            dots[cell] = dots.get(cell, 0) | _DOTS[y % 4][x % 2]
            if colours.get(cell, INK.faint) == INK.faint:
                colours[cell] = colour

    for ray in radar:
        end = float(ray["distance"])
        for step in range(1, 10):
            put(end * step / 10, ray["angle"], INK.faint)
        put(end, ray["angle"], OBJECT_INKS.get(ray["object"], INK.faint))
    colours[rows - 1, columns // 2] = INK.key
    dots[rows - 1, columns // 2] = 0xC0
    places = [[(row, column) for column in range(columns)] for row in range(rows)]
    signs = [
        [(chr(_BRAILLE + dots.get(place, 0)), colours.get(place, INK.faint)) for place in line]
        for line in places
    ]
    return [Content.assemble(*line) for line in signs]


class PlotSample(NamedTuple):
    """The value at one tick; `likeness` is equal for equal values, None for no value."""

    number: float | None
    likeness: int | None


def sparkline(samples: Sequence[PlotSample | None], *, counts: bool, plain: bool = False) -> str:
    """One character per tick: a bar (from 0 with `counts`), or whether other values change.

    Unknown values are None; `plain` means ASCII only.
    """
    bounds = scale(samples, counts=counts)
    bars = _PLAIN_BARS if plain else BARS
    line = []
    for previous, sample in pairwise((None, *samples)):
        if sample is None:
            sign = _UNKNOWN
        elif sample.number is not None and bounds is not None:
            sign = bars[_height(sample.number, *bounds)]
        elif sample.likeness is None:
            sign = _NONE
        else:
            is_same = previous is None or previous.likeness == sample.likeness
            sign = _SAME if is_same else _OTHER
        line.append(_PLAIN.get(sign, sign) if plain else sign)
    return "".join(line)


def scale(samples: Sequence[PlotSample | None], *, counts: bool) -> tuple[float, float] | None:
    numbers = [point.number for point in samples if point is not None and point.number is not None]
    if not numbers:
        return None
    return min([0.0, *numbers] if counts else numbers), max(numbers)


def _height(number: float, low: float, high: float) -> int:
    """Return the bar's index; equal numbers are halfway up, or lowest if they are 0."""
    if low == high:
        return len(BARS) // 2 - 1 if number else 0
    if math.isinf(high - low):
        number, low, high = number / 2, low / 2, high / 2
    share = (number - low) / (high - low)
    return min(int(share * len(BARS)), len(BARS) - 1)
