"""A worker: it runs the starts of a task, one after the other, and returns their results."""

from __future__ import annotations

import asyncio
import os
import re
import socket
from collections import Counter
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import lru_cache, partial
from time import perf_counter, process_time, thread_time
from typing import Any, TypeAlias, TypeVar

import msgspec

from logical_robots_tui.game.advancing import start_frame
from logical_robots_tui.game.debugging.breakpoints import matching_rows, number_of
from logical_robots_tui.game.diagnosing import diagnose_history
from logical_robots_tui.game.frame import Frame, count_home, standing
from logical_robots_tui.game.history.history import History
from logical_robots_tui.game.measuring import LateError, play_through, start_of
from logical_robots_tui.lab.tasks import (
    End,
    Outcome,
    QueryMeasure,
    Result,
    RunFinding,
    RunTask,
    Series,
    WorkerAnswer,
    fingerprint,
)
from logical_robots_tui.language.source_text import size_of
from logical_robots_tui.mind import (
    CompiledQuery,
    Diagnostic,
    Limits,
    Mind,
    Program,
    ProgramError,
    QueryError,
    ResultTable,
    Stopped,
)
from logical_robots_tui.world import AreaState, Level, WorldState
from logical_robots_tui.world.levels.load import read_level

T = TypeVar("T")
IsOver: TypeAlias = Callable[[Frame, Mind], bool]

CHUNK_SECONDS = 5.0
"""Time after which a worker returns its results; at most this and one run are lost with it."""

_SLOW_TICKS = 10  # ticks with too many steps after which a run ends
_MOST_CELLS = 1_000_000  # of all series of a run
_MOST_POINTS = 200  # of a robot's path
_MOST_FINDINGS = 3
_LONGEST_FINDING = 300  # characters
_MOST_EXPLAINED = 200_000_000  # steps of a run that is diagnosed; that takes about as long again
_FINDING_SECONDS, _LOOK_SECONDS = 20.0, 0.5
_QUESTIONS, _QUESTION_STEPS = 100_000, 2_000_000


def execute(task: RunTask) -> WorkerAnswer:
    """Run as many runs of a task as fit into the time of a chunk, at least one."""
    if task.fingerprint != fingerprint():
        return WorkerAnswer(is_refused=True)
    worker = f"{socket.gethostname()}/{os.getpid()}"
    deadline = perf_counter() + CHUNK_SECONDS
    results: list[tuple[int, str, float]] = []
    runner: _TaskRunner | None = None
    for start in task.starts:
        if results and perf_counter() > deadline:
            break
        began = thread_time()
        try:
            runner = runner or _TaskRunner(task)
            result = runner.run(start)
        except (LateError, MemoryError, ProgramError, Stopped) as error:
            is_final = isinstance(error, Stopped)
            return WorkerAnswer(tuple(results), worker, _reason(error, task), is_final=is_final)
        seconds = thread_time() - began
        results.append((start, msgspec.json.encode(result).decode(), seconds))
        if start == 0 and task.given_first and result.outcome != "won":
            break
    return WorkerAnswer(tuple(results), worker)


def _reason(error: Exception, task: RunTask) -> str:
    if isinstance(error, LateError):
        return "a thought took too long or had too little memory"
    if isinstance(error, MemoryError):
        return "the worker has too little memory"
    if isinstance(error, ProgramError):
        return "the program could not be compiled in time"
    return timeout_reason(task)


def timeout_reason(task: RunTask) -> str:
    return f"it took more than {task.seconds:g} second{'s' * (task.seconds != 1)}"


