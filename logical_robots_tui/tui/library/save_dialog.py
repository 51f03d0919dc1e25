"""Saving a program or a level under a name, as one of the player's own."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from textual import on
from textual.widgets import Input, Static

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource, load_program, save_program
from logical_robots_tui.game.source import target
from logical_robots_tui.paths import is_there
from logical_robots_tui.tui.app.ui import in_background
from logical_robots_tui.tui.layout.dialogs import Dialog, Result
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.load import NATIVE, SUFFIXES

if TYPE_CHECKING:
    from textual.app import ComposeResult


class SaveDialog(Dialog[Result]):
    """Asks for a name and saves; a second enter replaces a file, except the current one.

    Returns what was saved.
    """

    DEFAULT_CSS = "SaveDialog > #box { max-width: 72; padding: 1 2 0 2; }"

    keys = "enter save   esc close"

    def __init__(self, name: str, folder: Path, current: Path | None = None) -> None:
        super().__init__("", Input(name if name.isprintable() else "", id="name"))
        self._folder, self._current = folder, current
        self._confirmed: Path | None = None
        self._is_saving = False

    @abstractmethod
    def file(self, name: str) -> Path:
        """Return the file for a name, or raise InputError if that is invalid."""

    @abstractmethod
    async def save(self, path: Path) -> Result:
        """Save in a file, and return what was saved, or raise InputError."""

    @on(Input.Changed)
    def _changed(self) -> None:
        self._confirmed = None
        self.complain("")

    def action_leave(self) -> None:
        if not self._is_saving:
            super().action_leave()

    @on(Input.Submitted)
    def _submitted(self) -> None:
        in_background(self, self._save, "save")

    async def _save(self) -> None:
        if self._is_saving:
            return
        try:
            path = self.file(self.query_one("#name", Input).value.strip())
            if path not in (self._current, self._confirmed) and is_there(path):
                self._confirmed = path
                self.complain(f"{path.stem} already exists. Press enter again to replace it.")
                return
            self._is_saving = True
            saved = await self.save(path)
        except InputError as error:
            self.complain(str(error))
        else:
            self.dismiss(saved)
        finally:
            self._is_saving = False  # if another dialog is above, this one stays


class SaveAs(SaveDialog[ProgramSource]):
    heading = "Save the program as"

    def __init__(self, source: ProgramSource, text: str, folder: Path) -> None:
        name = source.name if source.path.parent == folder else str(source.path)
        super().__init__(f"my-{source.name}" if source.shipped else name, folder, source.path)
        self._text = text

    def file(self, name: str) -> Path:
        return target(name, self._folder)

    async def save(self, path: Path) -> ProgramSource:
        await asyncio.to_thread(save_program, path, self._text)
        return await asyncio.to_thread(load_program, path)


class SaveLevel(SaveDialog[Level]):
    """Saves a level with a title, keeping its file's formatting as far as possible."""

    DEFAULT_CSS = "SaveLevel .label { color: $ink-dim; height: 1; }"

    heading = "Save the level as"
    keys = "enter save   tab title   esc close"

    def __init__(self, level: Level, name: str, folder: Path, file: Path | None) -> None:
        super().__init__(name, folder)
        self._level, self._file = level, file

    def content_widgets(self) -> ComposeResult:
        yield Static("File name", classes="label", markup=False)
        yield from super().content_widgets()
        yield Static("Title", classes="label", markup=False)
        yield Input(self._level.title, id="title")

    def file(self, name: str) -> Path:
        return target(name, self._folder, folder="levels", suffixes=SUFFIXES, usual=NATIVE)

    async def save(self, path: Path) -> Level:
        title = self.query_one("#title", Input).value.strip()
        from logical_robots_tui.editing.entities import set_words
        from logical_robots_tui.editing.files import save_level

        level = set_words(self._level, title=title or self._level.title)
        return await asyncio.to_thread(save_level, level, path, replace_all=path != self._file)
