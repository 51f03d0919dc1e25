"""Colours of the screen around the labyrinth."""

from __future__ import annotations

from rich.style import Style
from textual.theme import Theme

__all__ = ["EXTRA_VARIABLES", "INK", "NIGHT", "SYNTAX", "Ink"]


class Ink:
    """Colours of text that a widget paints itself."""

    text = "#c3cbe3"
    dim = "#6b7596"
    faint = "#424c70"
    title = "#9db0ff"
    key = "#ffb454"
    good = "#a6da7b"
    warn = "#f2c65f"
    bad = "#ff7b85"
    number = "#86cfe0"
    string = "#b5d99c"
    record = "#c9b8f0"
    wall = "#e8767c"
    beacon = "#7ee787"
    robot = "#79b8ff"
    nothing = "#2b3350"


INK = Ink()

NIGHT = Theme(
    name="night",
    dark=True,
    primary="#8fa3f5",
    secondary="#5b6ea8",
    accent=INK.key,
    foreground=INK.text,
    background="#0b0e14",
    surface="#0f131c",
    panel="#171d2b",
    success=INK.good,
    warning=INK.warn,
    error=INK.bad,
    variables={
        "border": "#6f83d6",
        "border-blurred": "#2a3149",
        "block-cursor-background": "#2c3760",
        "block-cursor-foreground": "#eef1ff",
        "block-cursor-text-style": "none",
        "block-cursor-blurred-background": "#1d2438",
        "block-cursor-blurred-foreground": INK.text,
        "block-hover-background": "#171d2b",
        "input-cursor-background": "#c3cbe3",
        "input-cursor-foreground": "#0b0e14",
        "input-selection-background": "#33437a",
        "scrollbar": "#262d42",
        "scrollbar-hover": "#38415f",
        "scrollbar-active": "#4b578a",
        "scrollbar-background": "#0f131c",
        "scrollbar-background-hover": "#0f131c",
        "scrollbar-background-active": "#0f131c",
        "scrollbar-corner-color": "#0f131c",
        "footer-background": "#171d2b",
    },
)

EXTRA_VARIABLES = {"dim": INK.dim, "faint": INK.faint, "title": INK.title}
"""Variables of our own style sheets, whatever the theme."""

SYNTAX = {
    "comment": Style(color=INK.dim, italic=True),
    "string": Style(color=INK.string),
    "number": Style(color=INK.number),
    "keyword": Style(color="#c792ea"),
    "predicate": Style(color="#82aaff"),
    "annotation": Style(color=INK.key),
    "field": Style(color="#8fd3c8"),
    "operator": Style(color="#93a0c8"),
    "mistake": Style(bgcolor="#4a1f2b"),
    "odd-gutter": Style(color=INK.warn, bold=True),
    "mistake-gutter": Style(color="#0b0e14", bgcolor=INK.bad, bold=True),
}
