"""Hints, the lesson, the reference programs, and the player's earlier versions, in dialogs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui.progress import Version

if TYPE_CHECKING:
    from logical_robots_tui.player.learning import Learning
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramText
    from logical_robots_tui.tui.app.ui import Dialogs


@dataclass(eq=False)
class LearningController:
    learning: Learning
    session: Session
    ui: Dialogs
    program: ProgramText

    def hints(self) -> None:
        from logical_robots_tui.tui.learning.reader import Hints

        if self.learning.revealed or self.learning.reveal_next():
            dialog = Hints(self.session.level, self.learning)
            self.ui.show(dialog, lambda wish: self.lesson() if wish else None)

    def lesson(self) -> None:
        from logical_robots_tui.tui.learning.reader import TextReader, markdown

        learning, title = self.learning, self.session.level.title
        if text := learning.lesson():
            dialog = TextReader(f"Lesson · {title}", markdown(text), learning.answered)
            self.ui.show(dialog, lambda wish: self.questions() if wish else None)

    def questions(self) -> None:
        from logical_robots_tui.tui.learning.questions import LevelQuestions

        level = self.session.level
        if level.questions:
            self.ui.show(LevelQuestions(level, self.learning, self.session.clock))
        else:
            self.ui.tell("This level has no questions.")

    async def solution(self) -> None:
        from logical_robots_tui.tui.learning.reader import TextReader, colour_code

        if text := await self.learning.solution():
            self.ui.show(TextReader(f"References · {self.session.level.title}", colour_code(text)))

    async def choose_version(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf

        versions = await self.learning.versions()
        if not versions:
            return
        matches = [version for version in versions if version.text == self.program.text]
        shelf = VersionShelf(versions, self.program.text)
        name = shelf.names()[versions.index(matches[0])] if matches else ""
        version = await self.ui.ask(Chooser[Version](shelf, name))
        if version is not None:
            self.learning.restore(version)
