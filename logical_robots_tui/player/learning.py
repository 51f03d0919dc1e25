"""Learning: hints, the lesson, the reference programs, and the player's earlier versions."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from logical_robots_tui.game import ProgramSource, load_program
from logical_robots_tui.game.source import is_hidden, is_unsolved, reference_names
from logical_robots_tui.player.recorder import ProgressRecorder
from logical_robots_tui.player.session import Session
from logical_robots_tui.player.session_state import ProgramText, Ui
from logical_robots_tui.progress import Progress, Version
from logical_robots_tui.wording import count_of
from logical_robots_tui.world.level import LevelQuestion


def version_name(version: Version) -> str:
    return f"{version.last_use.astimezone():%d %b %H:%M} #{version.number}"


def version_result(version: Version) -> str:
    measures = version.measures
    if measures is None:
        return "★ won" if version.won else count_of(version.text.count("\n") + 1, "line")
    robust = f", {measures.wins}/{measures.starts}" if measures.wins is not None else ""
    return f"★ {count_of(measures.ticks, 'tick')}{robust}"


def is_spoiler(program: str, progress: Progress) -> bool:
    """Return whether a program solves a level that is neither won nor given up. Blocks."""
    return is_unsolved(program, progress) and progress.fact(_shown(program)) is None


def _shown(solution: str) -> str:
    """Return the fact that the player has asked to see a solution."""
    return f"shown {solution}"


class Learning:
    """Decides what a player may read; tells the reason where there is nothing to read."""

    def __init__(
        self,
        session: Session,
        ui: Ui,
        recorder: ProgressRecorder,
        program: ProgramText,
        open_program: Callable[[ProgramSource, str], None],
        with_keys: Callable[[str], str],
    ) -> None:
        self._session, self._ui, self._recorder = session, ui, recorder
        self._program, self._open_program = program, open_program
        self._with_keys = with_keys

    @property
    def _has_won(self) -> bool:
        return self._recorder.record.state == "won"

    @property
    def revealed(self) -> tuple[str, ...]:
        """The hints that the player has seen."""
        return self._session.level.hints[: self._recorder.record.hints]

    def reveal_next(self) -> bool:
        """Reveal another hint; return whether there was one."""
        number = len(self.revealed) + 1
        is_there = number <= len(self._session.level.hints)
        if is_there:
            self._recorder.reveal(number)
        elif number == 1:
            self._ui.tell("This level has no hints.")
        return is_there

    @property
    def answers(self) -> dict[str, str]:
        """The queries that have answered questions of the level."""
        answers = dict(self._recorder.record.answers)
        prompts = (question.ask for question in self._session.level.questions)
        return {prompt: answers[prompt] for prompt in prompts if prompt in answers}

    @property
    def answered(self) -> str:
        """How many questions are answered, as in ``2 of 3``, or "" if there are none."""
        questions = len(self._session.level.questions)
        return f"{len(self.answers)} of {questions}" if questions else ""

    def answer(self, question: LevelQuestion, query: str) -> None:
        """Keep a right answer."""
        self._recorder.answer(question.ask, query)

    def lesson(self) -> str:
        """Return the lesson as Markdown, after a victory with what to try next, or ""."""
        level = self._session.level
        further = f"## Further\n\n{level.further}" if level.further and self._has_won else ""
        text = "\n\n".join(filter(None, (level.lesson, further)))
        if not text:
            self._ui.tell("This level has no lesson.")
        return text

    async def solution(self) -> str:
        """Return the texts of the reference programs, the solution first, or ""; may ask first."""
        solution = self._session.level.solution
        if not solution:
            self._ui.tell("This level has no reference program.")
            return ""
        if await asyncio.to_thread(is_hidden, solution):
            self._ui.tell("You can read the reference programs when you have won this level.")
            return ""
        answers = [("no", "No, I'll keep trying"), ("yes", "Yes, show it")]
        question = self._with_keys(
            "Do you want to see winning programs before you have won? "
            "A hint ({hint}) may be all you need."
        )
        if not self._has_won:
            if await self._ui.choose("Reference programs", question, answers) != "yes":
                return ""
            self._recorder.set_fact(_shown(solution), "yes")
        names = await asyncio.to_thread(reference_names, solution)
        sources = await asyncio.to_thread(lambda: [*map(load_program, names)])
        return "\n\n".join(source.text for source in sources)

    async def versions(self) -> list[Version]:
        """Return the player's programs for this level, last used first."""
        versions = await self._recorder.versions()
        if not versions:
            self._ui.tell("No earlier versions yet. Each program that you apply becomes one.")
        return versions

    def restore(self, version: Version) -> None:
        """Go back to an earlier version; the present text becomes one."""
        if version.text != self._program.text:
            self._recorder.keep(self._program.text, version.text)
            self._program.put(version.text)
            self._session.apply(version.text)
            self._ui.tell("The earlier version is back.")

    async def reset(self) -> None:
        """Ask, and put the starter program back; the present text becomes an earlier version."""
        level = self._session.level
        if not level.starter:
            self._ui.tell("This level has no starter program.")
            return
        starter = await asyncio.to_thread(load_program, level.starter)
        if starter.text == self._program.text:
            self._ui.tell("This is the starter program.")
            return
        answers = [("yes", "Yes, start over"), ("no", "No, keep mine")]
        question = self._with_keys(
            "Put the starter program back? Yours is kept among the earlier versions ({versions})."
        )
        if await self._ui.choose("Reset to the starter", question, answers) == "yes":
            self._recorder.keep(self._program.text, starter.text)
            self._open_program(starter, starter.text)
            self._ui.tell("The starter program is back.")