class _TaskRunner:
    def __init__(self, task: RunTask) -> None:
        self.task = task
        self.level: Level = _level(task.level)
        self.limits = Limits(think_steps=task.steps, query_steps=max(task.steps, 200_000_000))
        self.mistakes: tuple[Diagnostic, ...] = ()
        self.questions: dict[QueryMeasure, CompiledQuery] = {}
        try:
            self.program = Program.compile(task.programs)
            self.size = sum(map(size_of, task.programs.values()))
            for measure in task.measures:
                self.questions[measure] = self.program.question(measure.query)
            self.until = self.program.question(task.until) if task.until else None
        except ProgramError as error:
            if error.is_unfinished:
                raise
            self.mistakes = tuple(d for d in error.diagnostics if d.severity == "error")

    def run(self, start: int) -> Result:
        """Return the result from a start.

        Raises LateError if the clock or lack of memory cut off a thought, Stopped if all of them
        took more than the seconds.
        """
        if self.mistakes:
            return Result("does not compile", mistakes=self.mistakes)
        monitor = _RunMonitor(self)
        level, is_over, history = start_of(self.level, start), monitor.is_over, None
        if self.task.is_explained and not start:
            history = History(start_frame(level), level)
            is_over = partial(self._record_frame, history, is_over)
        playthrough = play_through(
            level, self.program, self.task.ticks, limits=self.limits, is_over=is_over
        )
        final_outcome: Outcome = "played" if self.level.teams else "out of ticks"
        if playthrough.won_at is not None:
            history = None
        return Result(
            "won" if playthrough.won_at is not None else monitor.outcome or final_outcome,
            playthrough.ticks,
            playthrough.distance,
            self.size,
            dict(monitor.notices),
            monitor.first,
            monitor.series(),
            points=monitor.points(),
            forfeit=monitor.forfeit(),
            ends=monitor.ends(),
            peak=history.peak(playthrough.ticks).words if history else "",
            paths=_paths(history) if history else {},
            findings=self._findings(history, monitor) if history else (),
            steps=monitor.steps,
            home=monitor.home(),
            time_home=monitor.time_home(),
        )

    def _record_frame(self, history: History, is_over: IsOver, frame: Frame, mind: Mind) -> bool:
        history.add(frame, self.program)
        return is_over(frame, mind)

    def _findings(self, history: History, monitor: _RunMonitor) -> tuple[RunFinding, ...]:
        """Return what stands out in a run, most significant first, if it can be found out."""
        if monitor.outcome in ("too slow", "too many steps") or monitor.steps > _MOST_EXPLAINED:
            return ()
        limits = replace(self.limits, query_steps=_QUESTION_STEPS)
        work = diagnose_history(history, self.program, limits, _QUESTIONS)
        try:
            diagnosis = asyncio.run(_with_timeout(work, _FINDING_SECONDS))
        except (asyncio.CancelledError, MemoryError, QueryError, Stopped):
            return ()
        return tuple(
            RunFinding(f.kind, f.span.line if f.span else 0, f.message[:_LONGEST_FINDING])
            for f in diagnosis.findings[: _MOST_FINDINGS * diagnosis.is_reliable]
        )


