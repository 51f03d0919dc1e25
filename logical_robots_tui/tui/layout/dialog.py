"""What all dialogs share: a box in the middle of the screen that escape closes."""

from __future__ import annotations

from typing import ClassVar, Generic, TypeVar

from textual.binding import Binding
from textual.screen import ModalScreen

from logical_robots_tui.tui.app.once import ClosedOnce

__all__ = ["Dialog"]

Result = TypeVar("Result")


class Dialog(ModalScreen["Result | None"], ClosedOnce["Result | None"], Generic[Result]):
    """A box over the game; leaving it without an answer gives None."""

    DEFAULT_CSS = """
    Dialog { align: center middle; background: $background 60%; }
    Dialog > #box {
        width: 90%; max-width: 96; height: auto; max-height: 90%; padding: 0 1;
        border: round $frame-here; border-title-color: $ink-title; background: $surface;
    }
    Dialog #complaint { color: $error; height: auto; max-height: 6; display: none; }
    Dialog #keys { color: $ink-dim; height: 1; margin-top: 1; text-wrap: nowrap; }
    Dialog Input {
        border: none; height: 1; padding: 0 1; background: $panel; margin-bottom: 1;
    }
    Dialog Input:focus { border: none; }
    Dialog OptionList { border: none; padding: 0; background: $surface; }
    Dialog OptionList:focus { border: none; }
    """

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("escape", "leave", "Close", show=False),
    ]

    def action_leave(self) -> None:
        """Close without an answer."""
        self.dismiss(None)
