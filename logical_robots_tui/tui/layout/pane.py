"""Panes: the parts of the screen that take the focus."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from textual.containers import Container
from textual.content import Content
from textual.errors import NoWidget
from textual.message import Message

from logical_robots_tui.tui.theme.safe_text import visible

if TYPE_CHECKING:
    from textual import events
    from textual.geometry import Offset
    from textual.widget import Widget


class Pane(Container):
    """A part of the screen with a title; every layout uses the same instance."""

    DEFAULT_CSS = """
    Pane {
        border: round $frame; border-title-color: $ink-dim; border-subtitle-color: $ink-dim;
        border-title-style: none; background: $surface; width: 1fr; height: 1fr;
    }
    Pane:focus-within, Pane:focus { border: round $frame-here; border-title-color: $ink-title; }
    """

    command_id: ClassVar[str]

    class Retitled(Message):
        """The title has changed."""

    @dataclass
    class Pulled(Message):
        """An edge is dragged with the mouse, by columns and rows since the last message."""

        pane: Pane
        side: str
        moved: Offset

    def __init__(self, *children: Widget, title: str) -> None:
        super().__init__(*children, id=self.command_id)
        self._held: tuple[str, Offset] | None = None
        self._heading = title
        self._note = ""
        self._set_border_title()

    @property
    def label(self) -> str:
        return f"{self._heading} · {self._note}" if self._note else self._heading

    def note(self, text: str) -> None:
        if text != self._note:
            self._note = visible(text)
            self._set_border_title()
            self.post_message(self.Retitled())

    def on_mouse_down(self, event: events.MouseDown) -> None:
        sides = {
            "left": event.x == 0,
            "right": event.x == self.outer_size.width - 1,
            "top": event.y == 0,
            "bottom": event.y == self.outer_size.height - 1,
        }
        side = next((side for side, is_there in sides.items() if is_there), None)
        if side is not None and self._is_at(event.screen_offset):
            self._held = (side, event.screen_offset)
            self.capture_mouse()

    def _is_at(self, place: Offset) -> bool:
        """Whether a place shows this pane itself; events of children bubble up to it."""
        try:
            return self.screen.get_widget_at(*place)[0] is self
        except NoWidget:  # outside of the screen, where terminals report the mouse, too
            return False

    def on_mouse_move(self, event: events.MouseMove) -> None:
        if self._held is not None:
            side, before = self._held
            self._held = (side, event.screen_offset)
            self.post_message(self.Pulled(self, side, event.screen_offset - before))

    def on_mouse_up(self) -> None:
        if self._held is not None:
            self._held = None
            self.release_mouse()

    def enter(self) -> None:
        """Focus the main widget at once, because the next key belongs to it."""
        raise NotImplementedError

    def _set_border_title(self) -> None:
        self.border_title = Content(self.label)
