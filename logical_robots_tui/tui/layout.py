"""How the panes share the screen."""

from __future__ import annotations

from enum import Enum

__all__ = ["LEAST_HEIGHT", "LEAST_WIDTH", "Layout", "layout_for"]

LEAST_WIDTH, LEAST_HEIGHT = 40, 12
_WIDE_FROM = (110, 24)


class Layout(Enum):
    """Arrangements, by the CSS class that the screen has in them."""

    WIDE = "-wide"
    """All panes at once."""
    NARROW = "-narrow"
    """One pane at a time, under tabs."""
    TINY = "-tiny"
    """No pane, only the wish for a larger terminal."""


def layout_for(width: int, height: int) -> Layout:
    """The arrangement for a terminal of that many columns and rows."""
    if width < LEAST_WIDTH or height < LEAST_HEIGHT:
        return Layout.TINY
    if width >= _WIDE_FROM[0] and height >= _WIDE_FROM[1]:
        return Layout.WIDE
    return Layout.NARROW
