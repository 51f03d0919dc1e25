"""Bounds on playing again what somebody else's file claims: progress and replays."""

from __future__ import annotations

import asyncio
import resource
from collections.abc import Coroutine
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING, Any, TypeVar

from logical_robots_tui.errors import InputError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.wording import count_of

if TYPE_CHECKING:
    from logical_robots_tui.mind import Program
    from logical_robots_tui.mind.program import Texts

MOST_PROGRAMS = 1_000
"""The most programs of a file that are compiled again."""

MOST_ROBOT_TICKS = 10_000_000
"""The most decisions of a replay that are computed again: its ticks times its robots."""

SECONDS = 1_800
"""Processor seconds for a whole file, unless the player allows others."""

_SHARES = 3  # of that which a victory in a progress file may take, since there may be many

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


class OverBudgetError(InputError):
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


def _processor_seconds() -> float:
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
