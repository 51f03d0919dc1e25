"""The outline of the first picture, which stands while the screen is still being loaded.

It is drawn where it is known to look as the picture will: as at the last start, or in the game's
own theme for a player who has configured nothing. A test compares the two.
"""

from __future__ import annotations

import os
import signal
import sys
from typing import TYPE_CHECKING

from logical_robots_tui.paths import is_there
from logical_robots_tui.progress import FILE_NAME
from logical_robots_tui.progress.glance import facts_in
from logical_robots_tui.tui.app.dress import NIGHT, NIGHT_NAME, Dress, dress_from, stamp_for
from logical_robots_tui.tui.app.facts import DRESS, THEME, settings_path
from logical_robots_tui.tui.layout.layout import Layout, Shares, grid_for, layout_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

__all__ = ["ENTER", "LEAVE", "OUTLINE", "Outline", "colours_of", "drawn"]

ENTER, LEAVE = "\x1b[?1049h", "\x1b[?1049l"
"""To the alternate screen, and back."""

_HIDE_CURSOR, _SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"

_ROOM_FOR_TABS = 67
"""Columns from which on a program's name, however long, is not left out."""


def drawn(columns: int, rows: int, dress: Dress) -> str:
    """Return what draws the outline on an alternate screen, or "" in a terminal without room.

    Args:
        columns: The terminal's width.
        rows: Its height.
        dress: What to paint with.
    """
    layout = layout_for(columns, rows)
    if layout is Layout.TINY:
        return ""
    paint = _Paint(dress)
    lines = (
        *paint.blank(0, 0, columns, 1, "panel"),
        *paint.blank(0, 1, columns, rows - 1, "background"),
        *paint.blank(0, rows - 1, columns, rows, "panel"),
    )
    if layout is Layout.NARROW:
        panes = _tabs(paint, columns, rows)
    else:
        panes = _panes(paint, layout, columns, rows)
    return "".join((*lines, *panes, "\x1b[0m\x1b[H"))


def _tabs(paint: _Paint, columns: int, rows: int) -> Iterator[str]:
    """The line with the names of panes, and the labyrinth below it."""
    here, other = paint.dress.keys
    yield f"\x1b[2;2H{paint('key', 'here', bold=True)} {here} "
    yield f"{paint('title', 'here', bold=True)}Labyrinth "
    if columns >= _ROOM_FOR_TABS:
        yield f"{paint('key', 'background')}  {other} {paint('dim', 'background')}Program"
    yield from paint.blank(0, 2, columns, rows - 2, "void")


def _panes(paint: _Paint, layout: Layout, columns: int, rows: int) -> Iterator[str]:
    """The borders of the panes, with their titles."""
    grid = grid_for(layout, columns, rows, Shares())
    stop = rows - 2  # timeline and command bar
    last = stop - grid.inspector
    if layout is Layout.WIDE:
        beside = columns - grid.program
        yield from paint.box(0, 1, beside, last, "Labyrinth")
        yield from paint.box(beside, 1, columns, last, "Program")
    else:
        below = 1 + (last - 1) // 2
        yield from paint.box(0, 1, columns, below, "Labyrinth")
        yield from paint.box(0, below, columns, last, "Program")
    yield from paint.box(0, last, columns, stop, "Inspector")


class _Paint:
    """Writes in the theme's colours."""

    def __init__(self, dress: Dress) -> None:
        self.dress = dress

    def __call__(self, ink: str, paper: str, *, bold: bool = False) -> str:
        colours = self.dress.colours
        return f"\x1b[0;{'1;' * bold}{colours[ink][0]};{colours[paper][1]}m"

    def blank(self, left: int, top: int, right: int, bottom: int, paper: str) -> Iterator[str]:
        """Nothing but paper, from a column and a row to before others."""
        yield self("dim", paper)
        for row in range(top, bottom):
            yield f"\x1b[{row + 1};{left + 1}H\x1b[{right - left}X"

    def box(self, left: int, top: int, right: int, bottom: int, title: str) -> Iterator[str]:
        """A pane, from its first column and row to before others."""
        is_first = title == "Labyrinth"  # where the player begins
        inside = left + 1, top + 1, right - 1, bottom - 1
        yield from self.blank(*inside, "void" if is_first else "surface")
        line = self("frame-here" if is_first else "frame", "surface")
        name = self("title" if is_first else "dim", "surface")
        width = right - left - 2
        rest = "─" * (width - len(title) - 3)
        yield f"\x1b[{top + 1};{left + 1}H{line}╭─ {name}{title}{line} {rest}╮"
        for row in range(top + 1, bottom - 1):
            yield f"\x1b[{row + 1};{left + 1}H│\x1b[{width}C│"
        yield f"\x1b[{bottom};{left + 1}H╰{'─' * width}╯"


def colours_of(environ: Mapping[str, str]) -> str:
    """Return what Rich will find: ``truecolor``, ``256``, ``standard``; or "" if in doubt."""
    if "NO_COLOR" in environ or "TEXTUAL_COLOR_SYSTEM" in environ:
        return ""
    if environ.get("COLORTERM", "").strip().lower() in ("truecolor", "24bit"):
        return "truecolor"
    term = environ.get("TERM", "").lower()
    if term.endswith(("-256color", "-kitty")):
        return "256"
    return "" if term in ("", "dumb", "unknown") else "standard"


def _dress_for(colours: str, data_dir: Path) -> Dress | None:
    """What the picture will be painted with, if that is known."""
    facts = facts_in(data_dir / FILE_NAME, THEME, DRESS)
    if facts is None:
        return None
    theme, kept = facts
    if theme in ("", NIGHT_NAME) and not is_there(settings_path()) and colours in NIGHT:
        return NIGHT[colours]
    return dress_from(kept, stamp_for(colours, theme))


class Outline:
    """The outline on the terminal of this process, until the screen takes its place."""

    def __init__(self) -> None:
        self._stands = False

    def show(self, data_dir: Path) -> None:
        """Show it, if it is certain what the picture will look like.

        Args:
            data_dir: Where the player's progress is.
        """
        colours = colours_of(os.environ)
        terminal = sys.__stderr__  # Textual's, too
        if not colours or terminal is None or "utf" not in terminal.encoding.lower():
            return
        dress = _dress_for(colours, data_dir)
        if dress is None:
            return
        text = drawn(*os.get_terminal_size(terminal.fileno()), dress)
        if text:
            signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
            self._stands = True
            terminal.write(f"{ENTER}{_HIDE_CURSOR}{text}")
            terminal.flush()

    def hand_over(self) -> bool:
        """Leave the terminal to the screen; whether it is on its alternate screen already."""
        stood, self._stands = self._stands, False
        return stood

    def clear(self) -> None:
        """Leave no trace, if the screen has not come."""
        if self.hand_over() and sys.__stderr__ is not None:
            sys.__stderr__.write(f"\x1b[0m{LEAVE}{_SHOW_CURSOR}")
            sys.__stderr__.flush()


OUTLINE = Outline()
"""That of this process, which has one terminal."""
