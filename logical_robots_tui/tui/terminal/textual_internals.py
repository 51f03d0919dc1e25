"""Textual's private parts that the other rooms need, each behind one function.

A new release of Textual may move them; `test_textual_internals.py` then names which.
"""

from __future__ import annotations

import string
from typing import TYPE_CHECKING

from textual._context import active_app
from textual.keys import _character_to_key

if TYPE_CHECKING:
    from collections.abc import Iterable

    from textual.app import App
    from textual.dom import DOMNode
    from textual.geometry import Region
    from textual.screen import Screen
    from textual.strip import Strip
    from textual.widget import Widget

__all__ = [
    "characters_by_key",
    "handle_exception",
    "has_active_app",
    "is_being_removed",
    "mark_rendered_stale",
    "rendered_lines",
]


def has_active_app() -> bool:
    """Whether code runs within an app, so that themes can be asked for."""
    return active_app.get(None) is not None


def characters_by_key() -> dict[str, str]:
    """The punctuation that Textual has names for, by these names."""
    return {_character_to_key(char): char for char in string.punctuation}


def is_being_removed(node: DOMNode) -> bool:
    """Whether a widget loses its children at the moment."""
    return node._pruning


def rendered_lines(screen: Screen[object]) -> list[Strip]:
    """All lines of a screen as they are seen, with what lies over it."""
    return screen._compositor.render_strips()


def mark_rendered_stale(widget: Widget, regions: Iterable[Region]) -> None:
    """Have a widget render regions anew when it is next painted, without painting it now."""
    widget._styles_cache.set_dirty(*regions)


def handle_exception(app: App[object], error: Exception) -> None:
    """End an app with an error, as one does that a message handler raises."""
    app._handle_exception(error)
