"""Playing again, within bounds, what others claim: progress, replays and the board."""

from __future__ import annotations

import asyncio
import math
import resource
from collections.abc import Callable, Coroutine, Iterator
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from logical_robots_tui.errors import InputError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.game.measuring import Trial
    from logical_robots_tui.mind import Program
    from logical_robots_tui.mind.program import Texts
    from logical_robots_tui.progress import Measures
    from logical_robots_tui.world import Level

MOST_PROGRAMS = 1_000
"""The most programs of a file that are compiled again."""

MOST_ROBOT_TICKS = 10_000_000
"""The most decisions of a replay that are computed again: its ticks times its robots."""

SECONDS = 1_800
"""Processor seconds for a whole file, unless the player allows others."""

_SHARES = 3  # of that which a victory in a progress file may take, since there may be many

_SHARE_OF_GIVEN_UP = 0.9  # of the time that playing may take: the system counts it coarsely

_LOOK_EVERY = 0.2  # seconds

T = TypeVar("T")


def check_size(programs: int, robot_ticks: int = 0) -> None:
    """Raise InputError for a file that is too large to be played again."""
    for number, limit, noun in (
        (programs, MOST_PROGRAMS, "programs"),
        (robot_ticks, MOST_ROBOT_TICKS, "decisions of robots"),
    ):
        if number > limit:
            raise InputError(f"It has {number:,} {noun}; at most {limit:,} are played again")


class UndecidedError(InputError):
    """A claim was neither confirmed nor refuted."""


class OverBudgetError(UndecidedError):
    def __init__(self, seconds: int) -> None:
        message = f"given up after {count_of(seconds, 'processor second')}"
        super().__init__(message, hint="--seconds N allows more.")


class FileBudget:
    """The processor time for a file, including processes that have ended."""

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        self._end = _processor_seconds() + seconds

    @property
    def remaining(self) -> float:
        return self._end - _processor_seconds()

    @property
    def entry_seconds(self) -> int:
        """The whole processor seconds that one of many victories may take, at least 1."""
        return max(1, int(min(self.remaining, self.seconds / _SHARES)))

    async def compile(self, texts: str | Texts) -> Program:
        """Compile at the expense of the budget; raise ProgramError, OverBudgetError."""
        from logical_robots_tui.game.source import compile_program

        start_time = monotonic()
        try:
            return await self.bound(compile_program(texts))
        finally:
            # The compile process lives on, so what it computed is known by an upper bound only.
            self._end -= min(monotonic() - start_time, Limits().compile_seconds)

    async def bound(self, work: Coroutine[Any, Any, T]) -> T:
        """Await work, or cancel it and raise OverBudgetError when no time is left."""
        task = asyncio.ensure_future(work)
        try:
            while not task.done():
                if self.remaining <= 0:
                    raise OverBudgetError(self.seconds)
                await asyncio.wait([task], timeout=_LOOK_EVERY)
            return task.result()
        finally:
            task.cancel()
            with suppress(BaseException):
                await task


def load_public_level(name: str) -> Level:
    """Return a level that everybody has, a shipped one or a labyrinth of a day, or InputError."""
    from logical_robots_tui import world
    from logical_robots_tui.world.levels.labyrinths import Daily

    if world.current_name(name) not in world.list_levels() and Daily.parse(name) is None:
        raise InputError("is neither a shipped level nor a labyrinth of the day", place=name)
    return world.load_level(name)


async def play_again(
    level: Level,
    text: str,
    budget: FileBudget,
    report: Callable[[Trial], None] = lambda _trial: None,
    *,
    has_starts: bool = True,
) -> Measures | str:
    """Return a program's measures, or why it does not win; raise UndecidedError.

    Without `has_starts` the varied starts are not tried.
    """
    from logical_robots_tui.game.measuring import MeasuringError, measure
    from logical_robots_tui.game.victory import is_reference
    from logical_robots_tui.mind import ProgramError

    if is_reference(level, text):
        return "this is a reference program"
    try:
        program = await budget.compile(text)
        seconds_left, limit = budget.remaining, budget.entry_seconds
        measures = await measure(level, program, None, report, limit, has_starts=has_starts)
    except ProgramError as error:
        return f"line {error.first.line}: {error.first.message}"
    except MeasuringError:
        if seconds_left - budget.remaining > _SHARE_OF_GIVEN_UP * limit:
            raise OverBudgetError(limit) from None
        raise UndecidedError("it could not be played to the end; try again") from None
    return measures or "the program does not win"


def differences(claim: Measures, measures: Measures) -> Iterator[str]:
    for name in ("ticks", "size", "distance"):
        expected, actual = getattr(claim, name), getattr(measures, name)
        if not math.isclose(expected, actual, rel_tol=1e-6):
            yield f"{name}: {expected:,.10g} claimed, {actual:,.10g} found"
    if claim.wins is not None and claim[3:5] != measures[3:5]:
        yield f"robust: {claim.wins} of {claim.starts} claimed, {measures.wins} found"
    for goal in claim.goals:
        if goal not in measures.goals:
            yield f'"{goal}" claimed, not reached'


def _processor_seconds() -> float:
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
