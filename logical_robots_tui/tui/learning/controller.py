"""Hints, the lesson, the reference programs, and the player's earlier versions."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Source, load_program
from logical_robots_tui.game.source import is_hidden, reference_names
from logical_robots_tui.progress import Version
from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.player.recorder import ProgressRecorder
    from logical_robots_tui.player.session import Session
    from logical_robots_tui.player.session_state import ProgramText
    from logical_robots_tui.tui.app.ui import Dialogs


class LearningController:
    def __init__(
        self,
        session: Session,
        ui: Dialogs,
        recorder: ProgressRecorder,
        program: ProgramText,
        open_program: Callable[[Source, str], None],
    ) -> None:
        self._session, self._ui, self._recorder = session, ui, recorder
        self._program, self._open_program = program, open_program

    def hints(self) -> None:
        from logical_robots_tui.tui.learning.reader import Hints

        level, recorder = self._session.level, self._recorder
        if level.hints:
            hints = Hints(level.title, level.hints, recorder.record.hints, recorder.reveal)
            self._ui.show(hints)
        else:
            self._ui.tell("This level has no hints.")

    def lesson(self) -> None:
        from logical_robots_tui.tui.learning.reader import Reader, markdown

        level = self._session.level
        parts = [level.lesson]
        if level.further and self._recorder.record.state == "won":
            parts.append(f"## Further\n\n{level.further}")
        text = "\n\n".join(filter(None, parts))
        if text:
            self._ui.show(Reader(f"Lesson · {level.title}", markdown(text)))
        else:
            self._ui.tell("This level has no lesson.")

    async def solution(self) -> None:
        from logical_robots_tui.tui.learning.reader import Reader, colour_code

        level = self._session.level
        if not level.solution:
            self._ui.tell("This level has no reference program.")
            return
        if await asyncio.to_thread(is_hidden, level.solution):
            self._ui.tell("You can read the reference programs when you have won this level.")
            return
        if self._recorder.record.state != "won":
            answers = [("no", "No, I'll keep trying"), ("yes", "Yes, show it")]
            question = with_keys(
                "Do you want to see winning programs before you have won? "
                "A hint ({hint}) may be all you need."
            )
            if await self._ui.choose("Reference programs", question, answers) != "yes":
                return
        try:
            names = await asyncio.to_thread(reference_names, level.solution)
            sources = [await asyncio.to_thread(load_program, name) for name in names]
        except InputError as error:
            self._ui.warn(str(error))
            return
        text = "\n\n".join(source.text for source in sources)
        self._ui.show(Reader(f"References · {level.title}", colour_code(text)))

    async def choose_version(self) -> None:
        from logical_robots_tui.tui.library.chooser import Chooser, VersionShelf

        versions = await self._recorder.versions()
        if not versions:
            self._ui.tell("No earlier versions yet. Each program that you apply becomes one.")
            return
        here = [version for version in versions if version.text == self._program.text]
        shelf = VersionShelf(versions)
        name = shelf.names()[versions.index(here[0])] if here else ""
        version = await self._ui.ask(Chooser[Version](shelf, name))
        if version is not None and version.text != self._program.text:
            self._recorder.keep(self._program.text, version.text)
            self._program.put(version.text)
            self._session.apply(version.text)
            self._ui.tell("The earlier version is back.")

    async def reset(self) -> None:
        level = self._session.level
        if not level.starter:
            self._ui.tell("This level has no starter program.")
            return
        try:
            starter = await asyncio.to_thread(load_program, level.starter)
        except InputError as error:
            self._ui.warn(str(error))
            return
        if starter.text == self._program.text:
            self._ui.tell("This is the starter program.")
            return
        answers = [("yes", "Yes, start over"), ("no", "No, keep mine")]
        question = with_keys(
            "Put the starter program back? Yours is kept among the earlier versions ({versions})."
        )
        if await self._ui.choose("Reset to the starter", question, answers) == "yes":
            self._recorder.keep(self._program.text, starter.text)
            self._open_program(starter, starter.text)
            self._ui.tell("The starter program is back.")
