"""The theme Night, and the names of the colours that widgets paint with in every theme."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.style import Style
from textual.theme import BUILTIN_THEMES, Theme

from logical_robots_tui.tui.app.facts import NIGHT_NAME
from logical_robots_tui.tui.labyrinth.drawing.palette import DARK, LIGHT, Palette, mix, parse
from logical_robots_tui.tui.terminal.textual_internals import has_active_app
from logical_robots_tui.tui.theme.colours import colours_in

if TYPE_CHECKING:
    from rich.style import Style as RichStyle

__all__ = [
    "INK",
    "NIGHT",
    "SYNTAX",
    "THEMES",
    "Ink",
    "hex_colour",
    "palette_of",
    "rich_style",
    "robot_ink",
]


class Ink:
    """Colours of text that a widget paints itself, as names that the theme gives a meaning."""

    text = "$ink-text"
    dim = "$ink-dim"
    faint = "$ink-faint"
    title = "$ink-title"
    key = "$ink-key"
    good = "$ink-good"
    warn = "$ink-warn"
    bad = "$ink-bad"
    number = "$ink-number"
    string = "$ink-string"
    record = "$ink-record"
    wall = "$ink-wall"
    beacon = "$ink-beacon"
    robot = "$ink-robot"
    nothing = "$ink-nothing"


INK = Ink()

NIGHT = Theme(
    name=NIGHT_NAME,
    dark=True,
    primary="#8fa3f5",
    secondary="#5b6ea8",
    accent="#ffb454",
    foreground="#c3cbe3",
    background="#0b0e14",
    surface="#0f131c",
    panel="#171d2b",
    success="#a6da7b",
    warning="#f2c65f",
    error="#ff7b85",
    variables={
        "border": "#6f83d6",
        "block-cursor-background": "#2c3760",
        "block-cursor-foreground": "#eef1ff",
        "block-cursor-text-style": "none",
        "block-cursor-blurred-background": "#1d2438",
        "block-cursor-blurred-foreground": "#c3cbe3",
        "block-hover-background": "#171d2b",
        "input-cursor-background": "#c3cbe3",
        "input-cursor-foreground": "#0b0e14",
        "input-selection-background": "#33437a",
        "footer-background": "#171d2b",
    },
)

_TONE = 0.4
"""How much of a theme's background is in that of the labyrinth."""

THEMES = (NIGHT.name, *BUILTIN_THEMES)
"""Names of the themes to choose from."""

SYNTAX = {
    "comment": "italic $ink-comment",
    "string": INK.string,
    "number": INK.number,
    "keyword": "$ink-keyword",
    "predicate": "$ink-predicate",
    "annotation": "$ink-annotation",
    "field": "$ink-field",
    "operator": "$ink-operator",
    "mistake": "on $mistake",
    "message": f"italic {INK.text}",
    "odd-gutter": f"bold {INK.warn}",
    "mistake-gutter": f"bold $mistake-ink on {INK.bad}",
}
"""Styles of the pieces of a program, and of what is wrong with it."""


def rich_style(text: str) -> RichStyle:
    """Return a style such as ``bold $ink-key`` with the colours of the present theme.

    Content takes such texts as they are; this is for widgets that paint segments. What is painted
    without an app is painted as in the theme Night.
    """
    if not has_active_app():
        given = NIGHT.to_color_system().generate()
        return Style.parse(text, given | colours_in(NIGHT)).rich_style
    return Style.parse(text).rich_style


def palette_of(theme: Theme) -> Palette:
    """Return the labyrinth's colours that suit a theme: those of night or of day, in its tone."""
    palette = DARK if theme.dark else LIGHT
    if theme.name == NIGHT.name or theme.ansi:
        return palette
    tone = parse(theme.to_color_system().generate()["background"])
    return palette._replace(
        void=mix(palette.void, tone, _TONE),
        floor=mix(palette.floor, tone, _TONE),
        grid=mix(palette.grid, tone, _TONE),
        plate=mix(palette.plate, tone, _TONE),
        rock=mix(palette.rock, tone, _TONE / 2),
    )


def robot_ink(colour: str, palette: Palette) -> str:
    """Return the style of a robot's name where it is text.

    Args:
        colour: As the level gives it.
        palette: The labyrinth's colours in the present theme.
    """
    return hex_colour(palette.strong(parse(colour)))


def hex_colour(colour: tuple[int, int, int]) -> str:
    """Return red, green and blue, each 0 to 255, as ``#rrggbb``."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
