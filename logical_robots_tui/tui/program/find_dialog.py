"""The dialog to find and replace text in the program."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from textual import on
from textual.widgets import Input

from logical_robots_tui.tui.layout.dialogs import Dialog

if TYPE_CHECKING:
    from textual.app import ComposeResult

__all__ = ["Find", "Search"]


class Search(NamedTuple):
    """A search.

    Attributes:
        wanted: The text to find.
        instead: The replacement for all matches; None only searches.
    """

    wanted: str
    instead: str | None


class Find(Dialog[Search]):
    """Asks for a text to find; enter in the second line replaces it everywhere.

    Args:
        wanted: The initial text.
    """

    DEFAULT_CSS = """
    Find > #box { max-width: 60; padding: 1 2 0 2; }
    """

    heading = "Find in the program"
    keys = "enter find, below: replace all   esc close"

    def __init__(self, wanted: str) -> None:
        super().__init__()
        self._wanted = wanted

    def content_widgets(self) -> ComposeResult:
        """Yield two lines."""
        yield Input(self._wanted, placeholder="find", id="wanted")
        yield Input(placeholder="replace by", id="instead")

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        wanted = self.query_one("#wanted", Input).value
        replaces = event.input.id == "instead"
        self.dismiss(Search(wanted, event.value if replaces else None) if wanted else None)
