"""Choosing a level or a program, saving under another name, and the board."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import ProgramSource
from logical_robots_tui.player.board import NO_BOARD
from logical_robots_tui.wording import one_line

if TYPE_CHECKING:
    from textual.content import Content

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
    board: BoardRecorder

    async def choose_level(self) -> None:
        from logical_robots_tui.tui.library.level_screen import LevelScreen

        choice = LevelScreen(
            self.session.opened,
            self.recorder,
            self.drawing(),
            self.own_levels,
            self.board.standings_of,
        )
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
            await self.library.save_as(self.session.source.path)

    async def save_as(self) -> None:
        from logical_robots_tui.tui.library.save_dialog import SaveAs

        former, text = self.session.source, self.program.text
        saved = await self.ui.ask(SaveAs(former, text, self.library.programs))
        if saved is not None:
            self.library.saved(former, saved)


@dataclass(eq=False)
class BoardController:
    """What a player does on the board.

    `open_replay` opens a match in the game, `race` shows a run as a ghost with a name.
    """

    board: BoardRecorder
    session: Session
    ui: Dialogs
    program: ProgramText
    open_replay: Callable[[Replay], Awaitable[None]]
    race: Callable[[Replay, str], Awaitable[None]]
    drawing: Callable[[], Drawing]

    def histogram(self) -> list[Content]:
        """Return lines about all who won the level at hand; empty before the player has won it."""
        from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
        from logical_robots_tui.tui.labyrinth.results import histogram_lines

        plain = self.drawing() is Drawing.ASCII
        return list(histogram_lines(self.board.standings, plain=plain))

    async def join(self) -> None:
        """Ask how to be on the board."""
        from logical_robots_tui.tui.library.board import JoinDialog

        if not self.board.is_on:
            raise InputError(NO_BOARD)
        membership = await self.ui.ask(JoinDialog(self.board.membership, self.board.join))
        if membership is not None and not membership.is_listed:
            self.ui.tell("You are not on the board. It has no entries of yours.")

    async def join_once(self) -> None:
        """Ask after the first victory."""
        if self.board.must_ask:
            await self.join()

    async def choose_ghost(self) -> None:
        from logical_robots_tui.progress.board import shown_name
        from logical_robots_tui.tui.library.board import GhostPicker

        entries = await self.board.ghosts()
        if not entries:
            raise InputError("Nobody lets others race their run of this level yet.")
        entry = await self.ui.ask(GhostPicker(entries))
        if entry is not None:
            replay = await self.board.ghost(entry)
            await self.race(replay, f"run of {one_line(shown_name(entry.name))}")

    async def ask_for_help(self) -> None:
        from logical_robots_tui.tui.commands.keymap import with_keys

        await self.board.ask_for_help(self.program.text)
        if self.board.asks_for_help:
            message = "The teacher sees that you need help, and your program. {ask_help} ends it."
        else:
            message = "You no longer ask for help. Your program is hidden again."
        self.ui.tell(with_keys(message))

    async def hand_in(self) -> None:
        await self.board.hand_in(self.program.text)
        self.ui.tell("Handed in. It plays in the background; the ladder shows its rank.")

    async def show_ladder(self) -> None:
        from logical_robots_tui.tui.library.board import LadderDialog

        challengers = await self.board.challengers()
        dialog = LadderDialog(self.session.opened.title, challengers)
        opponent = await self.ui.ask(dialog)
        if opponent is not None:
            await self.open_replay(await self.board.match(opponent))
