"""How the panes share the screen."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

__all__ = ["LEAST_HEIGHT", "LEAST_WIDTH", "Grid", "Layout", "Shares", "grid_for", "layout_for"]

LEAST_WIDTH, LEAST_HEIGHT = 40, 12
_WIDE_FROM = (110, 24)
_TALL_FROM = 46
_NARROWEST, _LOWEST = 30, 6
"""Columns and rows, with its border, that a pane keeps whatever the player wishes."""

_WIDEST_TEXT, _HIGHEST_TABLE = 96, 26
"""Columns of the program and rows of the inspector from which on the labyrinth gets the rest."""


class Layout(Enum):
    """Arrangements, by the CSS class that the screen has in them."""

    WIDE = "-wide"
    """All panes at once: the program beside the labyrinth, the inspector below."""
    TALL = "-tall"
    """All panes at once, one below the other."""
    NARROW = "-narrow"
    """One pane at a time, under tabs."""
    TINY = "-tiny"
    """No pane, only the wish for a larger terminal."""

    @property
    def is_roomy(self) -> bool:
        """Whether there is room for all panes."""
        return self in (Layout.WIDE, Layout.TALL)


class Shares(NamedTuple):
    """What the player changed about the sizes of panes.

    Attributes:
        columns: The program is this much wider than by itself.
        rows: The inspector is this much higher than by itself; the program too, where it stands
            below the labyrinth.
    """

    columns: int = 0
    rows: int = 0

    def changed(self, columns: int, rows: int) -> Shares:
        """Give the program more columns, or the inspector more rows."""
        return self._replace(columns=self.columns + columns, rows=self.rows + rows)


class Grid(NamedTuple):
    """Sizes of panes in cells; the labyrinth gets what is left.

    Attributes:
        program: Columns of the program where it stands beside the labyrinth, else its rows.
        inspector: Rows of the inspector.
        shares: What the player changed, as far as there was room for it.
    """

    program: int
    inspector: int
    shares: Shares


def layout_for(width: int, height: int) -> Layout:
    """The arrangement for a terminal of that many columns and rows."""
    if width < LEAST_WIDTH or height < LEAST_HEIGHT:
        return Layout.TINY
    if width >= _WIDE_FROM[0] and height >= _WIDE_FROM[1]:
        return Layout.WIDE
    return Layout.TALL if height >= _TALL_FROM else Layout.NARROW


def grid_for(layout: Layout, width: int, height: int, shares: Shares) -> Grid:
    """The sizes of the panes.

    Args:
        layout: A roomy one.
        width: Columns of the terminal.
        height: Its rows.
        shares: What the player wishes.
    """
    room = height - 2  # status and command bar
    inspector = min(max(round(0.3 * height), 8), _HIGHEST_TABLE)
    if layout is Layout.WIDE:
        program = min(round(width * 4 / 9), _WIDEST_TEXT)
        wider = _within(program + shares.columns, _NARROWEST, width - _NARROWEST)
        higher = _within(inspector + shares.rows, _LOWEST, room - _LOWEST)
        return Grid(wider, higher, Shares(wider - program, higher - inspector))
    program = (room - inspector) // 2
    higher = _within(inspector + shares.rows, _LOWEST, room - program - _LOWEST)
    return Grid(program, higher, Shares(shares.columns, higher - inspector))


def _within(number: int, least: int, most: int) -> int:
    return min(max(number, least), max(most, least))
