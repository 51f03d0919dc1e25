"""What the present screen is painted with, for the outline of the next start."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import COLOR_SYSTEMS
from textual.color import Color

from logical_robots_tui.tui.app.dress import Dress
from logical_robots_tui.tui.commands.keymap import command
from logical_robots_tui.tui.terminal.cell_diff import codes_of
from logical_robots_tui.tui.theme.themes import hex_colour, palette_of

if TYPE_CHECKING:
    from textual.app import App

__all__ = ["dress_of"]


def dress_of(app: App[None], colours: str) -> Dress | None:
    """Return what an app is painted with, or None where an outline could not be painted so.

    Args:
        app: With its theme.
        colours: What the terminal can show, as an outline takes it to be.
    """
    theme = app.current_theme
    if (
        app.no_color
        or colours != app.console.color_system
        or (theme.ansi and not app.native_ansi_color)
    ):
        return None
    variables = app.theme_variables
    painted = {
        **{
            name: variables[name]
            for name in ("background", "surface", "panel", "frame", "frame-here")
        },
        **{name: variables[f"ink-{name}"] for name in ("title", "dim", "key")},
        "void": hex_colour(palette_of(theme).void),
        "here": variables["tab-here"],
    }
    below = Color.parse(variables["background"])
    rich = {name: _over(below, Color.parse(value)).rich_color for name, value in painted.items()}
    system = COLOR_SYSTEMS[colours]
    return Dress(
        {
            name: (
                codes_of(colour, system, is_ink=True),
                codes_of(colour, system, is_ink=False),
            )
            for name, colour in rich.items()
        },
        (command("labyrinth").key_name, command("editor").key_name),
    )


def _over(below: Color, colour: Color) -> Color:
    """A colour as it is seen; that of a theme for few colours may be none at all."""
    return below if colour.is_transparent else colour
