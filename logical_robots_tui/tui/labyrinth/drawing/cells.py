"""Cells with text and colours, and the strips that show them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from rich.color import Color as RichColor
from rich.segment import Segment
from rich.style import Style
from textual.color import Color, ColorParseError
from textual.strip import Strip

if TYPE_CHECKING:
    from numpy.typing import NDArray


RGB: TypeAlias = tuple[int, int, int]
"""Red, green and blue, each 0 to 255."""


class Palette(NamedTuple):
    """All colours that don't come from the level.

    If `light`, sensors darken the floor, as ink does. `rim` is the lit edge of walls, `plate`
    behind names, `dead` for robots without charge, `alarm` for blocked ones.
    """

    light: bool
    void: RGB
    floor: RGB
    grid: RGB
    rock: RGB
    rim: RGB
    beacon: RGB
    charger: RGB
    plate: RGB
    bright: RGB
    hit_wall: RGB
    hit_beacon: RGB
    hit_robot: RGB
    dead: RGB
    alarm: RGB

    def legible(self, colour: RGB) -> RGB:
        seen = luminance(colour)
        if self.light:
            return mix((0, 0, 0), colour, 0.42 / seen) if seen > 0.42 else colour
        return mix((255, 255, 255), colour, (1 - 0.42) / (1 - seen)) if seen < 0.42 else colour

    def strong(self, colour: RGB) -> RGB:
        return mix(self.bright, self.legible(colour), 0.55)


DARK = Palette(
    light=False,
    void=(8, 8, 12),
    floor=(12, 16, 24),
    grid=(21, 24, 36),
    rock=(29, 33, 45),
    rim=(98, 114, 164),
    beacon=(255, 214, 102),
    charger=(94, 234, 212),
    plate=(12, 14, 20),
    bright=(244, 246, 252),
    hit_wall=(255, 107, 107),
    hit_beacon=(126, 231, 135),
    hit_robot=(121, 184, 255),
    dead=(128, 132, 140),
    alarm=(255, 92, 92),
)

LIGHT = Palette(
    light=True,
    void=(222, 225, 231),
    floor=(252, 252, 249),
    grid=(238, 239, 240),
    rock=(203, 208, 219),
    rim=(104, 117, 158),
    beacon=(163, 106, 0),
    charger=(0, 124, 112),
    plate=(252, 252, 249),
    bright=(16, 18, 28),
    hit_wall=(200, 36, 36),
    hit_beacon=(24, 128, 44),
    hit_robot=(20, 96, 200),
    dead=(128, 132, 140),
    alarm=(200, 30, 30),
)


@lru_cache(maxsize=256)
def parse(text: str, fallback: RGB = (150, 160, 180)) -> RGB:
    """Read a CSS name, ``#rgb``, ``#rrggbb``, ``rgb()`` or ``hsl()``, without transparency."""
    try:
        return Color.parse(text.strip()).rgb
    except (ColorParseError, ValueError):
        return fallback


def luminance(colour: RGB) -> float:
    """Return how bright a colour looks, 0 to 1 (ITU-R BT.709 weights on the encoded values)."""
    red, green, blue = colour
    return (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255


def mix(one: RGB, other: RGB, share: float) -> RGB:
    """Mix two colours, with ``share`` (0 to 1) of the second."""
    red, green, blue = one
    return (
        round(red + (other[0] - red) * share),
        round(green + (other[1] - green) * share),
        round(blue + (other[2] - blue) * share),
    )


def rgb_number(colour: RGB) -> int:
    """Return a colour as 0xRRGGBB."""
    red, green, blue = colour
    return red << 16 | green << 8 | blue


def hex_colour(colour: RGB) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)


BOLD = 1 << 48
"""Added to the style of a cell, which else is ``ink << 24 | paper``, each 0xRRGGBB."""

PAPER = 0xFFFFFF
"""The part of a packed style that is the colour behind the text."""

_texts: list[str] = []
_text_ids: dict[str, int] = {}


def text_id(text: str) -> int:
    number = _text_ids.get(text)
    if number is None:
        number = _text_ids[text] = len(_texts)
        _texts.append(text)
    return number


CONTINUED = text_id("")
"""The right half of a character two cells wide."""
_BLANK = text_id(" ")


