"""Diagnosis of a run: asks probes tick by tick, also in a process, and reports anomalies."""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import groupby
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.clock import CLOCK
from logical_robots_tui.explain.diagnosis.sites import ProbeTally, check_up
from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.game.advancing import RecordedTick, Thinker
from logical_robots_tui.game.findings import Observations, findings_of, observe
from logical_robots_tui.game.frame import NoSuchTickError, Superseded
from logical_robots_tui.mind import Limits, Program
from logical_robots_tui.mind.compilation import Task, find_result, keep_result
from logical_robots_tui.processes.helper import begin
from logical_robots_tui.processes.messages import TaskHelper, next_task, send_answer

if TYPE_CHECKING:
    from logical_robots_tui.explain.diagnosis.sites import Rows
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.history import History, TickHistory
    from logical_robots_tui.game.run import Run

_FEWEST = 20  # ticks that are examined
_QUESTIONS = 12_000  # most probes of all robots when only some ticks are examined
_MORE_QUESTIONS = 1_000_000  # the same when searching the other ticks for what never happened
_STEP = 12  # the interval while the length of a run is unknown
_MORE_AT_ONCE = 3  # times as many ticks for another process, because it takes longer to ask it
_SAMPLES = 12  # ticks in which a robot's movement is explained
_SECONDS = 0.5  # between two reports of findings


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The result of a diagnosis, the most significant finding first.

    Attributes:
        step: The interval, in ticks, at which everything was examined.
        second_step: The interval of the search for what seemed never to happen.
        left_out: How many places could not be observed.
        given_up: Of these, how many took too long.
        sure: How many of the first findings stay as they are; all when it is finished.
        examined: How many ticks were examined, if it is not finished; otherwise None.
    """

    findings: tuple[Finding, ...]
    first: int
    last: int
    won_at: int | None
    step: int
    second_step: int
    left_out: int
    is_reliable: bool = True
    sure: int = 0
    examined: int | None = None
    given_up: int = 0


PROCESSOR_SECONDS = 3600
"""The longest scan."""

_ROWS = 60  # of sensors, that are examined with one query


_ProbeAnswer: TypeAlias = "tuple[int, str, Sequence[Rows] | None]"
"""A tick, a probe, and its rows there in each view; None if it failed."""


def _ticks_at_once(robots: int) -> int:
    """Return how many ticks are examined with one query."""
    return max(1, _ROWS // max(1, robots))


def scan(
    thinker: Thinker,
    program: Program,
    limits: Limits,
    probes: Sequence[str],
    ticks: Sequence[RecordedTick],
    stop: threading.Event | None = None,
) -> Iterator[_ProbeAnswer]:
    """Yield what probes answer at some ticks; call it in the thinker's thread."""
    for _, group in groupby(ticks, key=lambda tick: id(tick.level)):
        level_ticks = list(group)
        limit = _ticks_at_once(len(level_ticks[0].level.robots))
        for start in range(0, len(level_ticks), limit):
            batch = level_ticks[start : start + limit]
            replays = [thinker.replay(program, tick, limits) for tick in batch]
            frames = [frame for frame, _ in replays]
            inputs = [(frame.sensors, frame.memories_before) for frame in frames]
            for name, number, views in replays[-1][1].predicate_rows_at(probes, inputs, stop=stop):
                yield frames[number].tick, name, views


Ask: TypeAlias = Callable[[Sequence[str], Sequence[int]], Awaitable[list[_ProbeAnswer]]]
Report: TypeAlias = Callable[[int, int], None]
Show: TypeAlias = Callable[[Diagnosis], None]


async def diagnose(
    game: Game, *, report: Report = lambda _done, _all: None, show: Show = lambda _diagnosis: None
) -> Diagnosis:
    """Diagnose the current program over a game's history; cancelling the call stops it.

    `report` gets the work done and the total, `show` what was found so far. Raises QueryError
    for a program that is too complex, Superseded if another branch began.
    """
    last_begin = [begin for begin, _ in game.history.programs(game.history.last)][-1:]
    diagnosis_run = _DiagnosisRun(game.program, Limits(), report=report, show=show)
    return await diagnosis_run.diagnose_history(game.history, *last_begin)


