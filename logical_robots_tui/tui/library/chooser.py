"""Choosing a program, a version or a file by its name."""

from __future__ import annotations

import asyncio
import difflib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from textual import events, on
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content
from textual.widgets import OptionList, Static

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, list_programs, load_program
from logical_robots_tui.game.replay import SUFFIX, Replay, load_replay
from logical_robots_tui.paths import typed_path
from logical_robots_tui.player.learning import version_name, version_result
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.commands.keymap import with_keys
from logical_robots_tui.tui.library.picker import Picker
from logical_robots_tui.tui.theme.themes import INK
from logical_robots_tui.wording import clip, count_of, one_line, visible, visible_lines

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from logical_robots_tui.progress import Version

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

_PREVIEW_FROM = 70  # columns
_SOLUTIONS = "solutions, shown after {solution}"
_SPOILERS = (
    "A level's solution is listed here when you have won the level, or have asked for its "
    "reference programs there ({solution})."
)


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


class Chooser(Picker[T, str]):
    """The names on a shelf, with a preview beside them; a path is a name as well."""

    DEFAULT_CSS = """
    Chooser > #box { height: 90%; max-height: 32; }
    Chooser #filter { margin-bottom: 1; }
    Chooser #entries { width: 1fr; height: 1fr; max-height: 100%; }
    Chooser #preview { width: 1fr; height: 1fr; padding: 0 1; border-left: solid $ink-faint; }
    Chooser.-narrow #preview { display: none; }
    """

    def __init__(self, shelf: Shelf[T], current: str) -> None:
        self._shelf = shelf
        self._cards: dict[str, Card] = {}
        self._preview_text = Static(id="preview-text")
        self.heading, self.placeholder = shelf.title, shelf.placeholder
        super().__init__(current=current)
        self.keys = f"enter {shelf.does}   ↑↓ choose   esc close"

    def content_widgets(self) -> ComposeResult:
        yield self._filter
        yield Horizontal(
            self._list, VerticalScroll(self._preview_text, id="preview", can_focus=False)
        )

    def on_resize(self, event: events.Resize) -> None:
        self.set_class(event.size.width < _PREVIEW_FROM, "-narrow")

    def on_mount(self) -> None:
        in_background(self, self._read_all)

    async def _read_all(self) -> None:
        self.entries = list(await asyncio.to_thread(self._shelf.names))
        if self._list.is_attached:
            self.fill(self.current)
        for name in self.entries:
            try:
                card = await asyncio.to_thread(self._shelf.card, name)
            except InputError as error:
                card = Card("can't be used", str(error), is_error=True)
            self._cards[name] = card
            if not self._list.is_attached:
                return  # closed meanwhile
            self.redraw(name)
            if self.highlighted == name:
                self._preview()

    def matching(self, text: str) -> list[str]:
        names = super().matching(text)
        names.sort(key=lambda name: name.casefold() != text.casefold())
        if is_path(text) and text not in self.entries:
            names.insert(0, text)
        return names

    def words_of(self, entry: str) -> str:
        card = self._cards.get(entry)
        return f"{entry} {card.headline if card else ''}"

    def line(self, entry: str) -> Content:
        if entry not in self.entries:
            return Content.assemble(("Open the file ", INK.dim), (one_line(entry), INK.key))
        marker = ("▸ ", INK.key) if entry == self.current else ("  ", INK.dim)
        card = self._cards.get(entry)
        headline = clip(one_line(card.headline), 60) if card else ""
        style = INK.bad if card and card.is_error else INK.dim
        return Content.assemble(marker, (one_line(entry), INK.text), "  ", (headline, style))

    def fill(self, highlighted: str | None) -> None:
        super().fill(highlighted)
        if not self.matches:
            self._preview()

    @on(OptionList.OptionHighlighted)
    def _preview(self) -> None:
        card = self._cards.get(self.highlighted or "")
        preview = card.preview if card else "" if self.matches else "Nothing has this name."
        if isinstance(preview, str):
            style = INK.bad if card and card.is_error else INK.text
            preview = Content.styled(visible_lines(preview), style)
        self._preview_text.update(preview)

    def take(self, entry: str) -> None:
        work = partial(self.leave_with, self._shelf.take, entry)
        in_background(self, work, "take", exclusive=True)


def is_path(text: str) -> bool:
    return "/" in text or text.endswith((".toml", ".json", ".l", SUFFIX))


@dataclass(frozen=True)
class ProgramShelf:
    """The shipped programs, the player's own, and any program file."""

    folder: Path
    is_spoiler: Callable[[str], bool]
    """Whether a program is a solution that the player is not to see yet."""
    title: str = "Choose a program"
    placeholder: str = "type to filter, or the path of a .l file"
    does: str = "open"

    def names(self) -> Sequence[str]:
        """Return the programs; the solutions that are not to be seen are one entry, the last."""
        names = list_programs(self.folder)
        shown_names = [name for name in names if not self.is_spoiler(name)]
        is_whole = len(shown_names) == len(names)
        return shown_names if is_whole else [*shown_names, with_keys(_SOLUTIONS)]

    def card(self, name: str) -> Card:
        if name == with_keys(_SOLUTIONS):
            return Card("", with_keys(_SPOILERS))
        source = load_program(name, self.folder)
        lines = (line.lstrip() for line in source.text.splitlines()[:20])
        comments = (line.lstrip("#").strip() for line in lines if line.startswith("#"))
        return Card(next(comments, "") or ("" if source.shipped else "your own"), source.text)

    def take(self, name_or_path: str) -> ProgramSource:
        """Load a program; raises `InputError`."""
        if name_or_path == with_keys(_SOLUTIONS):
            raise InputError(with_keys(_SPOILERS))
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
