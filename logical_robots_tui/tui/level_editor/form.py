"""Forms: labelled fields that scroll, each of which reads its own value."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeAlias

from textual import on
from textual.binding import Binding
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.message import Message
from textual.widgets import Button, Checkbox, Input, OptionList, Select, Static, TextArea

from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import LevelError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from textual.app import ComposeResult


class Text(Input):
    def __init__(self, name: str, value: str) -> None:
        super().__init__(value, id=name, select_on_focus=False)

    def read(self) -> str:
        return self.value.strip()


class Number(Input):
    def __init__(self, name: str, value: float, said: str, *, whole: bool = False) -> None:
        super().__init__(f"{value:.10g}", id=name, select_on_focus=False)
        self._said, self._whole = said, whole

    def read(self) -> float:
        typed = self.value.strip()
        try:
            found = float(typed)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            raise LevelError(f"{self._said} must be a number, not “{typed}”.")
        if self._whole and not found.is_integer():
            raise LevelError(f"{self._said} must be an integer, not {found:g}.")
        return int(found) if self._whole else found


class Lines(TextArea):
    def __init__(self, name: str, value: str) -> None:
        super().__init__(value, id=name, tab_behavior="focus")

    def read(self) -> str:
        return self.text.strip()


class Choice(Select[str]):
    """One of several names, even a missing one; space and down list them.

    `nothing` is the label for no name, or "" if one must be chosen.
    """

    BINDINGS = [("enter", "submit")]

    class Submitted(Message):
        """Enter was pressed while the list was closed."""

    def __init__(self, name: str, labels: Mapping[str, str], value: str, nothing: str = "") -> None:
        options = [(Content(one_line(label)), each) for each, label in labels.items()]
        if value and value not in labels:
            options.append((Content(f"{one_line(value)} (missing)"), value))
        super().__init__(
            options,
            prompt=nothing,
            allow_blank=bool(nothing),
            value=value or Select.NULL,
            id=name,
            compact=True,
        )

    def read(self) -> str:
        return "" if self.value is Select.NULL else str(self.value)

    def action_submit(self) -> None:
        self.post_message(self.Submitted())


class Flag(Checkbox):
    """A checkbox that is readable without colours."""

    def __init__(self, name: str, label: str, *, value: bool) -> None:
        super().__init__(Content(label), value, id=name, compact=True)

    def on_mount(self) -> None:
        self.BUTTON_INNER = "X" if self.value else " "

    def watch_value(self) -> None:
        self.BUTTON_INNER = "X" if self.value else " "
        super().watch_value()

    def read(self) -> bool:
        return self.value


class Ticks(Listing):
    """Any number of names, with checkboxes; ticked ones are listed even if missing."""

    def __init__(self, name: str, known: Sequence[str], ticked: Sequence[str]) -> None:
        self._names = list(dict.fromkeys([*known, *ticked]))
        self._known = set(known)
        self._ticked = set(ticked)
        super().__init__(*map(self._line, self._names), id=name, markup=False, compact=True)

    def read(self) -> tuple[str, ...]:
        return tuple(name for name in self._names if name in self._ticked)

    def toggle(self, name: str) -> None:
        self._ticked ^= {name}
        self.replace_option_prompt_at_index(self._names.index(name), self._line(name))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        event.stop()
        self.toggle(self._names[event.option_index])

    def _line(self, name: str) -> Content:
        sign = "[X] " if name in self._ticked else "[ ] "
        gone = "" if name in self._known else " (missing)"
        return Content.assemble((sign, INK.key), one_line(name), (gone, INK.dim))


Field: TypeAlias = Text | Number | Lines | Choice | Flag | Ticks
"""A widget whose id names a value, which `read` returns; an invalid one raises `LevelError`."""


class Form(Dialog[bool]):
    """Fields with labels; returns True once `take` has applied them."""

    DEFAULT_CSS = """
    Form > #box { max-width: 76; padding: 0 1 0 2; }
    Form VerticalScroll { height: auto; max-height: 80vh; scrollbar-gutter: stable; }
    Form .row { height: auto; }
    Form .label { width: 17; height: 1; color: $ink-dim; }
    Form Input { width: 1fr; margin: 0; }
    Form Checkbox, Form Select, Form Ticks, Form TextArea {
        width: 1fr; border: none; padding: 0; }
    Form Checkbox { background: $surface; }
    Form Checkbox:focus { background: $block-cursor-background; }
    Form Ticks, Form TextArea { height: auto; max-height: 6; background: $panel; }
    Form TextArea { min-height: 3; padding: 0 1; }
    Form #buttons { height: 1; margin-top: 1; }
    Form Button { height: 1; min-width: 8; border: none; margin-right: 2; padding: 0 1;
        background: $panel; color: $foreground; text-style: none; }
    Form Button:focus { background: $block-cursor-background; text-style: bold; border: none; }
    Form #keys { margin: 0; }
    """

    BINDINGS = [Binding("f2", "take", priority=True)]

    keys = "tab next   F2 or enter apply   esc cancel"
    verb = "Apply"

    def __init__(self, title: str) -> None:
        super().__init__(title)
        self._fields: dict[str, Field] = {}
        self._before: dict[str, Any] = {}

    def fields(self) -> Iterable[tuple[str, Field]]:
        raise NotImplementedError

    def take(self) -> None:
        """Apply the fields, or raise LevelError."""
        raise NotImplementedError

    def content_widgets(self) -> ComposeResult:
        with VerticalScroll(can_focus=False):
            for label, field in self.fields():
                self._fields[field.id or ""] = field
                with Horizontal(classes="row"):
                    yield Static(label, classes="label", markup=False)
                    yield field
        with Horizontal(id="buttons"):
            yield Button(self.verb, id="take", compact=True)
            yield Button("Cancel", id="close", compact=True)

    def on_mount(self) -> None:
        self._before = self.values()
        for line in self.query(Input):
            line.cursor_blink = False

    @on(Input.Submitted)
    @on(Choice.Submitted)
    def _submitted(self) -> None:
        self.field_entered()

    def field_entered(self) -> None:
        self.action_take()

    @on(Button.Pressed, "#take")
    def action_take(self) -> None:
        try:
            self.take()
        except LevelError as error:
            self.complain(error.message)
        else:
            self.dismiss(True)

    @on(Button.Pressed, "#close")
    def _close(self) -> None:
        self.dismiss(None)

    def values(self, *names: str) -> dict[str, Any]:
        """Return values of some fields, or all, by name, or raise LevelError."""
        return {name: self._fields[name].read() for name in names or self._fields}

    def changed(self) -> dict[str, Any]:
        """Return the values of changed fields by name, like `values`."""
        return {name: v for name, v in self.values().items() if v != self._before[name]}

    def row(self, name: str) -> Horizontal:
        row = self._fields[name].parent
        assert isinstance(row, Horizontal)
        return row
