"""The terminal's capabilities, as far as the environment tells."""

from __future__ import annotations

import sys
import unicodedata
from codecs import register_error
from collections.abc import Mapping, MutableMapping
from io import TextIOWrapper
from typing import TYPE_CHECKING

from rich.cells import cell_len

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
        name.endswith("-direct") or any(fragment in name for fragment in _TRUECOLOR)
    ):
        environ["COLORTERM"] = "truecolor"


def assume_browser(environ: MutableMapping[str, str], file: object) -> None:
    """Describe a browser's terminal in place, rather than the one that the server runs in."""
    for name in ("STY", "TMUX", "NO_COLOR"):
        environ.pop(name, None)
    environ["TERM"], environ["COLORTERM"] = "xterm-256color", "truecolor"
    if isinstance(file, TextIOWrapper):
        file.reconfigure(encoding="utf-8")


def drawing_for(
    environ: Mapping[str, str], colours: str | None, encoding: str, *, colourless: bool
) -> Drawing:
    """Return the drawing that suits a terminal; `colours` is Rich's name, or None for none."""
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import (
        Drawing,  # slow to load because of numpy
    )

    if colourless or colours not in ("truecolor", "256") or not writes_utf_8(encoding):
        return Drawing.ASCII
    if environ.get("TERM", "").lower().startswith(_POOR_FONTS):
        return Drawing.HALVES
    return Drawing.QUADRANTS


NOT_UTF_8 = "This locale is not UTF-8: all is drawn in ASCII. LANG=C.UTF-8 shows it as it is."


def screen_encoding() -> str:
    """Return the encoding of what the screen is written to."""
    return getattr(sys.__stderr__, "encoding", None) or "utf-8"


def writes_utf_8(encoding: str) -> bool:
    return "utf" in encoding.lower()


def replace_unwritable(file: object) -> None:
    """Let a file write what its encoding lacks as ASCII characters, each as wide as it was."""
    if isinstance(file, TextIOWrapper) and not writes_utf_8(file.encoding):
        register_error(_AS_ASCII, _as_ascii)
        file.reconfigure(errors=_AS_ASCII)


_AS_ASCII = "logical-robots-ascii"
_SIGNS = (
    *((" AND ", "+"), ("HORIZONTAL", "-"), ("VERTICAL", "|"), ("DASH", "-"), ("QUOTATION", '"')),
    *(("BLOCK", "#"), ("SHADE", "#"), ("QUADRANT", "#"), ("SQUARE", "#"), ("LEFT", "<")),
    *(("RIGHT", ">"), ("UP", "^"), ("DOWN", "v"), ("CIRCLE", "o"), ("DOT", "."), ("CHECK", "v")),
)
"""Words in the names of characters, and what resembles these."""


def _as_ascii(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    text = ""
    for character in error.object[error.start : error.end]:
        sign = unicodedata.normalize("NFKD", character)[0]
        if not sign.isascii():
            name = unicodedata.name(character, "")
            default = "?" if character.isalpha() else "*"
            sign = next((sign for word, sign in _SIGNS if word in name), default)
        text += cell_len(character) * sign
    return text, error.end


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
