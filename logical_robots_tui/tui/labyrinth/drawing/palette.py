"""Colours of the labyrinth, for dark and for light themes."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple, TypeAlias

from textual.color import Color, ColorParseError

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
        """Return a colour legible as text."""
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


def packed(colour: RGB) -> int:
    """Return a colour as 0xRRGGBB."""
    red, green, blue = colour
    return red << 16 | green << 8 | blue


def hex_colour(colour: RGB) -> str:
    return "#{:02x}{:02x}{:02x}".format(*colour)
