"""Measuring a winning program in a low-priority process."""

from __future__ import annotations

import asyncio
import json
import os
import pickle
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass

from logical_robots_tui.game.robustness import STARTS, LateError, play_through, try_starts
from logical_robots_tui.game.victory import measures_of
from logical_robots_tui.mind import Program
from logical_robots_tui.processes.helper import Helper, begin
from logical_robots_tui.progress import Measures
from logical_robots_tui.world import Level

MOST_TICKS = 20_000
"""Ticks within which every level can be won."""

PROCESSOR_SECONDS = 3600
"""The longest measuring."""

NICENESS = 10
"""How much other processes go before this one."""


class MeasuringError(Exception):
    """The process ended early, or the clock cut off a thought."""


@dataclass(frozen=True, slots=True)
class Trial:
    tried: int = 0
    wins: int = 0
    of_all: int = STARTS


def patience_for(ticks: int) -> int:
    """Return the tick limit for a shifted start, given the ticks of the original one."""
    return min(2 * ticks + 200, 2 * MOST_TICKS)


async def measure(
    level: Level,
    program: Program,
    known: Measures | None,
    report: Callable[[Trial], None] = lambda _trial: None,
) -> Measures | None:
    """Measure a program in a process; None if it does not win from the original start.

    `report` is called on the event loop after each start. Raises MeasuringError if the process
    ended early or the clock cut off a thought.
    """
    loop = asyncio.get_running_loop()
    work = _Work(pickle.dumps((level, program, known)))

    def pass_on(trial: Trial) -> None:
        if not work.is_over:
            loop.call_soon_threadsafe(report, trial)

    try:
        return await asyncio.to_thread(work.do, pass_on)
    finally:
        work.end()


class _Work:
    """A measuring process; one thread talks to it, any thread may end it."""

    def __init__(self, request: bytes) -> None:
        self._request = request
        self._guard = threading.Lock()
        self._process: Helper | None = None
        self.is_over = False

    def end(self) -> None:
        with self._guard:
            self.is_over = True
            if self._process is not None:
                self._process.kill()

    def do(self, report: Callable[[Trial], None]) -> Measures | None:
        """Run the process and return its result. Blocks."""
        with self._guard:
            if self.is_over:
                raise MeasuringError
            self._process = process = Helper(__name__)
        try:
            return self._results_of(process, report)
        except (OSError, ValueError) as error:
            raise MeasuringError from error
        finally:
            with self._guard:
                self._process = None
            process.end()

    def _results_of(self, process: Helper, report: Callable[[Trial], None]) -> Measures | None:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(len(self._request).to_bytes(8, "big") + self._request)
        process.stdin.flush()
        for line in process.stdout:
            answer = json.loads(line)
            if "tried" in answer:
                report(Trial(answer["tried"], answer["wins"]))
            elif answer["late"]:
                raise MeasuringError
            else:
                found = answer["measures"]
                return Measures(**found)._replace(goals=tuple(found["goals"])) if found else None
        raise MeasuringError


def main() -> None:
    begin(PROCESSOR_SECONDS)
    os.nice(NICENESS)
    size = int.from_bytes(sys.stdin.buffer.read(8), "big")
    level, program, known = pickle.loads(  # noqa: S301 - from the game that started this process
        sys.stdin.buffer.read(size)
    )
    try:
        found = _measure(level, program, known)
        _say(late=False, measures=found and found._asdict())
    except LateError:
        _say(late=True)


def _measure(level: Level, program: Program, known: Measures | None) -> Measures | None:
    if known is None:
        played = play_through(level, program, 2 * MOST_TICKS)
        if played.won_at is None:
            return None
        known = measures_of(level, program, played.won_at, played.distance, played.is_blocked)
    patience = patience_for(known.ticks)
    wins = try_starts(
        level, program, patience, report=lambda tried, won: _say(tried=tried, wins=won)
    )
    return known._replace(wins=wins, starts=STARTS)


def _say(**what: object) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()