async def diagnose_history(
    history: History, program: Program, limits: Limits, questions: int
) -> Diagnosis:
    """Diagnose a program over ticks with a fixed number of questions, in a reproducible order.

    Raises QueryError for a program that is too complex.
    """
    return await _DiagnosisRun(program, limits, questions).diagnose_history(history)


class _DiagnoseRun(Task, frozen=True):
    parts = ("explain", "game")
    run: str
    ticks: int


async def diagnose_run(
    run: Run,
    ticks: int,
    *,
    on_tick: Callable[[int], object] = lambda _tick: None,
    report: Report = lambda _done, _all: None,
    show: Show = lambda _diagnosis: None,
) -> Diagnosis:
    """Diagnose a run as `diagnose` does, up to its end or for at most `ticks` ticks.

    `on_tick` gets each computed tick. A second process examines ticks at the same time. A
    reproducible result is kept on disk.
    """
    task = _DiagnoseRun(run.key, ticks)
    diagnosis = await asyncio.to_thread(find_result, task, Diagnosis)
    if diagnosis is not None:
        return diagnosis

    async def examine() -> Diagnosis:
        diagnosis_run = _DiagnosisRun(run.program, run.limits, report=report, show=show)
        helper_task = asyncio.create_task(diagnosis_run.help(run))

        def handle_tick(tick: int) -> None:
            on_tick(tick)
            diagnosis_run.offer(tick)

        try:
            last = await run.to_end(ticks, handle_tick)
            return await diagnosis_run.diagnose(run, max(1, run.first_before(last)), last)
        finally:
            helper_task.cancel()
            await asyncio.gather(helper_task, return_exceptions=True)
            await diagnosis_run.close()

    diagnosis = await run.repeat_if_damaged(examine)
    if diagnosis.is_reliable and not diagnosis.given_up:
        await asyncio.to_thread(keep_result, task, diagnosis)
    return diagnosis


def extent(diagnosis: Diagnosis) -> str:
    return f"{ticks_of(diagnosis)}{shortcomings(diagnosis)}"


def ticks_of(diagnosis: Diagnosis) -> str:
    if diagnosis.last < diagnosis.first:
        return "There are no ticks to examine yet."
    end = "won" if diagnosis.won_at is not None else "not won"
    return f"Ticks {diagnosis.first} to {diagnosis.last}, {end}."


def shortcomings(diagnosis: Diagnosis) -> str:
    """Return what was not examined, in sentences after a space, or ""."""
    text, step = "", diagnosis.second_step
    if diagnosis.examined is not None:
        text += f" Only {diagnosis.examined} of these ticks were examined."
    elif step > 1:
        text += f" Only one tick in {step} was examined: rare events may be missed."
    if (count := diagnosis.left_out) > 0:
        text += f" Places not covered, because they are too expensive to examine: {count}."
    if not diagnosis.is_reliable:
        text += " A time limit ended a thought: another run may differ."
    return text


