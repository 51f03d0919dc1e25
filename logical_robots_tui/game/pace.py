"""Pace: the target speed of a game, and the speed it achieves."""

from __future__ import annotations

import asyncio
from collections import deque

from logical_robots_tui.clock import CLOCK, Clock

FLAT_OUT: float | None = None
"""The speed "as fast as possible"."""

SPEEDS: tuple[float | None, ...] = (1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, FLAT_OUT)
"""Available speeds in ticks per second, slowest first."""

_WAY_SECONDS = 0.03  # that a game at full speed pauses after a key press

_LOT = 1 / 30  # seconds of ticks that are computed in one batch on an idle machine
_LONGEST_LOT = 0.1  # and at most

_WINDOW = 1.0  # seconds over which the achieved speed is measured


class Pace:
    """Keeps `Game.run` at a target number of ticks per second and measures the actual one.

    `spacing` is the seconds to leave to others between two batches of ticks. Batches grow with
    it up to a tenth of a second; beyond that the game gets slower.
    """

    def __init__(self, speed: float | None = 40.0, clock: Clock = CLOCK) -> None:
        self._clock = clock
        self.spacing = 0.0
        self._speed = speed
        self._computed = 0  # ticks since the last wait
        self._due = 0.0
        self._free_at = 0.0
        self._times: deque[float] = deque()
        self._changed = asyncio.Event()

    @property
    def speed(self) -> float | None:
        """Target ticks per second; None means full speed."""
        return self._speed

    @speed.setter
    def speed(self, speed: float | None) -> None:
        self._speed = speed
        self._begin()
        self.wake()

    @property
    def achieved(self) -> float:
        """Ticks per second over the last second, 0.0 when nothing ran."""
        self._forget_old(self._clock.now())
        if len(self._times) < 2:
            return float(len(self._times))
        span = self._times[-1] - self._times[0]
        return (len(self._times) - 1) / span if span > 0 else 0.0

    @property
    def period(self) -> float:
        """Seconds from tick to tick, including idle time; 0.0 at full speed."""
        return 1 / self._speed + self.spacing if self._speed else 0.0

    @property
    def batch_size(self) -> int | None:
        """The number of ticks per batch; None means as many as time allows."""
        if self._speed is None:
            return None
        return max(1, int(self._speed * min(self._lot, _LONGEST_LOT)))

    def shift(self, steps: int) -> None:
        """Choose a faster speed, or with negative steps a slower one."""
        index = SPEEDS.index(self._speed) if self._speed in SPEEDS else 0
        self.speed = SPEEDS[max(0, min(index + steps, len(SPEEDS) - 1))]

    def start(self) -> None:
        self._begin()
        self._times.clear()

    def stop(self) -> None:
        self._times.clear()

    def count(self) -> None:
        time = self._clock.now()
        self._computed += 1
        self._times.append(time)
        self._forget_old(time)

    def give_way(self) -> None:
        """Pause briefly at full speed or on a busy computer, so that other threads get a turn."""
        self._free_at = self._clock.now() + _WAY_SECONDS + self.spacing

    def wake(self) -> None:
        self._changed.set()

    async def wait(self) -> None:
        """Wait until the next ticks are due; a game that is too slow doesn't catch up."""
        if self._speed is None:
            await asyncio.sleep(max(self._free_at - self._clock.now(), 0))
            return
        time = self._clock.now()
        pause = self._lot if self._lot > _LONGEST_LOT else 0.0
        self._due = max(self._due + max(self._computed / self._speed, pause), time)
        if self.spacing:
            self._due = max(self._due, self._free_at)
        self._computed = 0
        self._changed.clear()
        try:
            async with asyncio.timeout(self._due - time):
                await self._changed.wait()
        except TimeoutError:
            pass

    def _begin(self) -> None:
        self._due, self._computed = self._clock.now(), 0

    @property
    def _lot(self) -> float:
        return _LOT + self.spacing

    def _forget_old(self, time: float) -> None:
        while self._times and self._times[0] < time - _WINDOW:
            self._times.popleft()
