"""Cells with text and colours: fitted to dots, written to, compared, and turned into strips."""

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

from logical_robots_tui.tui.labyrinth.drawing.viewport import Floats

if TYPE_CHECKING:
    from numpy.typing import NDArray


RGB: TypeAlias = tuple[int, int, int]
"""Red, green and blue, each 0 to 255."""


class Palette(NamedTuple):
    """All colours that don't come from the level, by default the dark ones.

    If `light`, sensors darken the floor, as ink does. `rim` is the lit edge of walls, `plate`
    behind names, `dead` for robots without charge, `alarm` for blocked ones.
    """

    light: bool = False
    void: RGB = (8, 8, 12)
    floor: RGB = (12, 16, 24)
    grid: RGB = (21, 24, 36)
    rock: RGB = (29, 33, 45)
    rim: RGB = (98, 114, 164)
    beacon: RGB = (255, 214, 102)
    charger: RGB = (94, 234, 212)
    plate: RGB = (12, 14, 20)
    bright: RGB = (244, 246, 252)
    hit_wall: RGB = (255, 107, 107)
    hit_beacon: RGB = (126, 231, 135)
    hit_robot: RGB = (121, 184, 255)
    dead: RGB = (128, 132, 140)
    alarm: RGB = (255, 92, 92)

    def legible(self, colour: RGB) -> RGB:
        brightness = luminance(colour)
        if self.light:
            return mix((0, 0, 0), colour, 0.42 / brightness) if brightness > 0.42 else colour
        return (
            mix((255, 255, 255), colour, (1 - 0.42) / (1 - brightness))
            if brightness < 0.42
            else colour
        )

    def strong(self, colour: RGB) -> RGB:
        return mix(self.bright, self.legible(colour), 0.55)

    def faint(self, colour: RGB) -> RGB:
        """Return a colour for a ghost, which is still seen in light of its own colour."""
        return mix(self.floor, self.strong(colour), 0.75)


DARK = Palette()
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


def mix(first: RGB, second: RGB, share: float) -> RGB:
    """Mix two colours, with ``share`` (0 to 1) of the second."""
    red, green, blue = first
    return (
        round(red + (second[0] - red) * share),
        round(green + (second[1] - green) * share),
        round(blue + (second[2] - blue) * share),
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

MOST_STYLES = 4096  # that are kept: a picture has hundreds, a long game tens of thousands

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

    def changes(self, earlier: Cells) -> list[tuple[int, int, int]]:
        """Return (row, first column, column after the last) of changes; all for another shape."""
        if self.text.shape != earlier.text.shape:
            return [(row, 0, self.text.shape[1]) for row in range(self.text.shape[0])]
        differs = (self.text != earlier.text) | (self.style != earlier.style)
        changes = []
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
            changes.append((row, first, stop))
        return changes

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


@lru_cache(maxsize=MOST_STYLES)
def _style_of(packed: int) -> Style:
    style = Style.from_color(colour_of(packed >> 24 & PAPER), colour_of(packed & PAPER))
    return style + Style(bold=True) if packed & BOLD else style


@lru_cache(maxsize=MOST_STYLES)
def colour_of(number: int) -> RichColor:
    return RichColor.from_rgb(number >> 16, number >> 8 & 0xFF, number & 0xFF)


def _sextant(pattern: int) -> str:
    """Return the block for six dots; four blocks predate Unicode's sextants."""
    had = {0: " ", 21: "▌", 42: "▐", 63: "█"}
    return had.get(pattern) or chr(0x1FAFF + pattern - (pattern > 21) - (pattern > 42))


BLOCKS = {6: "".join(map(_sextant, range(64))), 4: " ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█", 2: " ▀▄█", 1: " "}
"""For a number of dots in a cell the character of each pattern; bit i is dot i, row by row."""

_FLAT = 40.0  # squared error, summed over the dots, below which a cell is given one colour only


def split(image: NDArray[np.uint8], across: int, down: int) -> NDArray[np.uint8]:
    """Return each cell's dots, (cells, down * across, 3), in reading order.

    The image has the shape (rows * down, columns * across, 3).
    """
    rows, columns = image.shape[0] // down, image.shape[1] // across
    cells = image.reshape(rows, down, columns, across, 3).swapaxes(1, 2)
    return cells.reshape(rows * columns, down * across, 3)


def pack(colour: Floats) -> NDArray[np.int64]:
    """Pack colours of shape (..., 3) as 0xRRGGBB, rounded to steps of 4."""
    steps = (colour + 2).astype(np.int64) & 0xFC
    packed: NDArray[np.int64] = steps[..., 0] << 16 | steps[..., 1] << 8 | steps[..., 2]
    return packed


def fit(dots: NDArray[np.uint8]) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Divide each cell's dots, (cells, dots of a cell, 3), into the two best colour groups.

    Returns an index into ``BLOCKS``, ink (lighter) and paper (darker) per cell; blank for about
    one colour.
    """
    cells, count, _ = dots.shape
    by_dot = dots.transpose(1, 0, 2).reshape(count, cells * 3).astype(np.float32)
    total = by_dot.sum(axis=0).reshape(cells, 3)
    mean = total / count
    if count == 1 or not cells:
        return np.zeros(cells, np.int64), mean, mean

    # All ways to split the dots in two, and for each a row of its members.
    patterns = np.arange(1, 2**count - 1, 2, dtype=np.int64)
    members = (patterns[:, None] >> np.arange(count) & 1).astype(np.float32)
    sizes = members.sum(axis=1)[:, None]
    sums = (members @ by_dot).reshape(len(patterns), cells, 3)
    remainder = total - sums
    # What a colour explains is the squared sum over the number of its dots.
    explained = (sums * sums).sum(axis=2) / sizes + (remainder * remainder).sum(axis=2) / (
        count - sizes
    )
    best = explained.argmax(axis=0)
    every = np.arange(cells)
    flat = explained[best, every] - (total * total).sum(axis=1) / count < _FLAT

    size = sizes[best]
    ink, paper, pattern = (
        sums[best, every] / size,
        remainder[best, every] / (count - size),
        patterns[best],
    )
    swap = (ink - paper) @ _BRIGHTNESS < 0
    ink[swap], paper[swap] = paper[swap], ink[swap]
    pattern[swap] ^= 2**count - 1
    pattern[flat] = 0
    ink[flat] = paper[flat] = mean[flat]
    return pattern, ink, paper


_BRIGHTNESS = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


_BLOCK_IDS = {
    count: np.array([text_id(char) for char in chars], np.int64) for count, chars in BLOCKS.items()
}


def refit(cells: Cells, dots: NDArray[np.uint8], which: NDArray[np.int64]) -> None:
    """Fit some cells, by number in reading order, anew in place; `dots` is of all."""
    pattern, ink, paper = fit(dots[which])
    cells.text.ravel()[which] = _BLOCK_IDS[dots.shape[1]][pattern]
    cells.style.ravel()[which] = pack(ink) << 24 | pack(paper)
    cells.tone.ravel()[which] = pack(dots[which].mean(axis=1, dtype=np.float32))
