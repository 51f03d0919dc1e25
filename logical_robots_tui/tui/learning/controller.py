"""Hints, the lesson, the reference programs, and the player's earlier versions, in dialogs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.progress import Version
from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.player.learning import Learning
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramText
    from logical_robots_tui.tui.app.ui import Dialogs


class LearningController:
    def __init__(
        self, learning: Learning, session: Session, ui: Dialogs, program: ProgramText
    ) -> None:
        self._learning, self._session, self._ui = learning, session, ui
        self._program = program

    def hints(self) -> None:
        from logical_robots_tui.tui.learning.reader import Hints

        if self._learning.revealed or self._learning.reveal_next():
            self._ui.show(Hints(self._session.level, self._learning))

    def lesson(self) -> None:
        from logical_robots_tui.tui.learning.reader import Reader, markdown

        if text := self._learning.lesson():
            self._ui.show(Reader(f"Lesson · {self._session.level.title}", markdown(text)))

    async def solution(self) -> None:
        from logical_robots_tui.tui.learning.reader import Reader, colour_code

        learning = self._learning
        if not await learning.may_read_references():
            return
        if not learning.has_won:
            answers = [("no", "No, I'll keep trying"), ("yes", "Yes, show it")]
            question = with_keys(
                "Do you want to see winning programs before you have won? "
                "A hint ({hint}) may be all you need."
            )
            if await self._ui.choose("Reference programs", question, answers) != "yes":
                return
        if text := await learning.references():
            self._ui.show(Reader(f"References · {self._session.level.title}", colour_code(text)))

    async def choose_version(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf

        versions = await self._learning.versions()
        if not versions:
            return
        here = [version for version in versions if version.text == self._program.text]
        shelf = VersionShelf(versions)
        name = shelf.names()[versions.index(here[0])] if here else ""
        version = await self._ui.ask(Chooser[Version](shelf, name))
        if version is not None:
            self._learning.restore(version)

    async def reset(self) -> None:
        starter = await self._learning.starter()
        answers = [("yes", "Yes, start over"), ("no", "No, keep mine")]
        question = with_keys(
            "Put the starter program back? Yours is kept among the earlier versions ({versions})."
        )
        asked = self._ui.choose
        if starter and await asked("Reset to the starter", question, answers) == "yes":
            self._learning.reset(starter)
