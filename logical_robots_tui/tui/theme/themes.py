"""Themes: our own, and the names of the colours that widgets paint with, legible in every theme."""

from __future__ import annotations

from functools import cache
from typing import Any

from rich.style import Style as RichStyle
from textual.app import App
from textual.color import Color
from textual.style import Style
from textual.theme import Theme

from logical_robots_tui.tui.labyrinth.drawing.cells import (
    DARK,
    LIGHT,
    Palette,
    hex_colour,
    mix,
    parse,
)

_READABLE, _QUIET, _FAINT, _SHADE = 4.5, 3.6, 2.4, 1.2
"""Contrasts (WCAG 2) of text, secondary text, lines, and shades."""

_HIGHLIGHTED = 3.0  # the contrast that is enough on a highlighted row

_HUES = {
    "number": "#86cfe0",
    "string": "#b5d99c",
    "record": "#c9b8f0",
    "wall": "#e8767c",
    "beacon": "#7ee787",
    "robot": "#79b8ff",
    "comment": "#7781a4",
    "keyword": "#c792ea",
    "predicate": "#82aaff",
    "annotation": "#ffb454",
    "field": "#8fd3c8",
    "operator": "#93a0c8",
}
"""Colours with a fixed meaning, as in the theme Night."""

_NIGHT = {
    "ink-dim": "#7781a4",
    "ink-faint": "#47527a",
    "ink-title": "#9db0ff",
    "ink-nothing": "#2b3350",
    "frame": "#2a3149",
    "frame-here": "#6f83d6",
    "bar": "#262d42",
    "bar-held": "#4b578a",
    "row": "#151b2a",
    "here": "#2c3760",
    "here-ink": "#eef1ff",
    "tab-here": "#232b45",
    "selection": "#33437a",
    "bracket": "#3b4464",
    "mistake-strip": "#2a1820",
    "odd-strip": "#26221a",
}
"""Hand-picked colours of our own theme."""

_ANSI = {
    "ink-text": "ansi_default",
    "ink-dim": "ansi_default",
    "ink-faint": "ansi_bright_black",
    "ink-title": "ansi_bright_blue",
    "ink-entry": "ansi_default",
    "ink-key": "ansi_yellow",
    "ink-good": "ansi_green",
    "ink-warn": "ansi_yellow",
    "ink-bad": "ansi_red",
    "ink-nothing": "ansi_bright_black",
    "ink-number": "ansi_cyan",
    "ink-string": "ansi_green",
    "ink-record": "ansi_bright_magenta",
    "ink-wall": "ansi_red",
    "ink-beacon": "ansi_green",
    "ink-robot": "ansi_bright_blue",
    "ink-comment": "ansi_bright_black",
    "ink-keyword": "ansi_bright_magenta",
    "ink-predicate": "ansi_bright_blue",
    "ink-annotation": "ansi_yellow",
    "ink-field": "ansi_cyan",
    "ink-operator": "ansi_default",
    "frame": "ansi_bright_black",
    "frame-here": "ansi_blue",
    "bar": "ansi_bright_black",
    "bar-held": "ansi_default",
    "row": "ansi_default",
    "here": "ansi_blue",
    "here-ink": "ansi_bright_white",
    "tab-here": "ansi_default",
    "selection": "ansi_blue",
    "bracket": "ansi_bright_black",
    "mistake-ink": "ansi_bright_white",
    "mistake-strip": "ansi_default",
    "odd-strip": "ansi_default",
}
"""The terminal's own colours, for themes that use no others."""


def colours_in(theme: Theme) -> dict[str, str]:
    """Return our variables for a theme, such as ``ink-title``, as Textual writes colours.

    Hues of values, objects and Logica are the same in all themes, with adjusted lightness.
    """
    if theme.ansi:
        return dict(_ANSI)
    theme_colours = theme.to_color_system().generate()
    papers = [Color.parse(theme_colours[name]) for name in ("background", "surface", "panel")]
    text, surface = Color.parse(theme_colours["foreground"]), papers[1]

    def tinted(colour: str, share: float) -> str:
        return surface.blend(Color.parse(colour), share, alpha=1).hex6

    highlight = tinted(theme_colours["primary"], 0.3)

    def legible(colour: str, ratio: float = _READABLE) -> str:
        ink = _legible(Color.parse(colour), papers, ratio, dark=theme.dark)
        on_highlight = min(ratio, _HIGHLIGHTED)
        return _legible(ink, [Color.parse(highlight)], on_highlight, dark=theme.dark).hex6

    colours = {f"ink-{name}": legible(hue) for name, hue in _HUES.items()}
    grey = surface.blend(text, 0.5, alpha=1).hex6
    colours |= {
        "ink-text": legible(text.hex6),
        "ink-dim": legible(grey, _QUIET),
        "ink-comment": legible(grey, _QUIET),
        "ink-faint": legible(tinted(text.hex6, 0.2), _FAINT),
        "ink-nothing": legible(tinted(text.hex6, 0.15), _SHADE),
        "ink-title": legible(theme_colours["primary"]),
        "ink-key": legible(theme_colours["accent"]),
        "ink-good": legible(theme_colours["success"]),
        "ink-warn": legible(theme_colours["warning"]),
        "ink-bad": legible(theme_colours["error"]),
        "frame": tinted(text.hex6, 0.25),
        "frame-here": legible(theme.variables.get("border", theme_colours["border"]), _HIGHLIGHTED),
        "bar": tinted(text.hex6, 0.2),
        "bar-held": tinted(text.hex6, 0.45),
        "row": tinted(text.hex6, 0.06),
        "here": highlight,
        "here-ink": _legible(text, [Color.parse(highlight)], _READABLE, dark=theme.dark).hex6,
        "tab-here": tinted(theme_colours["primary"], 0.2),
        "selection": tinted(theme_colours["primary"], 0.3),
        "bracket": tinted(text.hex6, 0.25),
        "mistake-ink": theme_colours["surface"],
        "mistake-strip": tinted(theme_colours["error"], 0.1),
        "odd-strip": tinted(theme_colours["warning"], 0.1),
    }
    if theme.name == NIGHT.name:
        colours |= _NIGHT | {f"ink-{name}": hue for name, hue in _HUES.items()}
    return colours | {"ink-entry": colours["ink-title"]}


