"""Asking what to find in the program, and what to put in its place."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from textual import on
from textual.containers import Vertical
from textual.widgets import Input, Static

from logical_robots_tui.tui.layout.dialogs import Dialog

if TYPE_CHECKING:
    from textual.app import ComposeResult

__all__ = ["Find", "Wish"]


class Wish(NamedTuple):
    """What to find.

    Attributes:
        wanted: What to look for.
        instead: What to put in its place everywhere; None only looks.
    """

    wanted: str
    instead: str | None


class Find(Dialog[Wish]):
    """Asks what to find; enter in the second line replaces it everywhere.

    Args:
        wanted: To begin with.
    """

    DEFAULT_CSS = """
    Find > #box { max-width: 60; padding: 1 2 0 2; }
    """

    def __init__(self, wanted: str) -> None:
        super().__init__()
        self._wanted = wanted

    def compose(self) -> ComposeResult:
        """Two lines to fill in."""
        with Vertical(id="box") as box:
            box.border_title = "Find in the program"
            yield Input(self._wanted, placeholder="find", id="wanted")
            yield Input(placeholder="replace by", id="instead")
            yield Static("enter find, below: replace all   esc close", id="keys", markup=False)

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        wanted = self.query_one("#wanted", Input).value
        replaces = event.input.id == "instead"
        self.dismiss(Wish(wanted, event.value if replaces else None) if wanted else None)
