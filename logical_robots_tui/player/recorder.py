"""Records the player's progress at the current level, and measures victories."""

from __future__ import annotations

import asyncio
import queue
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from logical_robots_tui.game import ProgramSource, level_key
from logical_robots_tui.game.source import shipped_texts
from logical_robots_tui.game.victory import Victory, references_for
from logical_robots_tui.player.drafts import Draft
from logical_robots_tui.player.session_state import SessionListener, Ui, nothing
from logical_robots_tui.progress import NEW, Bests, LevelRecord, Measures, Progress, Version
from logical_robots_tui.world import Level
from logical_robots_tui.world.level import SecondGoal

if TYPE_CHECKING:
    from logical_robots_tui.game import Frame
    from logical_robots_tui.game.measuring import Trial
    from logical_robots_tui.mind import Program

THEME, TOUR, LAST_LEVEL, SPEED = "theme", "tour", "level", "speed"
"""Facts in the player's record: that the tour is over; theme, level and speed as they were last."""

T = TypeVar("T")


class ProgressRecorder(SessionListener):
    """The player's record on disk; nothing here delays a key, but `progress` itself blocks.

    Attributes:
        references: Measures of the reference programs there by name, the solution first.
        latest: The measures of the last victory, if it counts.
        former: The bests before the last victory.
        is_mixed: Whether several programs won it, so that `latest` is measured from the start.
    """

    def __init__(self, file: Path) -> None:
        self._news: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.progress = Progress(file, self._news.put)
        self.record: LevelRecord = NEW
        self.references: Mapping[str, Measures] = {}
        self.goals: tuple[SecondGoal, ...] = ()
        self.latest: Measures | None = None
        self.former: Bests = NEW.bests
        self.is_mixed = False
        self._writer = ThreadPoolExecutor(
            max_workers=1, thread_name_prefix="logical-robots-recorder"
        )
        self._key = ""
        self._trials: dict[str, tuple[str, Trial]] = {}
        self._turn = asyncio.Lock()
        self._title = ""
        self._has_begun = False
        self._is_closed = False

    def attach(
        self,
        ui: Ui,
        *,
        on_change: Callable[[], None],
        on_measured: Callable[[Level, Measures, bool], None],
    ) -> None:
        """Connect to a screen; `on_measured` gets level, measures, and if the level is current."""
        self._ui, self._on_change, self._on_measured = ui, on_change, on_measured

    async def close(self) -> None:
        """Finish writing, and close the file."""
        self._is_closed = True
        await asyncio.get_running_loop().run_in_executor(self._writer, self.progress.close)
        self._writer.shutdown(wait=False)

    @property
    def trial(self) -> Trial | None:
        entry = self._trials.get(self._key)
        return entry[1] if entry else None

    async def ask(self, query: Callable[[Progress], T]) -> T:
        """Query the record, after all pending writes."""
        reply = await asyncio.get_running_loop().run_in_executor(self._writer, query, self.progress)
        while not self._news.empty():
            self._ui.warn(self._news.get())
        return reply

    async def newest(self, level: Level) -> str | None:
        return await self.ask(lambda progress: progress.newest(level_key(level)))

    async def versions(self) -> list[Version]:
        key = self._key
        return await self.ask(lambda progress: progress.versions(key))

    def level_opened(self, level: Level) -> None:
        self._key, self.references = level_key(level), references_for(level)
        self.goals = level.second_goals
        self.record, self.latest, self._has_begun = NEW, None, False

        def note_level(progress: Progress) -> None:
            if level.source:  # without a file it can't be opened again
                progress.set_fact(LAST_LEVEL, level_key(level))

        self._write(note_level)

    def level_saved(self, level: Level) -> None:
        if level_key(level) != self._key:
            self.level_opened(level)

    def program_used(self, program: Program) -> None:
        """Keep the program of the first team as a version, if it is the player's own."""
        key, text = self._key, program.first.text

        def keep(progress: Progress) -> None:
            if text not in shipped_texts().values():
                progress.keep(key, text)

        self._write(keep)

    def tick_shown(self, frame: Frame) -> None:
        if frame.tick and not self._has_begun:
            self._has_begun = True
            key = self._key
            self._write(lambda progress: progress.begin(key))

    def reveal(self, hints: int) -> None:
        key, self.record = self._key, self.record._replace(hints=hints)
        self._write(lambda progress: progress.reveal(key, hints))

    def answer(self, question: str, query: str) -> None:
        key, answers = self._key, dict(self.record.answers) | {question: query}
        self.record = self.record._replace(answers=tuple(sorted(answers.items())))
        self._write(lambda progress: progress.answer(key, question, query))

    def keep(self, *texts: str) -> None:
        key = self._key
        self._write(lambda progress: progress.keep(key, *texts))

    def set_aside(self, draft: Draft) -> None:
        """Keep a draft's text for its level, or the current one, but not as the newest version."""
        key = draft.level or self._key

        def keep(progress: Progress) -> None:
            source = ProgramSource.of_draft(draft.path, draft.name)
            progress.keep_aside(key, draft.text, source.text)

        self._write(keep)

    def set_fact(self, name: str, text: str) -> None:
        self._write(lambda progress: progress.set_fact(name, text))

    def won(self, victory: Victory) -> None:
        counts = victory.verdict == "counts"
        self.former, self.latest = self.record.bests, victory.measures if counts else None
        self.is_mixed = victory.measures is None
        if not counts:
            return
        key, text = self._key, victory.program.text
        self._write(lambda progress: progress.win(key, text, victory.measures))
        if self._trials.get(key, ("",))[0] != text:
            measure = partial(self._measure, victory.level, key, victory.program)
            self._ui.spawn(measure, f"measure {key}", exclusive=True)

    def stop_measuring(self) -> bool:
        if self._trials.pop(self._key, None) is None:
            return False
        self._ui.spawn(nothing, f"measure {self._key}", exclusive=True)
        self._on_change()
        return True

    def _write(self, work: Callable[[Progress], None]) -> None:
        if self._is_closed:
            return
        self._writer.submit(work, self.progress)
        self._ui.spawn(self._reload, "recorder", exclusive=False)

    async def _reload(self) -> None:
        key = self._key
        record = await self.ask(lambda progress: progress.record(key))
        if key == self._key and record != self.record:
            # What is revealed meanwhile is not hidden again.
            self.record = record._replace(hints=max(record.hints, self.record.hints))
            self._on_change()

    async def _measure(self, level: Level, key: str, program: Program) -> None:
        from logical_robots_tui.game.measuring import MeasuringError, Trial, measure

        text = program.text
        measures = await self.ask(lambda progress: progress.measures(key, text))
        later_goals = {goal.words for goal in level.second_goals if goal.is_tried_later}
        if measures is None or measures.wins is None or not later_goals.issubset(measures.goals):
            entry = (text, Trial(waits_for=self._title if self._turn.locked() else ""))
            self._trials[key] = entry
            self._on_change()

            def update(trial: Trial) -> None:
                if key in self._trials:
                    self._trials[key] = (text, trial)
                    self._on_change()

            try:
                async with self._turn:  # one at a time: there may be few processors
                    self._title = level.title
                    update(Trial())
                    measures = await measure(level, program, measures, update)
            except MeasuringError:
                self._ui.warn("The robustness test failed.")
                return
            finally:
                if self._trials.get(key, entry)[0] == text:
                    self._trials.pop(key, None)
                self._on_change()
        if measures is None:
            self._ui.warn("The program does not win from the start: it was changed during the run.")
        else:
            final = measures
            self._write(lambda progress: progress.win(key, text, final))
            self._on_measured(level, final, key == self._key)
            if key == self._key:
                self.latest = final
                self._on_change()