def contrast(first: Color, second: Color) -> float:
    """Return the contrast of two colours, by WCAG 2, from 1 to 21."""
    brighter, darker = sorted((_luminance(first), _luminance(second)), reverse=True)
    return (brighter + 0.05) / (darker + 0.05)


def _legible(colour: Color, papers: list[Color], ratio: float, *, dark: bool) -> Color:
    """Return a colour of the same hue with enough contrast to all backgrounds, if possible."""
    hue, lightness, saturation = colour.hsl.h, colour.hsl.l, colour.hsl.s
    while min(contrast(colour, paper) for paper in papers) < ratio and 0 < lightness < 1:
        lightness = min(lightness + 0.02, 1.0) if dark else max(lightness - 0.02, 0.0)
        colour = Color.from_hsl(hue, saturation, lightness)
    return colour


def _luminance(colour: Color) -> float:
    channels = [
        value / 12.92 if value <= 0.03928 else ((value + 0.055) / 1.055) ** 2.4
        for value in colour.normalized
    ]
    return sum(
        weight * value for weight, value in zip((0.2126, 0.7152, 0.0722), channels, strict=True)
    )


class Ink:
    """Colours of text painted by widgets, as names that the theme defines."""

    text = "$ink-text"
    dim = "$ink-dim"
    faint = "$ink-faint"
    title = "$ink-title"
    entry = "$ink-entry"
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
    name="night",
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


def use_theme(app: App[Any], name: str) -> None:
    """Set an app's theme: the one of that name, or by default one that suits the terminal."""
    app.register_theme(NIGHT)
    if not name and app.console.color_system == "standard" and not app.no_color:
        name = "ansi-dark"  # of dark colours among 16 there would be only black
    app.theme = name if name in app.available_themes else NIGHT.name


_TONE = 0.4  # the share of a theme's background in that of the labyrinth

SYNTAX = {
    "comment": "italic $ink-comment",
    "string": INK.string,
    "number": INK.number,
    "keyword": "$ink-keyword",
    "predicate": "$ink-predicate",
    "annotation": "$ink-annotation",
    "field": "$ink-field",
    "operator": "$ink-operator",
    "mistake": f"underline {INK.bad}",
    "odd": f"underline {INK.warn}",
    "odd-gutter": f"bold {INK.warn}",
    "mistake-gutter": f"bold $mistake-ink on {INK.bad}",
}
"""Styles of program text and of errors."""


def rich_style(text: str) -> RichStyle:
    """Return ``bold $ink-key`` and such in the current theme, or Night without an app.

    For widgets that paint segments; Content resolves such names itself.
    """
    # In an app, Textual takes the colours of its theme rather than these.
    return Style.parse(text, _night_colours()).rich_style


@cache
def _night_colours() -> dict[str, str]:
    return NIGHT.to_color_system().generate() | colours_in(NIGHT)


def palette_of(theme: Theme) -> Palette:
    """Return the colours of the labyrinth; beside the map it has the background of the panes."""
    if theme.name == NIGHT.name:
        return _NIGHT_PALETTE
    palette = DARK if theme.dark else LIGHT
    if theme.ansi:
        return palette
    if theme.name not in _PALETTES:
        theme_colours = theme.to_color_system().generate()
        tone = parse(theme_colours["background"])
        _PALETTES[theme.name] = palette._replace(
            void=parse(theme_colours["surface"]),
            floor=mix(palette.floor, tone, _TONE),
            grid=mix(palette.grid, tone, _TONE),
            plate=mix(palette.plate, tone, _TONE),
            rock=mix(palette.rock, tone, _TONE / 2),
        )
    return _PALETTES[theme.name]


_NIGHT_PALETTE = DARK._replace(void=(16, 20, 28))  # the surface, in steps of 4
_PALETTES: dict[str, Palette] = {}
"""What `palette_of` has returned, because it takes 0.7 ms and is asked in every picture."""


def robot_ink(colour: str, palette: Palette) -> str:
    return hex_colour(palette.strong(parse(colour)))
