"""Textual's private parts that the rest needs, each behind one function or class.

They stand only in this folder; a release that moves them is noticed by its tests. Textual would
have to offer, instead of

- `_ansi_sequences`: a parser that says whether a sequence may go on.
- `_bindings`: a way to take keys from one widget while something else comes first.
- `_compositor`: what covers a widget, the lines of a screen, and updates as cells.
- `_display`: a driver that receives what changed, rather than text.
- `_driver`: the app's driver as an attribute that may be read.
- `_handle_exception`: a hook for an exception that ends the app, and a way to report one to it.
- `_notifications`, `_unnotify`: a way to take back a message that was shown.
- `_offset_to_line_info`: the line, and its row, at an offset of a wrapped document, in no time.
- `_parse_rules`: a cache of parsed style sheets that outlives a new theme, a dialog and an app.
- `_pruning`: whether a node is being removed.
- `_sequence_to_key_events`, `_xterm_parser`: a key parser without errors, for other drivers.
- `_styles_cache`: a way to draw a line anew without asking the screen for a refresh.
- `_text_area`, `_wrapped_document`: an indent of the further rows of wrapped lines.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from textual import events
from textual.binding import BindingsMap
from textual.document import _wrapped_document
from textual.document._wrapped_document import WrappedDocument
from textual.geometry import Offset, Region

if TYPE_CHECKING:
    from textual.app import App
    from textual.dom import DOMNode
    from textual.screen import Screen
    from textual.strip import Strip
    from textual.widget import Widget


def is_being_removed(node: DOMNode) -> bool:
    return node._pruning


def rendered_lines(screen: Screen[object]) -> list[Strip]:
    """Return all lines of a screen as they appear, with overlays."""
    return screen._compositor.render_strips()


def mark_rendered_stale(widget: Widget, regions: Iterable[Region]) -> None:
    widget._styles_cache.set_dirty(*regions)


def withdraw_message(app: App[Any], message: str) -> None:
    for notification in [*app._notifications]:
        if notification.message == message:
            app._unnotify(notification)


def handle_exception(app: App[object], error: Exception) -> None:
    """End an app with an error, as if a message handler had raised it."""
    app._handle_exception(error)


class WidgetBindings:
    """The keys of one widget. Textual's are those of its class, and a keymap can't remove any."""

    def __init__(self, widget: Widget, *additions: BindingsMap) -> None:
        self._widget, self._bindings = widget, BindingsMap.merge([widget._bindings, *additions])
        self.put_first()

    def put_first(self, *bindings: BindingsMap) -> None:
        """Let other keys come first, until the next call."""
        self._widget._bindings = BindingsMap.merge([*bindings, self._bindings])


class HangingDocument(WrappedDocument):
    """Wrapped lines whose further rows are indented like the first one."""

    _lines: Sequence[str] = ()  # as they are wrapped
    _layout = 0, 4  # width of rows and of tabs

    def wrap(self, width: int, tab_width: int | None = None) -> None:
        """Wrap all lines, if need be: Textual asks for it as well when only the height changes."""
        layout = width, tab_width or self._layout[1]
        if self._layout != layout or self._lines != self.document.lines:
            self._layout = layout
            super().wrap(*layout)
            self._lines = self.document.lines.copy()

    def wrap_range(self, *places: tuple[int, int]) -> None:
        super().wrap_range(*places)
        self._lines = self.document.lines.copy()

    @property
    def height(self) -> int:
        """The number of rows; Textual counts them anew for each row that is drawn."""
        return len(self._offset_to_line_info)

    def hang(self, line_index: int, section: int) -> int:
        """Return by how many columns a row of a line is shifted."""
        return _hang(self.document[line_index], self._layout[0]) if section else 0

    def row_at(self, y: int) -> tuple[int, int]:
        """Return the line, and its row, at an offset within the height."""
        return self._offset_to_line_info[y]

    def location_to_offset(self, location: tuple[int, int]) -> Offset:
        x, y = super().location_to_offset(location)
        return Offset(x + self.hang(*self._offset_to_line_info[y]), y)

    def get_target_document_column(self, line_index: int, x_offset: int, y_offset: int) -> int:
        section = y_offset if y_offset >= 0 else len(self.get_offsets(line_index))
        x = max(x_offset - self.hang(line_index, section), 0)
        return super().get_target_document_column(line_index, x, y_offset)


def _hang(line: str, width: int) -> int:
    return 0 if "\t" in line else min(len(line) - len(line.lstrip(" ")), width // 2)


_wrap_offsets = _wrapped_document.compute_wrap_offsets  # type: ignore[attr-defined] # imported


def _hanging_offsets(text: str, width: int, *arguments: Any, **options: Any) -> list[int]:
    if len(text) <= width and text.isascii() and "\t" not in text:
        return []  # most lines of a long text
    offsets = _wrap_offsets(text, width, *arguments, **options)
    if not offsets or not (indent := _hang(text, width)):
        return offsets
    first, tab_size = offsets[0], arguments[0] if arguments else options["tab_size"]
    later_offsets = _wrap_offsets(text[first:], width - indent, tab_size)
    return [first, *(first + offset for offset in later_offsets)]


def hang_wrapped_lines() -> None:
    """Let text areas indent the further rows of wrapped lines; they draw them themselves."""
    from textual.widgets import _text_area  # with all widgets

    _wrapped_document.compute_wrap_offsets = _hanging_offsets  # type: ignore[attr-defined] # too
    _text_area.WrappedDocument = HangingDocument  # type: ignore[attr-defined] # where it is made


_LONGEST_INPUT = 2_000  # characters of a line, all of which Textual draws at each key


def limit_input_lines() -> None:
    """Let no line for input grow too long, as by a paste; that of the palette is Textual's."""
    from textual.widgets import Input

    replace = Input.replace

    def replace_within_limit(line: Input, text: str, start: int, end: int) -> None:
        length = len(line.value) - abs(end - start) + len(text)
        if text and length > _LONGEST_INPUT:
            message = f"{length:,} characters are too many here; at most {_LONGEST_INPUT:,} fit."
            line.notify(message, severity="warning", markup=False)
        else:
            replace(line, text, start, end)

    Input.replace = replace_within_limit  # type: ignore[assignment] # of all lines


