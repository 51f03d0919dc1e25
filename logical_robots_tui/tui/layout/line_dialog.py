"""Asking for a line of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.tui.layout.dialog import Dialog

if TYPE_CHECKING:
    from textual.app import ComposeResult

__all__ = ["LinePrompt"]


class LinePrompt(Dialog[str]):
    """Asks for a line, and gives it as it was typed.

    Args:
        title: What for.
        text: What stands there already.
    """

    DEFAULT_CSS = """
    LinePrompt > #box { max-width: 60; padding: 1 2 0 2; }
    """

    def __init__(self, title: str, text: str) -> None:
        super().__init__()
        self._title_text = title
        self._text = text

    def compose(self) -> ComposeResult:
        """A line to type in."""
        with Vertical(id="box") as box:
            box.border_title = Content(self._title_text)
            yield Input(self._text, id="line")
            yield Static("enter take it   esc close", id="keys", markup=False)

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        self.dismiss(event.value)
