"""Choosing a program, a version or a file by its name."""

from __future__ import annotations

import asyncio
import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Generic, Protocol, TypeVar

from textual import events, on
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.widgets import Input, OptionList, Static
from textual.widgets.option_list import Option

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, list_programs, load_program
from logical_robots_tui.game.replay import SUFFIX, Replay, load_replay
from logical_robots_tui.paths import pasted_path, typed_path
from logical_robots_tui.player.learning import version_name, version_result
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.layout.dialogs import Dialog, Listing
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, count_of, one_line, visible, visible_lines

if TYPE_CHECKING:
    from logical_robots_tui.progress import Version

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

_PREVIEW_FROM = 70  # columns


@dataclass(frozen=True, slots=True)
class Card:
    headline: str
    preview: str | Content
    is_error: bool = False


class Shelf(Protocol[T_co]):
    """A source of entries. Its methods may block; they run in a thread.

    `does` says what is done with the chosen entry. `card` has the details of an entry, and `take`
    opens one, or any file; both raise `InputError`.
    """

    @property
    def title(self) -> str: ...
    @property
    def placeholder(self) -> str: ...
    @property
    def does(self) -> str: ...
    def names(self) -> Sequence[str]: ...
    def card(self, name: str) -> Card: ...
    def take(self, name_or_path: str) -> T_co: ...


class Chooser(Dialog[T], Generic[T]):
    """A list with a filter and a preview."""

    DEFAULT_CSS = """
    Chooser > #box { height: 90%; max-height: 32; }
    Chooser #entries { width: 1fr; height: 1fr; }
    Chooser #preview { width: 1fr; height: 1fr; padding: 0 1; border-left: solid $ink-faint; }
    Chooser.-narrow #preview { display: none; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "go('cursor_up')", priority=True),
        Binding("down", "go('cursor_down')", priority=True),
        Binding("pageup", "go('page_up')", priority=True),
        Binding("pagedown", "go('page_down')", priority=True),
    ]

    def __init__(self, shelf: Shelf[T], current: str) -> None:
        self._shelf = shelf
        self._current = current
        self._cards: dict[str, Card] = {}
        self._shown: list[str] = []
        self._all: list[str] = []
        # Kept because a closing dialog loses its widgets before itself.
        self._filter = Input(placeholder=shelf.placeholder, id="filter", select_on_focus=False)
        self._entries = Listing(id="entries", markup=False, compact=True)
        self._entries.can_focus = False
        self._preview_text = Static(id="preview-text")
        preview = VerticalScroll(self._preview_text, id="preview", can_focus=False)
        super().__init__(shelf.title, self._filter, Horizontal(self._entries, preview))
        self.keys = f"enter {shelf.does}   ↑↓ choose   esc close"

    def on_resize(self, event: events.Resize) -> None:
        self.set_class(event.size.width < _PREVIEW_FROM, "-narrow")

    def on_mount(self) -> None:
        in_background(self, self._read_all)

    def action_go(self, motion: str) -> None:
        getattr(self._entries, f"action_{motion}")()

    async def _read_all(self) -> None:
        self._all = list(await asyncio.to_thread(self._shelf.names))
        if self._entries.is_attached:
            self._list(self._current)
        for name in self._all:
            try:
                card = await asyncio.to_thread(self._shelf.card, name)
            except InputError as error:
                card = Card("can't be used", str(error), is_error=True)
            self._cards[name] = card
            if not self._entries.is_attached:
                return  # closed meanwhile
            if name in self._shown:
                self._entries.replace_option_prompt(name, self._entry(name))
            if self._highlighted == name:
                self._preview(name)

    @property
    def _highlighted(self) -> str | None:
        highlighted = self._entries.highlighted
        return None if highlighted is None else self._shown[highlighted]

    def _list(self, highlighted: str | None) -> None:
        text = pasted_path(self._filter.value)
        words = text.casefold().split()
        self._shown = []
        for name in self._all:
            card = self._cards.get(name)
            content = f"{name} {card.headline if card else ''}".casefold()
            if all(word in content for word in words):
                self._shown.append(name)
        self._shown.sort(key=lambda name: name.casefold() != text.casefold())
        if is_path(text) and text not in self._all:
            self._shown.insert(0, text)
        self._entries.clear_options()
        self._entries.add_options([Option(self._entry(name), id=name) for name in self._shown])
        if self._shown:
            self._entries.highlighted = (
                self._shown.index(highlighted) if highlighted in self._shown else 0
            )
        else:
            self._preview(None)

    def _entry(self, name: str) -> Content:
        if name not in self._all:
            return Content.assemble(("Open the file ", INK.dim), (one_line(name), INK.key))
        marker = ("▸ ", INK.key) if name == self._current else ("  ", INK.dim)
        card = self._cards.get(name)
        headline = clip(one_line(card.headline), 60) if card else ""
        style = INK.bad if card and card.is_error else INK.dim
        return Content.assemble(marker, (one_line(name), INK.text), "  ", (headline, style))

    def _preview(self, name: str | None) -> None:
        card = self._cards.get(name) if name else None
        preview = card.preview if card else "" if name else "Nothing has this name."
        if isinstance(preview, str):
            style = INK.bad if card and card.is_error else INK.text
            preview = Content.styled(visible_lines(preview), style)
        self._preview_text.update(preview)

    @on(Input.Changed, "#filter")
    def _filter_changed(self) -> None:
        self.complain("")
        self._list(self._highlighted)

    @on(OptionList.OptionHighlighted, "#entries")
    def _entry_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        self._preview(event.option_id)

    @on(Input.Submitted, "#filter")
    def _submitted(self) -> None:
        if self._highlighted is not None:
            self._take(self._highlighted)

    @on(OptionList.OptionSelected, "#entries")
    def _entry_clicked(self, event: OptionList.OptionSelected) -> None:
        if event.option_id is not None:
            self._take(event.option_id)

    def _take(self, name: str) -> None:
        work = partial(self.leave_with, self._shelf.take, name)
        in_background(self, work, "take", exclusive=True)


def is_path(text: str) -> bool:
    return "/" in text or text.endswith((".toml", ".json", ".l", SUFFIX))


@dataclass(frozen=True)
class ProgramShelf:
    """The shipped programs, the player's own, and any program file."""

    folder: Path
    title: str = "Choose a program"
    placeholder: str = "type to filter, or the path of a .l file"
    does: str = "open"

    def names(self) -> Sequence[str]:
        return list_programs(self.folder)

    def card(self, name: str) -> Card:
        source = load_program(name, self.folder)
        lines = (line.lstrip() for line in source.text.splitlines()[:20])
        comments = (line.lstrip("#").strip() for line in lines if line.startswith("#"))
        return Card(next(comments, "") or ("" if source.shipped else "your own"), source.text)

    def take(self, name_or_path: str) -> ProgramSource:
        """Load a program; raises `InputError`."""
        program = typed_path(name_or_path) if "/" in name_or_path else name_or_path
        return load_program(program, self.folder)


