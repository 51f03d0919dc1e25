"""Hints, the lesson, the reference programs, and the player's earlier versions, in dialogs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.progress import Version

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
            dialog = Hints(self._session.level, self._learning)
            self._ui.show(dialog, lambda wish: self.lesson() if wish else None)

    def lesson(self) -> None:
        from logical_robots_tui.tui.learning.reader import TextReader, markdown

        learning, title = self._learning, self._session.level.title
        if text := learning.lesson():
            dialog = TextReader(f"Lesson · {title}", markdown(text), learning.answered)
            self._ui.show(dialog, lambda wish: self.questions() if wish else None)

    def questions(self) -> None:
        from logical_robots_tui.tui.learning.questions import LevelQuestions

        level = self._session.level
        if level.questions:
            self._ui.show(LevelQuestions(level, self._learning, self._session.clock))
        else:
            self._ui.tell("This level has no questions.")

    async def solution(self) -> None:
        from logical_robots_tui.tui.learning.reader import TextReader, colour_code

        if text := await self._learning.solution():
            self._ui.show(
                TextReader(f"References · {self._session.level.title}", colour_code(text))
            )

    async def choose_version(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf

        versions = await self._learning.versions()
        if not versions:
            return
        matches = [version for version in versions if version.text == self._program.text]
        shelf = VersionShelf(versions, self._program.text)
        name = shelf.names()[versions.index(matches[0])] if matches else ""
        version = await self._ui.ask(Chooser[Version](shelf, name))
        if version is not None:
            self._learning.restore(version)
