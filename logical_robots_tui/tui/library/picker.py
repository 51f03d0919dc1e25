"""A dialog with a list that typing filters."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar, cast

from textual import on
from textual.binding import Binding, BindingType
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from logical_robots_tui.paths import pasted_path
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing

if TYPE_CHECKING:
    from textual.content import Content

T = TypeVar("T")
E = TypeVar("E")


class Picker(Dialog[T], Generic[T, E]):
    """Lists the entries that have each typed word, the current one highlighted.

    The arrows move in the list, and enter or a click takes an entry.
    """

    DEFAULT_CSS = """
    Picker #filter { margin: 0; }
    Picker #entries { height: auto; max-height: 70vh; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "go('cursor_up')", priority=True),
        Binding("down", "go('cursor_down')", priority=True),
        Binding("pageup", "go('page_up')", priority=True),
        Binding("pagedown", "go('page_down')", priority=True),
    ]

    placeholder = "type to filter"

    def __init__(self, entries: Iterable[E] = (), current: E | None = None) -> None:
        self.entries, self.matches, self.current = list(entries), list[E](), current
        # Kept because a closing dialog loses its widgets before itself.
        self._filter = Input(placeholder=self.placeholder, id="filter", select_on_focus=False)
        self._list = Listing(id="entries", markup=False, compact=True)
        self._list.can_focus = False
        super().__init__("", self._filter, self._list)

    def on_mount(self) -> None:
        self._filter.cursor_blink = False  # nothing is redrawn while idle
        if self.entries:
            self.fill(self.current)

    def line(self, entry: E) -> Content:
        """Return how the list shows an entry."""
        raise NotImplementedError

    def words_of(self, entry: E) -> str:
        """Return what the filter is compared with."""
        return self.line(entry).plain

    def take(self, entry: E) -> None:
        """Close with an entry; a subclass may do something else."""
        self.dismiss(cast("T", entry))

    @property
    def highlighted(self) -> E | None:
        index = self._list.highlighted
        return None if index is None else self.matches[index]

    def matching(self, text: str) -> list[E]:
        words = text.casefold().split()
        contents = [(entry, self.words_of(entry).casefold()) for entry in self.entries]
        return [entry for entry, content in contents if all(word in content for word in words)]

    def fill(self, highlighted: E | None) -> None:
        """List what matches the filter, and highlight one entry, or else the first."""
        matches = self.matches = self.matching(pasted_path(self._filter.value))
        self._list.set_options([Option(self.line(entry)) for entry in matches])
        self._list.refresh(layout=True)  # Textual keeps the height
        if matches:
            self._list.highlighted = matches.index(highlighted) if highlighted in matches else 0

    def redraw(self, entry: E) -> None:
        if entry in self.matches:
            index = self.matches.index(entry)
            self._list.replace_option_prompt_at_index(index, self.line(entry))

    def action_go(self, motion: str) -> None:
        getattr(self._list, f"action_{motion}")()

    @on(Input.Changed, "#filter")
    def _filter_changed(self) -> None:
        self.complain("")
        self.fill(self.highlighted)

    @on(Input.Submitted, "#filter")
    @on(OptionList.OptionSelected, "#entries")
    def _entry_chosen(self) -> None:
        if self.highlighted is not None:
            self.take(self.highlighted)