class Cells:
    """Rows of cells: numbers of texts, packed styles, and tones, all of shape (rows, columns).

    The tone, 0xRRGGBB, is a cell's look from afar: the paper for a character put on it.
    """

    def __init__(
        self, text: NDArray[np.int64], style: NDArray[np.int64], tone: NDArray[np.int64]
    ) -> None:
        self.text = text
        self.style = style
        self.tone = tone

    @classmethod
    def blank(cls, rows: int, columns: int) -> Cells:
        shape = rows, columns
        zeros = np.zeros(shape, np.int64)
        return cls(np.full(shape, _BLANK, np.int64), zeros, zeros.copy())

    def copy(self) -> Cells:
        return Cells(self.text.copy(), self.style.copy(), self.tone.copy())

    def put(
        self, row: int, column: int, text: str, ink: int, paper: int = -1, bold: bool = False
    ) -> None:
        """Write a text of width 1; colours are 0xRRGGBB, by default on the cell's tone."""
        self.text[row, column] = text_id(text)
        paper = int(self.tone[row, column]) if paper < 0 else paper
        self.style[row, column] = ink << 24 | paper | (BOLD if bold else 0)

    def put_all(
        self,
        rows: NDArray[np.int64],
        columns: NDArray[np.int64],
        texts: NDArray[np.int64],
        inks: NDArray[np.int64],
        bold: NDArray[np.int64] | int,
    ) -> None:
        """Write texts of width 1 onto the tones of cells; the last one in a cell stays.

        All arrays have the shape (n,); inks are 0xRRGGBB, `bold` is `BOLD` for all or some, else 0.
        """
        self.text[rows, columns] = texts
        self.style[rows, columns] = inks << 24 | self.tone[rows, columns] | bold

    def changes(self, earlier: Cells) -> list[tuple[int, int, int]]:
        """Return (row, first column, column after the last) of changes; all for another shape."""
        if self.text.shape != earlier.text.shape:
            return [(row, 0, self.text.shape[1]) for row in range(self.text.shape[0])]
        differs = (self.text != earlier.text) | (self.style != earlier.style)
        found = []
        width = differs.shape[1]
        for row in np.flatnonzero(differs.any(axis=1)).tolist():
            columns = np.flatnonzero(differs[row])
            first, stop = int(columns[0]), int(columns[-1]) + 1
            # A wide character changes as a whole, before and after.
            halves = (self.text[row] == CONTINUED) | (earlier.text[row] == CONTINUED)
            while first and halves[first]:
                first -= 1
            while stop < width and halves[stop]:
                stop += 1
            found.append((row, first, stop))
        return found

    def strip(self, row: int) -> Strip:
        """Return a row to show, with as few style changes as possible."""
        styles = self.style[row]
        chars = [_texts[number] for number in self.text[row].tolist()]
        if not chars:
            return Strip([], 0)
        starts = [0, *(np.flatnonzero(styles[1:] != styles[:-1]) + 1).tolist()]
        segments: list[Segment] = []
        run, run_style, run_blank = "", 0, False
        for start, stop, style in zip(
            starts, [*starts[1:], len(chars)], styles[starts].tolist(), strict=True
        ):
            text = "".join(chars[start:stop])
            blank = text.isspace()
            # A blank looks the same in any ink.
            alike = (blank or run_blank) and (style ^ run_style) & PAPER == 0
            if run and (alike or style == run_style):
                run += text
                run_style = style if run_blank else run_style
                run_blank = run_blank and blank
            elif text:
                if run:
                    segments.append(Segment(run, _style_of(run_style)))
                run, run_style, run_blank = text, style, blank
        segments.append(Segment(run, _style_of(run_style)))
        return Strip(segments, len(chars))

    def row(self, row: int, first: int, stop: int) -> Iterator[tuple[str, int]]:
        texts = map(_texts.__getitem__, self.text[row, first:stop].tolist())
        return zip(texts, self.style[row, first:stop].tolist(), strict=True)

    def is_cut(self, row: int, column: int) -> bool:
        return column < self.text.shape[1] and bool(self.text[row, column] == CONTINUED)

    def plain(self) -> Sequence[str]:
        return ["".join(_texts[number] for number in line) for line in self.text.tolist()]


@lru_cache(maxsize=20_000)
def _style_of(packed: int) -> Style:
    style = Style.from_color(colour_of(packed >> 24 & PAPER), colour_of(packed & PAPER))
    return style + Style(bold=True) if packed & BOLD else style


@lru_cache(maxsize=8192)
def colour_of(number: int) -> RichColor:
    return RichColor.from_rgb(number >> 16, number >> 8 & 0xFF, number & 0xFF)
