"""The terminal's capabilities, as far as the environment tells."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, MutableMapping

    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing

_TRUECOLOR = ("alacritty", "contour", "foot", "ghostty", "kitty", "mintty", "rio", "wezterm")
"""Terminals with true colour; sshd passes their name on, but not COLORTERM."""

_POOR_FONTS = ("linux", "vt", "ansi", "cygwin", "dumb")
"""Prefixes of terminals whose fonts may lack quadrants."""


def assume_colours(environ: MutableMapping[str, str]) -> None:
    """Set COLORTERM if the terminal's name implies true colour.

    In GNU screen it is removed: there it is that of the terminal around, which screen (4.9) does
    not pass true colour on to. `environ` is changed in place, before the app reads it.
    """
    name = environ.get("TERM", "").lower()
    if _is_in_screen(environ):
        environ.pop("COLORTERM", None)
    elif "COLORTERM" not in environ and (
        name.endswith("-direct") or any(known in name for known in _TRUECOLOR)
    ):
        environ["COLORTERM"] = "truecolor"


def drawing_for(
    environ: Mapping[str, str], colours: str | None, encoding: str, *, colourless: bool
) -> Drawing:
    """Return the drawing that suits a terminal.

    `colours` is what it can show, in Rich's words, such as ``truecolor``; None for no colours.
    """
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import (
        Drawing,  # slow to load because of numpy
    )

    if colourless or colours not in ("truecolor", "256") or "utf" not in encoding.lower():
        return Drawing.ASCII
    if environ.get("TERM", "").lower().startswith(_POOR_FONTS):
        return Drawing.HALVES
    return Drawing.QUADRANTS


def may_use_mouse(environ: Mapping[str, str]) -> bool:
    """Return whether to enable the mouse.

    GNU screen (4.9) delays the escape key until the next key while the mouse is enabled.

    TERM is ``screen`` or ``screen.xterm`` there. In tmux it may be the same, and
    ``screen-256color`` is more often tmux than GNU screen.
    """
    name = environ.get("TERM", "").lower()
    if name == "screen" or name.startswith("screen."):
        return "TMUX" in environ and "STY" not in environ
    return not (name.startswith("screen-") and _is_in_screen(environ))


def _is_in_screen(environ: Mapping[str, str]) -> bool:
    return "STY" in environ and "TMUX" not in environ
