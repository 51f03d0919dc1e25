"""Saving the text of the editor as a program of the player's own."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING

from textual import on
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Input, Static

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Source, load_program, save_program
from logical_robots_tui.game.naming import target
from logical_robots_tui.tui.background import in_background
from logical_robots_tui.tui.dialogs.dialog import Dialog
from logical_robots_tui.tui.plain import one_line

if TYPE_CHECKING:
    from pathlib import Path

    from textual.app import ComposeResult

__all__ = ["SaveAs"]


class SaveAs(Dialog[Source]):
    """Asks for a name and saves; gives the saved program.

    Args:
        source: The program that the text began with.
        text: What to save.
        own: Folder of the player's programs.
    """

    DEFAULT_CSS = """
    SaveAs > #box { max-width: 72; padding: 1 2 0 2; }
    """

    def __init__(self, source: Source, text: str, own: Path) -> None:
        super().__init__()
        self._source = source
        self._text = text
        self._own = own
        self._confirmed: Path | None = None

    def compose(self) -> ComposeResult:
        """The name, and what is wrong with it."""
        with Vertical(id="box") as box:
            box.border_title = "Save the program as"
            yield Input(self._proposal(), id="name", select_on_focus=False)
            yield Static(id="complaint")
            yield Static("enter save   esc close", id="keys", markup=False)

    @on(Input.Changed)
    def _changed(self) -> None:
        self._confirmed = None
        self.query_one("#complaint").display = False

    @on(Input.Submitted)
    def _submitted(self, event: Input.Submitted) -> None:
        in_background(self, partial(self._save, event.value.strip()), "save", exclusive=True)

    async def _save(self, name: str) -> None:
        try:
            path = target(name, self._own)
            if path.exists() and path != self._source.path and path != self._confirmed:
                self._confirmed = path
                self._complain(f"{path.stem} is there already. Press enter again to replace it.")
                return
            await asyncio.to_thread(save_program, path, self._text)
            self.dismiss(await asyncio.to_thread(load_program, path))
        except InputError as error:
            self._complain(str(error))

    def _complain(self, message: str) -> None:
        complaint = self.query_one("#complaint", Static)
        complaint.update(Content(one_line(message)))
        complaint.display = True

    def _proposal(self) -> str:
        source = self._source
        if source.shipped:
            return f"my-{source.name}"
        return source.name if source.path.parent == self._own else str(source.path)
