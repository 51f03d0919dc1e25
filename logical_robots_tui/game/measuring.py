"""Measuring a program that has won, in a process of its own that yields to everything else."""

from __future__ import annotations

import asyncio
import json
import os
import pickle
import subprocess
import sys
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from logical_robots_tui.game.robustness import STARTS, LateError, play_through, try_starts
from logical_robots_tui.game.rules import count_rules
from logical_robots_tui.progress import Measures

if TYPE_CHECKING:
    from collections.abc import Callable

    from logical_robots_tui.mind import Program
    from logical_robots_tui.world import Level

__all__ = ["MOST_TICKS", "MeasuringError", "Trial", "measure", "patience_for"]

MOST_TICKS = 20_000
"""Ticks within which every level can be won."""

_NICENESS = 10


class MeasuringError(Exception):
    """The process ended before it was done, or a clock ended a thought."""


@dataclass(frozen=True, slots=True)
class Trial:
    """How far measuring is.

    Attributes:
        tried: From how many shifted starts the program was tried.
        wins: From how many of them it won.
        of_all: How many there are to try.
    """

    tried: int = 0
    wins: int = 0
    of_all: int = STARTS


def patience_for(ticks: int) -> int:
    """After how many ticks a shifted start is lost, if the given one takes so many."""
    return min(2 * ticks + 200, 2 * MOST_TICKS)


async def measure(
    level: Level,
    program: Program,
    known: Measures | None,
    report: Callable[[Trial], None] = lambda _trial: None,
) -> Measures | None:
    """Measure a program; cancelling the call ends the process at once.

    Args:
        level: Where it has won.
        program: What has won.
        known: Its measures from the given start, or None to play that too.
        report: Called on the event loop after each start.

    Returns:
        All measures; None if it does not win from the given start.

    Raises:
        MeasuringError: The process came to an early end, or a clock ended a thought in it.
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
    """A process and what it says; talked to in a thread, ended from any other.

    Args:
        request: What it is to do.

    Attributes:
        is_over: Whether nobody waits for it any more.
    """

    def __init__(self, request: bytes) -> None:
        self._request = request
        self._guard = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self.is_over = False

    def end(self) -> None:
        """End the process, or see to it that it does not begin."""
        with self._guard:
            self.is_over = True
            if self._process is not None:
                self._process.kill()

    def do(self, report: Callable[[Trial], None]) -> Measures | None:
        """Have it done. Blocks."""
        with self._guard:
            if self.is_over:
                raise MeasuringError
            self._process = process = self._begin()
        with process:
            try:
                return self._hear(process, report)
            except (OSError, ValueError) as error:
                raise MeasuringError from error
            finally:
                process.kill()

    def _begin(self) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-P", "-m", "logical_robots_tui.game.measuring"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": _path()},
            start_new_session=True,  # an interrupt from the keyboard is for the game alone
        )

    def _hear(
        self, process: subprocess.Popen[bytes], report: Callable[[Trial], None]
    ) -> Measures | None:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(len(self._request).to_bytes(8, "big") + self._request)
        process.stdin.flush()
        for line in process.stdout:
            told = json.loads(line)
            if "tried" in told:
                report(Trial(told["tried"], told["wins"]))
            elif told["late"]:
                raise MeasuringError
            else:
                return Measures(**told["measures"]) if told["measures"] else None
        raise MeasuringError


def _path() -> str:
    """Where the process finds this package, and what it needs."""
    home = str(Path(__file__).resolve().parents[2])
    return os.pathsep.join(dict.fromkeys([home, *(p for p in sys.path if p)]))


def main() -> None:
    """Measure what standard input says; end when it is closed, even in the middle."""
    os.nice(_NICENESS)
    size = int.from_bytes(sys.stdin.buffer.read(8), "big")
    level, program, known = pickle.loads(  # noqa: S301 - from the game that started this process
        sys.stdin.buffer.read(size)
    )
    threading.Thread(target=_end_with_the_game, daemon=True).start()
    try:
        _say(late=False, measures=_as_record(_measured(level, program, known)))
    except LateError:
        _say(late=True)


def _measured(level: Level, program: Program, known: Measures | None) -> Measures | None:
    if known is None:
        played = play_through(level, program, 2 * MOST_TICKS)
        if played.won_at is None:
            return None
        known = Measures(played.won_at, count_rules(program.text), played.distance)
    patience = patience_for(known.ticks)
    wins = try_starts(
        level, program, patience, report=lambda tried, won: _say(tried=tried, wins=won)
    )
    return Measures(known.ticks, known.rules, known.distance, wins, STARTS)


def _as_record(found: Measures | None) -> dict[str, object] | None:
    if found is None:
        return None
    return {name: getattr(found, name) for name in found.__slots__}


def _say(**what: object) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


def _end_with_the_game() -> None:
    sys.stdin.buffer.read()
    os._exit(0)


if __name__ == "__main__":
    main()