class _DiagnosisRun:
    """A diagnosis in progress: a queue of ticks, and the counts of those examined."""

    def __init__(
        self,
        program: Program,
        limits: Limits,
        questions: int = _MORE_QUESTIONS,
        report: Report = lambda _done, _all: None,
        show: Show = lambda _diagnosis: None,
    ) -> None:
        self._program, self._limits, self._questions = program, limits, questions
        self._report, self._show = report, show
        self._thinker = Thinker("diagnose")
        self._preparing = asyncio.create_task(self._prepare())
        # Ticks to examine: some first, to find out what need not be looked for in the others.
        self._first_ticks: deque[int] = deque()
        self._other_ticks: deque[int] = deque()
        self._step, self._second_step = _STEP, 0
        self._last_offered = self._done_count = self._pending = 0
        self._is_complete = False  # whether all ticks were offered
        self._changed = asyncio.Event()
        self._summarise: Callable[[], Diagnosis] | None = None
        self._due = 0.0

    async def close(self) -> None:
        self._preparing.cancel()
        await asyncio.gather(self._preparing, return_exceptions=True)
        await self._thinker.close()

    def offer(self, last: int) -> None:
        for tick in range(self._last_offered + 1, last + 1):
            (self._other_ticks if tick % self._step else self._first_ticks).append(tick)
        self._last_offered = max(self._last_offered, last)
        self._changed.set()

    async def help(self, run: Run) -> None:
        """Examine ticks of a run in another process, until cancelled or until that fails."""
        tally = await asyncio.shield(self._preparing)
        helper: TaskHelper | None = None
        tasks: list[object] = [(tally.checkup.program, run.level, run.limits)]

        async def ask(probes: Sequence[str], ticks: Sequence[int]) -> list[_ProbeAnswer]:
            nonlocal helper
            helper = helper or TaskHelper(__name__)
            tasks.append((probes, [run.recorded(tick)[1:] for tick in ticks]))
            return await asyncio.to_thread(exchange, helper)

        def exchange(helper: TaskHelper) -> list[_ProbeAnswer]:
            for task in tasks:
                helper.send(task)
            tasks.clear()
            answers: list[_ProbeAnswer] = helper.answer()
            return answers

        try:
            await self._work(tally, ask, len(run.level.robots), is_helping=True)
        finally:
            if helper is not None:
                helper.end()

    async def diagnose_history(self, history: History, first: int = 1) -> Diagnosis:
        try:
            return await self.diagnose(history, max(first, history.first), history.last)
        finally:
            await self.close()

    async def diagnose(self, history: TickHistory, first: int, last: int) -> Diagnosis:
        turns = history.turns
        if last < first:
            return Diagnosis((), first, last, None, 1, 1, 0)
        tally = await asyncio.shield(self._preparing)
        observed = await observe(history, first, last)
        level = history.level_at(last)
        close_tallies: dict[tuple[str, int], ProbeTally] = {}

        def stored(ticks: Sequence[int]) -> list[RecordedTick]:
            if history.turns != turns:
                raise Superseded
            recorded = []
            for tick in ticks:
                with suppress(NoSuchTickError):  # it was dropped in the meantime
                    recorded.append(history.recorded(tick))
            return recorded

        async def ask(probes: Sequence[str], ticks: Sequence[int]) -> list[_ProbeAnswer]:
            program, limits, stored_ticks = tally.checkup.program, self._limits, stored(ticks)
            return await self._thinker.do(
                lambda stop: [*scan(self._thinker, program, limits, probes, stored_ticks, stop)]
            )

        def summarise(*, is_final: bool = False) -> Diagnosis:
            is_complete = is_final and self._second_step <= 1
            parts = findings_of(tally, observed, close_tallies, level, is_complete=is_complete)
            settled, counted = parts
            return Diagnosis(
                (*settled, *counted),
                first,
                last,
                observed.won_at,
                self._step,
                max(1, self._second_step),
                tally.checkup.skipped_probes + len(tally.failed_probes),
                history.is_reliable_up_to(last),
                len(settled) + len(counted) * is_final,
                None if is_final else self._done_count,
                len(tally.failed_probes),
            )

        for robot, ticks in _movement_samples(observed):
            close_tallies[robot, ticks[0]] = tally_nearby = ProbeTally(tally.checkup, robot)
            await self._look_closely(tally_nearby, stored(ticks), robot)
        self._summarise = summarise
        self._show(summarise())
        robots = max(1, len(level.robots))
        if not self._last_offered:
            questions = max(1, len(tally.doubtful_probes()) * robots)
            self._step = max(1, -(-(last + 1 - first) // max(_FEWEST, _QUESTIONS // questions)))
            self._last_offered = first - 1
        self._is_complete = True
        self.offer(last)
        await self._work(tally, ask, robots)
        stored(())
        return summarise(is_final=True)

    async def _prepare(self) -> ProbeTally:
        program, limits = self._program, self._limits
        return ProbeTally(
            await self._thinker.do(lambda stop: check_up(program, stop=stop, limits=limits))
        )

    async def _work(
        self, tally: ProbeTally, ask: Ask, robots: int, *, is_helping: bool = False
    ) -> None:
        """Count the rows of all probes that are not settled, some ticks at a time."""
        limit = _ticks_at_once(robots) * (_MORE_AT_ONCE if is_helping else 1)
        while is_helping or self._pending or self._waiting:
            probes = tally.doubtful_probes()
            ticks = self._next_ticks(len(probes) * robots, limit, is_helping=is_helping)
            if not ticks:
                if is_helping or self._pending:
                    self._changed.clear()
                    await self._changed.wait()
                continue
            self._pending += len(ticks)
            try:
                answers = await ask(probes, ticks)
            except BaseException:
                self._other_ticks.extendleft(ticks)
                raise
            finally:
                self._pending -= len(ticks)
                self._changed.set()
            for tick, name, views in answers:
                tally.add(tick, name, views)
            self._done_count += len(ticks)
            self._report(self._done_count, self._done_count + self._pending + self._waiting)
            if self._summarise is not None and CLOCK.now() >= self._due:
                self._show(self._summarise())
                self._due = CLOCK.now() + _SECONDS

    @property
    def _waiting(self) -> int:
        return len(self._first_ticks) + len(self._other_ticks)

    def _next_ticks(self, questions: int, limit: int, *, is_helping: bool) -> list[int]:
        """Return the next ticks to examine; none if nothing is left to be found out."""
        if not questions:
            self._first_ticks.clear()
            self._other_ticks.clear()
        if is_helping and self._waiting <= limit:
            return []
        if self._is_complete and not self._first_ticks and not self._second_step:
            self._second_step = max(1, -(-len(self._other_ticks) * questions // self._questions))
            self._other_ticks = deque([*self._other_ticks][:: self._second_step])
        queue = self._first_ticks or self._other_ticks
        return [queue.popleft() for _ in range(min(limit, len(queue)))]

    async def _look_closely(
        self, tally: ProbeTally, ticks: Sequence[RecordedTick], robot: str
    ) -> None:
        """Count the rows of all probes, also of values, in the mind of a robot."""
        names = [probe.name for probe in tally.checkup.probes if probe.closeness != "wider"]

        def ask(tick: RecordedTick, stop: threading.Event) -> None:
            frame, mind = self._thinker.replay(tally.checkup.program, tick, self._limits)
            sensors, memories = frame.sensors, frame.memories_before
            for name, rows in mind.predicate_rows(
                names, sensors, memories, viewers=[robot], stop=stop
            ):
                tally.add(frame.tick, name, None if rows is None else [rows])

        for tick in ticks:
            await self._thinker.do(partial(ask, tick))


def _movement_samples(observed: Observations) -> list[tuple[str, list[int]]]:
    samples: dict[tuple[str, int], list[int]] = {}
    for kind in {kind for kind, _ in observed.notices}:
        tick, robot = observed.first_notice(kind)
        samples[robot, tick] = [tick]
    for loss in observed.first_losses():
        samples[loss.robot, loss.tick] = [loss.tick]
    for stretch in observed.stretches:
        length = stretch.period or stretch.last - stretch.first
        last = min(stretch.last, stretch.first + max(length, _SAMPLES))
        step = max(1, (last - stretch.first) // _SAMPLES)
        samples[stretch.robot, stretch.first] = list(range(stretch.first, last + 1, step))
    return [(robot, ticks) for (robot, _), ticks in samples.items()]


def main() -> None:
    begin(PROCESSOR_SECONDS)
    program, level, limits = next_task()
    thinker = Thinker("scan")
    with suppress(EOFError):
        while True:
            probes, moments = next_task()
            ticks = [RecordedTick(level, previous, moment) for previous, moment in moments]
            send_answer([*scan(thinker, program, limits, probes, ticks)])
