"""Panes: the parts of the screen that a player goes between."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from textual.containers import Container
from textual.content import Content
from textual.message import Message

from logical_robots_tui.tui.plain import visible

if TYPE_CHECKING:
    from textual.widget import Widget

__all__ = ["Pane"]


class Pane(Container):
    """A part of the screen with a title; the same instance lives in every layout.

    Attributes:
        command_id: The command that goes to it; also its id.
    """

    DEFAULT_CSS = """
    Pane {
        border: round $frame; border-title-color: $ink-dim; border-subtitle-color: $ink-dim;
        border-title-style: none; background: $surface; width: 1fr; height: 1fr;
    }
    Pane:focus-within, Pane:focus { border: round $border; border-title-color: $ink-title; }
    """

    command_id: ClassVar[str]

    class Retitled(Message):
        """The title of a pane has changed."""

    def __init__(self, *children: Widget, title: str) -> None:
        super().__init__(*children, id=self.command_id)
        self._heading = title
        self._note = ""
        self._set_border_title()

    @property
    def label(self) -> str:
        """The title with the note, for a tab."""
        return f"{self._heading} · {self._note}" if self._note else self._heading

    def note(self, text: str) -> None:
        """Say something about the pane beside its title; "" says nothing."""
        if text != self._note:
            self._note = visible(text)
            self._set_border_title()
            self.post_message(self.Retitled())

    def enter(self) -> None:
        """Put the focus where work in this pane begins, at once: the next key belongs there."""
        raise NotImplementedError

    def _set_border_title(self) -> None:
        self.border_title = Content(self.label)