@dataclass(frozen=True)
class VersionShelf:
    """The player's versions for a level, and what restoring each would change in `text`."""

    versions: Sequence[Version]
    text: str
    title: str = "Earlier versions"
    placeholder: str = "type to filter"
    does: str = "restore"

    def names(self) -> Sequence[str]:
        """Return the times of last use, the newest first."""
        return [*map(version_name, self.versions)]

    def card(self, name: str) -> Card:
        version = self.take(name)
        old_lines, new_lines = self.text.splitlines(), version.text.splitlines()
        diff = islice(difflib.unified_diff(old_lines, new_lines, n=2, lineterm=""), 2, None)
        rows = [
            f"@ line {row.split()[1][1:].partition(',')[0]}" if row.startswith("@@") else row
            for row in diff
        ]
        added, removed = (sum(row.startswith(sign) for row in rows) for sign in "+-")
        headline = f"{version_result(version)}   +{added} -{removed}" if rows else "as it is now"
        ink = {"+": INK.good, "-": INK.bad, "@": INK.faint}
        lines = [Content.styled(visible(row), ink.get(row[:1], INK.dim)) for row in rows]
        return Card(headline, Content("\n").join(lines) if rows else version.text)

    def take(self, name_or_path: str) -> Version:
        for version in self.versions:
            if version_name(version) == name_or_path:
                return version
        raise InputError("There is no such version.")


@dataclass(frozen=True)
class ReplayShelf:
    """The player's saved replays, the newest first, and any replay file."""

    folder: Path
    title: str = "Open a replay"
    placeholder: str = "type to filter, or the path of a .replay file"
    does: str = "play"

    def names(self) -> Sequence[str]:
        try:
            return sorted((path.stem for path in self.folder.glob(f"*{SUFFIX}")), reverse=True)
        except OSError:
            return []

    def card(self, name: str) -> Card:
        replay = self.take(name)
        length = count_of(replay.last - replay.first, "tick")
        texts = [text for texts in replay.programs.values() for text in texts.values()]
        return Card(f"{replay.levels[-1].title}, {length}", texts[-1])

    def take(self, name_or_path: str) -> Replay:
        is_file = "/" in name_or_path or name_or_path.endswith(SUFFIX)
        path = typed_path(name_or_path) if is_file else self.folder / f"{name_or_path}{SUFFIX}"
        return load_replay(path)
