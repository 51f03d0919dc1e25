"""Textual's private parts that the rest needs, each behind one function.

If a release moves them, `test_textual_internals.py` names which.
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


def has_active_app() -> bool:
    """Return whether code runs within an app, so that themes are available."""
    return active_app.get(None) is not None


def characters_by_key() -> dict[str, str]:
    """Return punctuation characters by Textual's names for their keys."""
    return {_character_to_key(char): char for char in string.punctuation}


def is_being_removed(node: DOMNode) -> bool:
    return node._pruning


def rendered_lines(screen: Screen[object]) -> list[Strip]:
    """Return all lines of a screen as they appear, with overlays."""
    return screen._compositor.render_strips()


def mark_rendered_stale(widget: Widget, regions: Iterable[Region]) -> None:
    widget._styles_cache.set_dirty(*regions)


def handle_exception(app: App[object], error: Exception) -> None:
    """End an app with an error, as if a message handler had raised it."""
    app._handle_exception(error)
