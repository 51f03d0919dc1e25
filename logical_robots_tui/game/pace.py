"""Pace: how fast a game is meant to run, and how fast it does."""

from __future__ import annotations

import asyncio
from collections import deque
from time import perf_counter

__all__ = ["FLAT_OUT", "SPEEDS", "Pace"]

FLAT_OUT: float | None = None
"""The speed "as fast as the machine can"."""

SPEEDS: tuple[float | None, ...] = (1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, FLAT_OUT)
"""Speeds to choose from in ticks per second, slow motion first."""

_WAY_SECONDS = 0.03  # that a key press gets for itself from a game that runs flat out

_LOT = 1 / 30  # seconds whose ticks are computed together on an idle machine
_LONGEST_LOT = 0.1  # and on any

_WINDOW = 1.0  # seconds over which the achieved speed is measured


class Pace:
    """Keeps `Game.run` at a wanted number of ticks per second and measures what is achieved.

    Attributes:
        spacing: Seconds to leave to others on a busy machine between two lots of ticks. First the
            lots grow with it; beyond a tenth of a second they don't, and the game is slower.
    """

    def __init__(self, speed: float | None = 40.0) -> None:
        self.spacing = 0.0
        self._speed = speed
        self._computed = 0  # ticks since the last waiting
        self._due = 0.0
        self._free_at = 0.0
        self._times: deque[float] = deque()
        self._changed = asyncio.Event()

    @property
    def speed(self) -> float | None:
        """Wanted ticks per second; None is flat out."""
        return self._speed

    @speed.setter
    def speed(self, speed: float | None) -> None:
        self._speed = speed
        self._begin()
        self.wake()

    @property
    def achieved(self) -> float:
        """Ticks per second over the last second, 0.0 when nothing ran."""
        self._forget_old(perf_counter())
        if len(self._times) < 2:
            return float(len(self._times))
        span = self._times[-1] - self._times[0]
        return (len(self._times) - 1) / span if span > 0 else 0.0

    @property
    def period(self) -> float:
        """Seconds from one tick to the next, with what is left to others; 0.0 flat out."""
        return 1 / self._speed + self.spacing if self._speed else 0.0

    @property
    def together(self) -> int | None:
        """How many ticks to compute at once, as one lot; None is as many as a moment allows."""
        if self._speed is None:
            return None
        return max(1, int(self._speed * min(self._lot, _LONGEST_LOT)))

    def faster(self) -> None:
        """Choose the next higher speed of `SPEEDS`."""
        self._move(1)

    def slower(self) -> None:
        """Choose the next lower speed of `SPEEDS`."""
        self._move(-1)

    def start(self) -> None:
        """A run begins."""
        self._begin()
        self._times.clear()

    def stop(self) -> None:
        """A run has ended."""
        self._times.clear()

    def count(self) -> None:
        """A tick was finished."""
        now = perf_counter()
        self._computed += 1
        self._times.append(now)
        self._forget_old(now)

    def give_way(self) -> None:
        """Let a game that runs flat out, or on a busy machine, pause for a moment.

        The player is to be answered, and threads that want the interpreter at the same time
        take turns; on a busy machine each turn takes as long as all who are before it.
        """
        self._free_at = perf_counter() + _WAY_SECONDS + self.spacing

    def wake(self) -> None:
        """End the waiting under way."""
        self._changed.set()

    async def wait(self) -> None:
        """Wait until the next ticks are due. A game that is too slow does not try to catch up."""
        if self._speed is None:
            await asyncio.sleep(max(self._free_at - perf_counter(), 0))
            return
        now = perf_counter()
        rest = self._lot if self._lot > _LONGEST_LOT else 0.0
        self._due = max(self._due + max(self._computed / self._speed, rest), now)
        if self.spacing:
            self._due = max(self._due, self._free_at)
        self._computed = 0
        self._changed.clear()
        try:
            async with asyncio.timeout(self._due - now):
                await self._changed.wait()
        except TimeoutError:
            pass

    def _begin(self) -> None:
        self._due, self._computed = perf_counter(), 0

    @property
    def _lot(self) -> float:
        return _LOT + self.spacing

    def _move(self, steps: int) -> None:
        at = SPEEDS.index(self._speed) if self._speed in SPEEDS else 0
        self.speed = SPEEDS[max(0, min(at + steps, len(SPEEDS) - 1))]

    def _forget_old(self, now: float) -> None:
        while self._times and self._times[0] < now - _WINDOW:
            self._times.popleft()
