"""The base of the editor's forms: labelled fields that scroll."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar

from textual import on
from textual.binding import Binding
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.widgets import Button, Checkbox, Input, OptionList, Select, Static, TextArea

from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.theme.safe_text import one_line
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.world import LevelError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from collections.abc import Set as AbstractSet

    from textual.app import ComposeResult
    from textual.widget import Widget

__all__ = ["Form", "Ticks", "choice", "flag", "number", "several", "text"]


class Tick(Checkbox):
    """A checkbox that is readable without colours."""

    def on_mount(self) -> None:
        """Show the initial state."""
        self.BUTTON_INNER = "X" if self.value else " "

    def watch_value(self) -> None:
        """Show the new state."""
        self.BUTTON_INNER = "X" if self.value else " "
        super().watch_value()


class Ticks(Listing):
    """A list of names with checkboxes.

    Args:
        name: Its id.
        names: All names.
        known: The names that exist.
        ticked: The ticked names.
    """

    def __init__(
        self, name: str, names: Sequence[str], known: AbstractSet[str], ticked: Sequence[str]
    ) -> None:
        self._names = names
        self._known = known
        self._ticked = set(ticked)
        super().__init__(*map(self._line, names), id=name, markup=False, compact=True)

    @property
    def ticked(self) -> tuple[str, ...]:
        """The ticked names, in list order."""
        return tuple(name for name in self._names if name in self._ticked)

    def toggle(self, name: str) -> None:
        """Tick or untick a name."""
        self._ticked ^= {name}
        self.replace_option_prompt_at_index(self._names.index(name), self._line(name))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Tick or untick it."""
        event.stop()
        self.toggle(self._names[event.option_index])

    def _line(self, name: str) -> Content:
        sign = "[X] " if name in self._ticked else "[ ] "
        gone = "" if name in self._known else " (missing)"
        return Content.assemble((sign, INK.key), one_line(name), (gone, INK.dim))


class Form(Dialog[bool]):
    """Fields with labels; `take` applies them, and may refuse.

    Returns True if it was applied.

    Args:
        title: The title of the box.
    """

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

    BINDINGS: ClassVar[list[Binding | tuple[str, str] | tuple[str, str, str]]] = [
        Binding("f2", "take", show=False, priority=True),
    ]

    keys = "tab next   F2 or enter apply   esc close"

    def fields(self) -> Iterable[tuple[str, Widget]]:
        """Yield labels and widgets, in order; every widget has an id."""
        raise NotImplementedError

    def take(self) -> None:
        """Apply the fields.

        Raises:
            LevelError: A value is invalid.
        """
        raise NotImplementedError

    def content_widgets(self) -> ComposeResult:
        """Yield the fields and the buttons."""
        with VerticalScroll(can_focus=False):
            for label, widget in self.fields():
                with Horizontal(classes="row"):
                    yield Static(label, classes="label", markup=False)
                    yield widget
        with Horizontal(id="buttons"):
            yield Button("Take", id="take", compact=True)
            yield Button("Close", id="close", compact=True)

    def on_mount(self) -> None:
        """Stop the cursors from blinking."""
        for line in self.query(Input):
            line.cursor_blink = False

    @on(Input.Submitted)
    @on(Button.Pressed, "#take")
    def action_take(self) -> None:
        """Apply the fields, or show what is wrong."""
        try:
            self.take()
        except LevelError as error:
            self.complain(error.message)
        else:
            self.dismiss(True)

    @on(Button.Pressed, "#close")
    def _close(self) -> None:
        self.dismiss(None)

    # -- values of the fields -----------------------------------------------------------------

    def text_of(self, name: str) -> str:
        """Return the text of a field."""
        return self.query_one(f"#{name}", Input).value.strip()

    def number_of(self, name: str, label: str) -> float:
        """Return the number in a field.

        Raises:
            LevelError: It is not a number.
        """
        typed = self.text_of(name)
        try:
            found = float(typed)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            raise LevelError(f"{label} must be a number, not “{typed}”.")
        return found

    def whole_of(self, name: str, label: str) -> int:
        """Return the integer in a field.

        Raises:
            LevelError: It is not an integer.
        """
        found = self.number_of(name, label)
        if not found.is_integer():
            raise LevelError(f"{label} must be an integer, not {found:g}.")
        return int(found)

    def flag_of(self, name: str) -> bool:
        """Return whether a box is ticked."""
        return self.query_one(f"#{name}", Checkbox).value

    def choice_of(self, name: str) -> str:
        """Return the chosen name, or ""."""
        chosen = self.query_one(f"#{name}", Select).value
        return "" if chosen is Select.NULL else str(chosen)

    def several_of(self, name: str) -> tuple[str, ...]:
        """Return all ticked names, in list order."""
        return self.query_one(f"#{name}", Ticks).ticked

    def lines_of(self, name: str) -> str:
        """Return a text of several lines."""
        return self.query_one(f"#{name}", TextArea).text.strip()


def text(name: str, value: str) -> Input:
    """Return a text field."""
    return Input(value, id=name, select_on_focus=False)


def number(name: str, value: float) -> Input:
    """Return a number field."""
    return Input(f"{value:.10g}", id=name, select_on_focus=False)


def flag(name: str, label: str, *, value: bool) -> Checkbox:
    """Return a checkbox."""
    return Tick(Content(label), value, id=name, compact=True)


def choice(name: str, names: Sequence[str], value: str, nothing: str) -> Select[str]:
    """Return a choice of one name, or nothing; includes the current value even if it is missing."""
    known = list(dict.fromkeys(names))
    options = [(Content(one_line(each)), each) for each in known]
    if value and value not in known:
        options.append((Content(f"{one_line(value)} (missing)"), value))
    return Select(options, prompt=nothing, value=value or Select.NULL, id=name, compact=True)


def several(name: str, names: Sequence[str], ticked: Sequence[str]) -> Ticks:
    """Return a choice of several names; includes current values even if they are missing."""
    return Ticks(name, list(dict.fromkeys([*names, *ticked])), set(names), ticked)
