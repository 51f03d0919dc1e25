"""The terminal's capabilities, as far as the environment tells."""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing

_TRUECOLOR = ("alacritty", "contour", "foot", "ghostty", "kitty", "mintty", "rio", "wezterm")
"""Terminals with true colour; sshd passes their name on, but not COLORTERM."""

_POOR_FONTS = ("linux", "vt", "ansi", "cygwin", "dumb")
"""Prefixes of terminals whose fonts may lack quadrants."""


def assume_colours(environ: MutableMapping[str, str]) -> None:
    """Set COLORTERM in place, before the app reads it, if the terminal's name implies it.

    GNU screen (4.9) inherits it, but does not pass true colour on, so there it is removed.
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
    """Return the drawing that suits a terminal; `colours` is Rich's name, or None for none."""
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import (
        Drawing,  # slow to load because of numpy
    )

    if colourless or colours not in ("truecolor", "256") or "utf" not in encoding.lower():
        return Drawing.ASCII
    if environ.get("TERM", "").lower().startswith(_POOR_FONTS):
        return Drawing.HALVES
    return Drawing.QUADRANTS


def may_use_mouse(environ: Mapping[str, str]) -> bool:
    """Return whether to enable the mouse, which delays escape in GNU screen (4.9).

    TERM is ``screen`` or ``screen.xterm`` there, maybe also in tmux; ``screen-256color`` is
    more often tmux.
    """
    name = environ.get("TERM", "").lower()
    if name == "screen" or name.startswith("screen."):
        return "TMUX" in environ and "STY" not in environ
    return not (name.startswith("screen-") and _is_in_screen(environ))


def _is_in_screen(environ: Mapping[str, str]) -> bool:
    return "STY" in environ and "TMUX" not in environ
