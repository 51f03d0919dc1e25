"""Colours for terminals that have fewer of them."""

from __future__ import annotations

from functools import lru_cache

from rich.color import Color, ColorSystem, ColorType

__all__ = ["reduced"]

_LEVELS = (0, 95, 135, 175, 215, 255)
"""Values of a channel in the colour cube of 256 colours."""

_FOR_A_HUE = 5
"""How many times as wrong a colour may be as a grey, to keep its hue."""

_GREYS = tuple(8 + 10 * step for step in range(24))


@lru_cache(maxsize=40_000)
def reduced(color: Color, colours: ColorSystem) -> Color:
    """Return the colour of a terminal that comes nearest to one.

    With 256 colours the nearest by sight: among dark ones the cube has only black, so the ramp of
    greys, which has many, is asked as well, and a hue counts for more than in Rich's own choice.
    """
    if color.type != ColorType.TRUECOLOR or colours != ColorSystem.EIGHT_BIT:
        return color.downgrade(colours)
    assert color.triplet is not None
    wanted = color.triplet
    cube = [min(range(6), key=lambda n: abs(_LEVELS[n] - value)) for value in wanted]
    # A channel that leads must not drown: it gets the first level of the cube.
    strongest = max(wanted)
    if 40 <= strongest < 75 and strongest - min(wanted) >= 22:
        cube = [
            1 if value == strongest else level for value, level in zip(wanted, cube, strict=True)
        ]
    grey = min(range(24), key=lambda n: sum((_GREYS[n] - value) ** 2 for value in wanted))
    colourful = sum((_LEVELS[n] - value) ** 2 for n, value in zip(cube, wanted, strict=True))
    plain = sum((_GREYS[grey] - value) ** 2 for value in wanted)
    is_hue = strongest - min(wanted) >= 22 and colourful <= _FOR_A_HUE * plain
    if plain < colourful and not is_hue:
        return Color.from_ansi(232 + grey)
    red, green, blue = cube
    if red == green == blue and plain < colourful:
        return Color.from_ansi(232 + grey)
    return Color.from_ansi(16 + 36 * red + 6 * green + blue)
