"""Asking probes at the ticks of a run, in a thread or in a process of its own."""

from __future__ import annotations

import asyncio
import json
import os
import pickle
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from logical_robots_tui.game.advancing import RecordedTick
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.processes.helper import Helper, begin

if TYPE_CHECKING:
    from logical_robots_tui.explain.diagnosis.counting import Rows
    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind import Limits, Program
    from logical_robots_tui.world import Level

PROCESSOR_SECONDS = 3600
"""The longest scan."""

_ROWS = 60  # of sensors, that are examined with one query

Tick: TypeAlias = "tuple[TickState, RecordedTick]"
"""The moment before a tick, and the tick."""


class Answer(NamedTuple):
    """The rows of a probe at a tick, in each view; None if it failed."""

    tick: int
    probe: str
    views: Sequence[Rows] | None


def ticks_at_once(robots: int) -> int:
    """Return how many ticks are examined with one query."""
    return max(1, _ROWS // max(1, robots))


def scan(
    thinker: Thinker,
    program: Program,
    limits: Limits,
    probes: Sequence[str],
    ticks: Sequence[Tick],
    stop: threading.Event | None = None,
) -> Iterator[Answer]:
    """Yield what probes answer at some ticks; call it in the thinker's thread."""
    for _, alike in groupby(ticks, key=lambda each: id(each[1].level)):
        same = list(alike)
        most = ticks_at_once(len(same[0][1].level.robots))
        for at in range(0, len(same), most):
            replayed = [thinker.replay(program, *each, limits) for each in same[at : at + most]]
            frames = [frame for frame, _ in replayed]
            seen = [(frame.sensors, frame.memories_before) for frame in frames]
            for name, number, views in replayed[-1][1].each_at(probes, seen, stop=stop):
                yield Answer(frames[number].tick, name, views)


class Scanner:
    """A process that scans ticks of a level; a failure leaves them to others."""

    def __init__(self, program: Program, level: Level, limits: Limits) -> None:
        self._start = pickle.dumps((program, level, limits))
        self._process: Helper | None = None
        self._guard = threading.Lock()
        self.is_over = False

    async def scan(self, probes: Sequence[str], ticks: Sequence[Tick]) -> list[Answer] | None:
        """Return what probes answer at some ticks of the level, or None if the process failed."""
        request = pickle.dumps((probes, [(before, known.moment) for before, known in ticks]))
        return await asyncio.to_thread(self._exchange, request)

    def close(self) -> None:
        with self._guard:
            self.is_over = True
            if self._process is not None:
                self._process.end()

    def _exchange(self, request: bytes) -> list[Answer] | None:
        try:
            process = self._started()
            if process is None:
                return None
            assert process.stdin is not None
            assert process.stdout is not None
            _write(process.stdin.fileno(), request)
            return [Answer(*each) for each in json.loads(process.stdout.readline())]
        except (OSError, ValueError, TypeError):
            self.is_over = True
            return None

    def _started(self) -> Helper | None:
        with self._guard:
            if self.is_over:
                return None
            if self._process is None:
                self._process = Helper(__name__)
                assert self._process.stdin is not None
                _write(self._process.stdin.fileno(), self._start)
            return self._process


def _write(pipe: int, content: bytes) -> None:
    left = memoryview(len(content).to_bytes(8, "big") + content)
    while left:
        left = left[os.write(pipe, left) :]


def main() -> None:
    begin(PROCESSOR_SECONDS)
    program, level, limits = _read()
    thinker = Thinker("scan")
    with suppress(EOFError):
        while True:
            probes, moments = _read()
            ticks = [(before, RecordedTick(level, moment)) for before, moment in moments]
            answers = scan(thinker, program, limits, probes, ticks)
            sys.stdout.write(json.dumps([*answers]) + "\n")
            sys.stdout.flush()


def _read() -> Any:
    size = int.from_bytes(sys.stdin.buffer.read(8), "big")
    if not size:
        raise EOFError
    return pickle.loads(sys.stdin.buffer.read(size))  # noqa: S301 - from the command that started this