_LONGEST = 0.5  # seconds that a key may delay the next ones
_ROUNDS = 3  # rounds of the event loop after which a worker has opened its dialog


class KeyQueue:
    """Holds keys back while an earlier one is being handled.

    Textual sends fast keys to the current focus, so those for a dialog would reach the screen
    below.
    """

    def __init__(self, app: App[None]) -> None:
        self._app = app
        self._waiting: deque[events.Key | events.Paste] = deque()
        self._number = 0  # of the key being handled
        self._answering = False
        self._typed_into: Widget | None = None  # has perhaps not taken its text yet

    @property
    def waiting(self) -> int:
        return len(self._waiting)

    def forget(self) -> None:
        self._waiting.clear()

    def must_wait(self, event: events.Key | events.Paste) -> bool:
        """Return whether an event is held back; if so, it is sent again in its turn."""
        if self._answering:
            self._waiting.append(event)
            return True
        focused = self._typed_into
        if focused is None or self._is_text(event):
            return False
        assert isinstance(event, events.Key)
        active = self._app.screen.active_bindings.get(event.key)
        if active is None or not active.binding.priority:
            return False
        # It would come before the text that was typed for the focused widget.
        self._typed_into = None
        self._waiting.appendleft(event)
        self._hold()
        focused.call_later(self._later, self._end, self._number)
        return True

    def begin(self, event: events.Key | events.Paste) -> None:
        """Hold back events until the one just sent to the focus has been handled."""
        focused = self._app.focused
        if self._is_text(event):
            self._typed_into = focused
            return  # text never opens a dialog
        screen = self._app.screen
        self._hold()
        first = focused or screen
        arrive = partial(self._arrive, screen, self._number)
        # The key goes up to the app; then what a widget sends for it, as a button does.
        self._follow(first, partial(self._follow, first, arrive))

    def _is_text(self, event: events.Key | events.Paste) -> bool:
        focused = self._app.focused
        return isinstance(event, events.Paste) or (
            focused is not None and focused.check_consume_key(event.key, event.character)
        )

    def _hold(self) -> None:
        self._answering = True
        self._number += 1
        asyncio.get_running_loop().call_later(_LONGEST, self._later, self._end, self._number)

    def _later(self, *call: Any) -> None:
        self._app.call_later(*call)

    def _follow(self, node: DOMNode | None, action: Callable[[], object]) -> None:
        """Do something in the app when messages have bubbled from a node up to it."""
        if node is None or node is self._app:
            self._later(action)
        elif not node.call_later(self._follow, node.parent, action):
            self._follow(node.parent, action)

    async def _arrive(self, screen: Screen[Any], number: int) -> None:
        """Wait until a dialog opened by the key has the focus."""
        for _ in range(_ROUNDS):
            await asyncio.sleep(0)
        top_screen = self._app.screen
        if top_screen is screen or not top_screen.call_after_refresh(
            self._later, self._end, number
        ):
            await self._end(number)

    async def _end(self, number: int) -> None:
        if number != self._number:
            return
        self._answering = False
        while self._waiting and not self._answering:
            await self._app.on_event(self._waiting.popleft())
