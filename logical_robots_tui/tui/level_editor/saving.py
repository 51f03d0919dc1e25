"""Saving an edited level, saving it under another name, or discarding it."""

from __future__ import annotations

import asyncio
import re
from pathlib import Path
from typing import TYPE_CHECKING

from textual.widgets import Input, Static

from logical_robots_tui.editing.files import is_made_here, save_level
from logical_robots_tui.editing.things import set_words
from logical_robots_tui.errors import InputError
from logical_robots_tui.game.source import target
from logical_robots_tui.tui.library.save_dialog import SaveDialog
from logical_robots_tui.wording import one_line
from logical_robots_tui.world import Level
from logical_robots_tui.world.levels.load import NATIVE, SUFFIXES

if TYPE_CHECKING:
    from textual.app import ComposeResult

    from logical_robots_tui.tui.level_editor.mode import EditMode


async def save(mode: EditMode) -> bool:
    """Save a level in its file, or else under a new name; return whether it was saved."""
    if mode.file is None:
        return await save_as(mode)
    if not mode.levels.is_saved and not await asyncio.to_thread(is_made_here, mode.file):
        name = one_line(mode.file.name)
        answers = [("other", "Save under another name"), ("same", f"Replace {name}")]
        question = f"{name} was not made by this game. Replace it?"
        answer = await mode.ui.choose("Save the level", question, answers)
        if answer != "same":
            return answer == "other" and await save_as(mode)
    # Not cancelled, because the game must learn that the file was written.
    is_saved = await asyncio.shield(asyncio.create_task(_save_in(mode, mode.file)))
    if is_saved is None:
        name = one_line(mode.file.name)
        mode.ui.warn(f"{name} was changed by another program. Save under another name.")
        return await save_as(mode)
    return is_saved


async def _save_in(mode: EditMode, file: Path) -> bool | None:
    """Save in a file; return whether that worked, or None if another program changed it."""
    async with mode.saving:
        on_disk = await asyncio.to_thread(mode.on_disk)
        if on_disk == "another":
            return None
        if mode.levels.is_saved and on_disk == "same":
            mode.ui.tell("It is already saved.")
            return True
        level = mode.levels.edited
        mode.ui.tell("Saving…")
        try:
            saved = await asyncio.to_thread(save_level, level, file)
        except InputError as error:
            mode.ui.warn(str(error))
            return False
        mode.saved(level, saved)
        return True


async def save_as(mode: EditMode) -> bool:
    level = mode.levels.edited
    dialog = SaveLevel(level, _proposal(mode), mode.own, mode.file)
    saved = await mode.ui.ask(dialog)
    if saved is None:
        return False
    mode.editor.do("title", lambda level: set_words(level, title=saved.title))
    mode.saved(mode.levels.edited, saved)
    return True


async def ask_what_to_keep(mode: EditMode) -> None:
    """Wait for saving to end, ask what to do with unsaved changes, and leave editing."""
    async with mode.saving:
        is_saved = mode.levels.is_saved
    if is_saved:
        mode.leave()
        return
    answers = [("keep", "Keep as a level"), ("game", "Just for this game"), ("away", "Throw away")]
    if mode.file is not None:
        answers.insert(0, ("save", "Save"))
    question = "What should happen to your changes to the level?"
    answer = await mode.ui.choose("Leave editing", question, answers)
    if answer == "away":
        mode.throw_away()
    elif (answer == "save" and not await save(mode)) or (
        answer == "keep" and not await save_as(mode)
    ):
        return
    if answer is not None:
        mode.leave()


async def ask_to_throw_away(mode: EditMode) -> None:
    if not mode.levels.has_changes:
        mode.ui.tell("Nothing has changed.")
        return
    answers = [("no", "No, keep them"), ("yes", "Yes, throw them away")]
    question = "Throw all changes away? Undo restores them until you leave the level."
    if await mode.ui.choose("Throw away", question, answers) == "yes":
        mode.throw_away()
        mode.redraw()


def _proposal(mode: EditMode) -> str:
    if mode.file is not None:
        other = mode.file.with_stem(f"{mode.file.stem}-2")
        return other.stem if other.parent == mode.own else str(other)
    name = mode.levels.saved.name
    if not mode.levels.saved.source:  # a new level is named after its title
        words = re.findall(r"[^\W_]+", mode.levels.edited.title.lower())
        return "-".join(words) or name
    return f"my-{name.lstrip('0123456789-') or name}"


class SaveLevel(SaveDialog[Level]):
    """Saves a level with a title, keeping its file's formatting as far as possible."""

    DEFAULT_CSS = """
    SaveLevel .label { color: $ink-dim; height: 1; }
    """

    heading = "Save the level as"
    keys = "enter save   tab title   esc close"

    def __init__(self, level: Level, name: str, own: Path, file: Path | None) -> None:
        super().__init__(name)
        self._level = level
        self._own = own
        self._file = file

    def content_widgets(self) -> ComposeResult:
        yield Static("File name", classes="label", markup=False)
        yield from super().content_widgets()
        yield Static("Title", classes="label", markup=False)
        yield Input(self._level.title, id="title", select_on_focus=False)

    def file(self, name: str) -> Path:
        return target(name, self._own, folder="levels", suffixes=SUFFIXES, usual=NATIVE)

    async def save(self, path: Path) -> Level:
        title = self.query_one("#title", Input).value.strip()
        level = set_words(self._level, title=title or self._level.title)
        return await asyncio.to_thread(save_level, level, path, anew=path != self._file)
