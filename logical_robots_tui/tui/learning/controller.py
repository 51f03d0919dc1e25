"""What helps a player on: hints, the lesson, the reference program, and one's earlier versions.

Dialogs are loaded when they are asked for, so that the first picture comes sooner.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program
from logical_robots_tui.progress import Version
from logical_robots_tui.tui.commands.keymap import with_keys

if TYPE_CHECKING:
    from logical_robots_tui.tui.app.main_screen import MainScreen

__all__ = ["Guide"]


class Guide:
    """Answers to "what now?" at the level of a screen.

    Args:
        screen: Whose level and program.
    """

    def __init__(self, screen: MainScreen) -> None:
        self._screen = screen

    def hints(self) -> None:
        """Show the hints revealed so far, and reveal more when asked."""
        from logical_robots_tui.tui.learning.hints import Hints

        level, journal = self._screen.session.level, self._screen.journal
        if level.hints:
            hints = Hints(level.title, level.hints, journal.record.hints, journal.reveal)
            self._screen.app.push_screen(hints)
        else:
            self._screen.tell("This level has no hints.")

    def lesson(self) -> None:
        """Show the lesson and, after a victory, what to try next."""
        from logical_robots_tui.tui.learning.reader import Reader, markdown

        level = self._screen.session.level
        parts = [level.lesson]
        if level.further and self._screen.journal.record.state == "won":
            parts.append(f"## Further\n\n{level.further}")
        text = "\n\n".join(filter(None, parts))
        if text:
            self._screen.app.push_screen(Reader(f"Lesson · {level.title}", markdown(text)))
        else:
            self._screen.tell("This level has no lesson.")

    async def solution(self) -> None:
        """Show the reference program; before a victory only to somebody who insists."""
        from logical_robots_tui.tui.layout.question import Question
        from logical_robots_tui.tui.learning.reader import Reader, coloured

        screen = self._screen
        level = screen.session.level
        if not level.solution:
            screen.tell("This level has no reference program.")
            return
        if screen.journal.record.state != "won":
            answers = [("no", "No, I go on trying"), ("yes", "Yes, show it")]
            question = with_keys(
                "See the program that wins before you have won? "
                "A hint ({hint}) may be all you need."
            )
            asked = Question("Reference program", question, answers)
            if await screen.app.push_screen_wait(asked) != "yes":
                return
        try:
            source = await asyncio.to_thread(load_program, level.solution)
        except InputError as error:
            screen.warn(str(error))
            return
        await screen.app.push_screen(Reader(f"Reference · {source.name}", coloured(source.text)))

    async def choose_version(self) -> None:
        """Ask for an earlier version and think with it; what stands in the editor is kept."""
        from logical_robots_tui.tui.library.chooser import Chooser
        from logical_robots_tui.tui.library.shelves import VersionShelf

        screen = self._screen
        versions = await screen.journal.versions()
        if not versions:
            screen.tell("No earlier versions yet: each program that you apply will be kept.")
            return
        here = [version for version in versions if version.text == screen.text]
        shelf = VersionShelf(versions)
        name = shelf.names()[versions.index(here[0])] if here else ""
        version = await screen.app.push_screen_wait(Chooser[Version](shelf, name))
        if version is not None and version.text != screen.text:
            screen.journal.keep(screen.text, version.text)
            screen.replace_text(version.text)
            screen.session.apply(version.text)
            screen.tell("The earlier version is back.")

    async def reset(self) -> None:
        """Put the level's starter program back, if the player means it."""
        from logical_robots_tui.tui.layout.question import Question

        screen = self._screen
        level = screen.session.level
        if not level.starter:
            screen.tell("This level has no starter program.")
            return
        try:
            starter = await asyncio.to_thread(load_program, level.starter)
        except InputError as error:
            screen.warn(str(error))
            return
        if starter.text == screen.text:
            screen.tell("This is the starter program.")
            return
        answers = [("yes", "Yes, begin anew"), ("no", "No, keep mine")]
        question = with_keys(
            "Put the starter program back? Yours is kept among the earlier versions ({versions})."
        )
        asked = Question("Reset to the starter", question, answers)
        if await screen.app.push_screen_wait(asked) == "yes":
            screen.journal.keep(screen.text, starter.text)
            screen.library.open_program(starter, starter.text)
            screen.tell("The starter program is back.")
