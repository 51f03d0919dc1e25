"""Choosing a level or a program, and saving under another name."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.game import ProgramSource

if TYPE_CHECKING:
    from logical_robots_tui.player.library import Library
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramText
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing


class LibraryController:
    def __init__(
        self,
        library: Library,
        session: Session,
        ui: Dialogs,
        recorder: ProgressRecorder,
        program: ProgramText,
        own_levels: Path,
        *,
        drawing: Callable[[], Drawing],
        make_level: Callable[[], Awaitable[None]],
    ) -> None:
        self._library, self._session, self._ui, self._recorder = library, session, ui, recorder
        self._program, self._own_levels = program, own_levels
        self._drawing, self._make_level = drawing, make_level

    async def choose_level(self) -> None:
        from logical_robots_tui.tui.library.level_screen import LevelScreen

        choice = LevelScreen(
            self._session.opened, self._recorder, self._drawing(), self._own_levels
        )
        level = await self._ui.ask(choice)
        if level == "new":
            await self._make_level()
        elif level == "daily":
            await self._library.open_daily()
        elif level is not None:
            await self._library.open_level(level)

    async def choose_program(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, ProgramShelf

        chooser = Chooser[ProgramSource](
            ProgramShelf(self._library.programs), self._session.source.name
        )
        source = await self._ui.ask(chooser)
        if source is not None:
            self._library.open_program(source)

    async def save(self) -> None:
        if self._session.source.shipped:
            await self.save_as()
        else:
            await self._library.save()

    async def save_as(self) -> None:
        from logical_robots_tui.tui.library.save_dialog import SaveAs

        former, text = self._session.source, self._program.text
        saved = await self._ui.ask(SaveAs(former, text, self._library.programs))
        if saved is not None:
            self._library.saved(former, saved)
