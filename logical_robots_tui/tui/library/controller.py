"""Choosing a level or a program, saving under another name, and the ladder of an arena."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource

if TYPE_CHECKING:
    from logical_robots_tui.game.replay import Replay
    from logical_robots_tui.player.board import BoardRecorder
    from logical_robots_tui.player.library import Library
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramText
    from logical_robots_tui.tui.app.ui import Dialogs
    from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing


@dataclass(eq=False)
class LibraryController:
    library: Library
    session: Session
    ui: Dialogs
    recorder: ProgressRecorder
    program: ProgramText
    own_levels: Path
    drawing: Callable[[], Drawing]
    make_level: Callable[[], Awaitable[None]]

    async def choose_level(self) -> None:
        from logical_robots_tui.tui.library.level_screen import LevelScreen

        choice = LevelScreen(self.session.opened, self.recorder, self.drawing(), self.own_levels)
        level = await self.ui.ask(choice)
        if level == "new":
            await self.make_level()
        elif level == "daily":
            await self.library.open_daily()
        elif level is not None:
            await self.library.open_level(level)

    async def choose_program(self) -> None:
        from logical_robots_tui.player.learning import is_spoiler
        from logical_robots_tui.tui.library.chooser import Chooser, ProgramShelf

        progress = self.recorder.progress
        shelf = ProgramShelf(self.library.programs, lambda name: is_spoiler(name, progress))
        source = await self.ui.ask(Chooser[ProgramSource](shelf, self.session.source.name))
        if source is not None:
            self.library.open_program(source)

    async def save(self) -> None:
        if self.session.source.shipped:
            await self.save_as()
        else:
            await self.library.save()

    async def save_as(self) -> None:
        from logical_robots_tui.tui.library.save_dialog import SaveAs

        former, text = self.session.source, self.program.text
        saved = await self.ui.ask(SaveAs(former, text, self.library.programs))
        if saved is not None:
            self.library.saved(former, saved)


@dataclass(eq=False)
class LadderController:
    """Hands programs in and shows ranks; `open_replay` opens a match in the game."""

    board: BoardRecorder
    session: Session
    ui: Dialogs
    program: ProgramText
    open_replay: Callable[[Replay], Awaitable[None]]

    async def hand_in(self) -> None:
        try:
            await self.board.hand_in(self.program.text)
        except InputError as error:
            self.ui.warn(str(error))
        else:
            self.ui.tell("Handed in. It plays in the background; the ladder shows its rank.")

    async def show(self) -> None:
        from logical_robots_tui.tui.library.ladder import LadderDialog

        try:
            challengers = await self.board.challengers()
            dialog = LadderDialog(self.session.opened.title, challengers)
            opponent = await self.ui.ask(dialog)
            if opponent is not None:
                await self.open_replay(await self.board.match(opponent))
        except InputError as error:
            self.ui.warn(str(error))