def _paths(history: History) -> dict[str, tuple[tuple[int, int], ...]]:
    paths: dict[str, list[tuple[int, int]]] = {}
    step = -(-(history.last - history.first) // _MOST_POINTS) or 1
    for tick in sorted({*range(history.first, history.last, step), history.last}):
        for robot in history.moment(tick).after.robots:
            paths.setdefault(robot.name, []).append((round(robot.x), round(robot.y)))
    return {name: tuple(points) for name, points in paths.items()}


async def _with_timeout(work: Awaitable[T], seconds: float) -> T:
    """Return a result, or raise CancelledError after so many seconds of a processor."""
    task, deadline = asyncio.ensure_future(work), process_time() + seconds
    while not task.done():
        await asyncio.wait([task], timeout=_LOOK_SECONDS)
        if process_time() > deadline:
            task.cancel()
    return task.result()


@lru_cache(maxsize=32)
def _level(text: str) -> Level:
    return read_level(text, "level")


class _Answers(msgspec.Struct):
    """The answers to a question so far; rows and numbers as in `Series`."""

    columns: tuple[str, ...] = ()
    rows: list[tuple[Any, ...]] = []
    numbers: list[tuple[int, int | float | None]] = []
    failure: str = ""


class _RunMonitor:
    """Counts notices, asks questions, and detects when nothing can change any more.

    That is when world and memories are exactly as after the last tick that is a power of two
    (Brent's algorithm). Runs with questions, which may be about the clock, matches, and runs with
    noise or areas that the clock switches go on. A team loses a match after ten thoughts with too
    many steps, or if all its robots failed in every tick.
    """

    def __init__(self, runner: _TaskRunner) -> None:
        self._task = runner.task
        self._questions = questions = runner.questions
        self._level = level = runner.level
        tuned = runner.program.tuned.get("Robot")
        reads = {"clock"} if tuned is None else {*tuned.columns.get("Sensor", ())}
        is_timed = level.sensors.noise or any(area.cycle for area in level.areas)
        depends_on_tick = is_timed or not reads.isdisjoint({"clock", "sensor"})
        self._until = runner.until
        self._can_repeat = not (questions or self._until or level.teams or depends_on_tick)
        self._team_of = {robot.name: robot.team for robot in level.robots}
        self._robots = Counter(self._team_of.values())
        self._state: WorldState | None = None
        self._stored_frame: Frame | None = None
        self._next_stored_tick = 1
        self._slow: Counter[str] = Counter()  # by team: ticks with too many steps
        self._failed: Counter[str] = Counter()  # and ticks in which all robots failed
        self._cells = self.steps = 0
        self._areas: tuple[AreaState, ...] | None = None
        self._first_share = self._share = self._most_share = self._sum_of_shares = 0.0
        self._places = [(robot.x, robot.y, 0) for robot in level.robots]
        self._deadline = thread_time() + runner.task.seconds
        self._answers = {measure: _Answers() for measure in (*questions, _UNTIL)}
        self.outcome: Outcome | None = None
        self.notices: Counter[str] = Counter()
        self.first: tuple[int, str, str] | None = None

    def is_over(self, frame: Frame, mind: Mind) -> bool:
        """Record a tick; return whether the run ends with it. Takes a few microseconds.

        Raises Stopped if the run has taken more than its seconds.
        """
        self._state = frame.after
        if thread_time() > self._deadline and frame.after.won_at is None:
            raise Stopped
        if any(decision.notices for decision in frame.decisions):
            self._note(frame)
        if self._can_repeat:
            self._compare(frame)
        for number, robot in enumerate(frame.after.robots):
            x, y, _ = self._places[number]
            if robot.x != x or robot.y != y:
                self._places[number] = robot.x, robot.y, frame.tick
        if frame.after.areas != self._areas:
            self._note_home(frame.after)
        self._sum_of_shares += self._share
        self.steps += mind.steps
        if self.steps > self._task.run_steps > 0:
            self.outcome = self.outcome or "too slow"
        tick, has_won = frame.tick, frame.after.won_at is not None
        if self._until and not (self.outcome or has_won):
            table = self._answer(_UNTIL, self._until, frame, mind)
            if table and matching_rows(self._until, table).rows:
                self.outcome = "stopped"
        is_last = self.outcome or has_won or tick >= self._task.ticks
        for measure, question in self._questions.items():
            if is_last or (measure.every and (tick == 1 or tick % measure.every == 0)):
                self._ask(measure, question, frame, mind)
        return self.outcome is not None

    def series(self) -> dict[str, Series]:
        return {
            measure.name: Series(
                answers.columns or ("tick",),
                tuple(answers.rows),
                answers.failure,
                tuple(answers.numbers),
            )
            for measure, answers in self._answers.items()
            if measure in self._questions or answers.failure
        }

    def points(self) -> dict[str, float]:
        return {} if self._state is None else standing(self._level, self._state)

    def home(self) -> float:
        return float(self._has_won) or self._most_share

    def time_home(self) -> float:
        tick = self._state.tick if self._state is not None else 0
        last_share = float(self._has_won) or self._share * (self.outcome == "nothing changes")
        ticks = self._task.ticks
        return (self._sum_of_shares + (ticks - tick) * last_share) / max(ticks, 1)

    @property
    def _has_won(self) -> bool:
        return self._state is not None and self._state.won_at is not None

    def ends(self) -> tuple[End, ...]:
        pairs = zip(self._level.robots, self._places, strict=True)
        return tuple(End(bot.name, round(x, 1), round(y, 1), since) for bot, (x, y, since) in pairs)

    def forfeit(self) -> tuple[str, ...]:
        ticks = self._state.tick if self._state is not None else 0
        teams = [team.name for team in self._level.teams]
        return tuple(t for t in teams if self._slow[t] >= _SLOW_TICKS or self._failed[t] == ticks)

    def _note_home(self, state: WorldState) -> None:
        if self._areas is None:
            self._first_share = _share_home(self._level, state, is_open=True)
        self._areas = state.areas
        gain = max(0.0, _share_home(self._level, state) - self._first_share)
        self._share = gain and gain / (1 - self._first_share)
        self._most_share = max(self._most_share, self._share)

    def _note(self, frame: Frame) -> None:
        notices = [(d.robot_name, notice) for d in frame.decisions for notice in d.notices]
        self.notices.update({notice.kind for _, notice in notices})
        if self.first is None:
            self.first = (frame.tick, notices[0][0], notices[0][1].message)
        failed = {robot: notice.message for robot, notice in notices if notice.kind == "failed"}
        slow = {robot for robot, message in failed.items() if _TOO_MANY_STEPS.search(message)}
        self._slow.update({self._team_of[robot] for robot in slow})
        robots = Counter(self._team_of[robot] for robot in failed)
        self._failed.update(team for team, count in robots.items() if count == self._robots[team])
        if max(self._slow.values(), default=0) >= _SLOW_TICKS:
            self.outcome = "too many steps"

    def _compare(self, frame: Frame) -> None:
        """Compare a tick with the stored one; store it instead when due."""
        state, old_frame = frame.after, self._stored_frame
        if (
            old_frame is not None
            and state.robots[0].x == old_frame.after.robots[0].x  # most differ in that already
            and (state.robots, state.areas) == (old_frame.after.robots, old_frame.after.areas)
            and _exact_state(frame) == _exact_state(old_frame)
        ):
            self.outcome = self.outcome or "nothing changes"
        if state.tick >= self._next_stored_tick:
            self._next_stored_tick = 2 * state.tick
            self._stored_frame = frame

    def _answer(
        self, measure: QueryMeasure, question: CompiledQuery, frame: Frame, mind: Mind
    ) -> ResultTable | None:
        try:
            return mind.ask(question, frame.sensors, frame.memories_before)
        except QueryError as error:
            answers = self._answers[measure]
            answers.failure = answers.failure or f"tick {frame.tick}: {error}"
            return None

    def _ask(
        self, measure: QueryMeasure, question: CompiledQuery, frame: Frame, mind: Mind
    ) -> None:
        tick, table = frame.tick, self._answer(measure, question, frame, mind)
        answers = self._answers[measure]
        answers.numbers.append((tick, number_of(question, table) if table else None))
        if table is None:
            return
        columns, rows = table.columns, table.rows
        if table.viewers:
            columns = ("robot", *columns)
            rows = tuple((name, *row) for name, row in zip(table.viewers, rows, strict=True))
        answers.columns = answers.columns or ("tick", *columns)
        self._cells += len(rows) * (1 + len(columns))
        if table.truncated or self._cells > _MOST_CELLS:
            answers.failure = answers.failure or f"tick {tick}: there are too many rows to keep"
        if self._cells <= _MOST_CELLS:
            answers.rows += [(tick, *row) for row in rows]


_UNTIL = QueryMeasure("until", "", 0)


def _share_home(level: Level, state: WorldState, *, is_open: bool = False) -> float:
    """Return the share of its robots that are in the best goal, as `count_home` counts them."""
    counts = count_home(level, state, is_open=is_open)
    return max((inside / total for inside, total in counts if total), default=0.0)


def _exact_state(frame: Frame) -> str:
    """Return world and memories as text that distinguishes 1, 1.0 and true."""
    memories = [decision.memory for decision in frame.decisions]
    return repr((frame.after.robots, frame.after.areas, memories))


_TOO_MANY_STEPS = re.compile(r"thinking took more than [\d,]+ steps\.$")
