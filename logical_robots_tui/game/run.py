"""A run: any tick of a level under a program, computed once and cached on disk."""

from __future__ import annotations

import hashlib
import json
import platform
import sqlite3
import threading
from collections.abc import AsyncGenerator, Awaitable, Callable
from dataclasses import asdict
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from logical_robots_tui.caching import digest_of_code
from logical_robots_tui.clock import CLOCK
from logical_robots_tui.game.advancing import (
    RecordedTick,
    Thinker,
    Worlds,
    frame_of,
    play_tick,
    start_frame,
)
from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.history.packing import Moment
from logical_robots_tui.game.history.recording import DamagedRunError, Recording
from logical_robots_tui.mind import Limits
from logical_robots_tui.world import Level
from logical_robots_tui.world.level import FLAGS

if TYPE_CHECKING:
    from logical_robots_tui.mind import Mind, Program
    from logical_robots_tui.values import Value

T = TypeVar("T")

_CODE = Path(__file__).parents[1]
_SECONDS = 0.05  # of work in the thread at a time


class Run:
    """The ticks of a level under a program from its start; a victory does not end the run.

    Ticks computed earlier are not computed again; only the sensors are. `close` writes the
    computed ticks to disk. `key` is a digest of everything on which they depend.
    Computed ticks can be read in any thread, as those of a `History`.
    """

    turns = 0  # it has no other branch

    def __init__(self, level: Level, program: Program, *, limits: Limits | None = None) -> None:
        self.level = level
        self.program = program
        self.limits = limits or Limits()
        self.thinker = Thinker("run")
        self._worlds = Worlds(level)
        self._latest: Frame = start_frame(level, self._worlds.world_for(level))
        self._start = Moment(self._latest.after, self._latest.memories, (), 0.0, 0.0)
        self._moment = self._start  # the last one that was read
        self.key = run_key(level, program, self.limits)
        self._recording = Recording(self.key, level, self._start)
        self._guard = threading.Lock()  # of the recording, which is read in any thread

    @property
    def last(self) -> int:
        return self._recording.last

    async def frame(self, tick: int, report: Callable[[int], object] = lambda _tick: None) -> Frame:
        """Return the frame of a tick; `report` gets the last computed tick as work proceeds."""
        frame: Frame | None = None
        while frame is None:
            last, deadline = self.last, CLOCK.now() + _SECONDS
            frame = await self.thinker.do(partial(self._computed_frame, tick, deadline=deadline))
            if self.last != last:
                report(self.last)
        return frame

    async def to_end(self, last: int, report: Callable[[int], object] = lambda _tick: None) -> int:
        """Compute up to a victory, the end of a match, or `last`, and return that tick.

        `report` gets the last computed tick as work proceeds.
        """
        tick, over = 0, False
        while not over:
            tick, over = await self.thinker.do(partial(self._compute_to_end, last))
            report(tick)
        return tick

    async def repeat_if_damaged(self, work: Callable[[], Awaitable[T]]) -> T:
        """Return the result of work, done again without the stored ticks if they are damaged."""
        try:
            return await work()
        except DamagedRunError:
            await self.thinker.do(lambda _stop: self._forget())
            return await work()

    def first_before(self, last: int) -> int:
        """Return the first tick from which on all up to this one can be restored."""
        return self._recording.first_before(last)

    def moment(self, tick: int) -> Moment:
        """Return the state after a computed tick; raises NoSuchTickError or DamagedRunError."""
        with self._guard:
            if self._moment.after.tick != tick:
                self._moment = self._recording.moment(tick)
            return self._moment

    def memory(self, tick: int, robot: str) -> Value:
        """Return a robot's memory after a computed tick, with the errors of `moment`."""
        with self._guard:
            return self._recording.memory(tick, robot)

    def recorded(self, tick: int) -> RecordedTick:
        return RecordedTick(self.level, self.moment(max(tick - 1, 0)), self.moment(tick))

    def level_at(self, _tick: int) -> Level:
        return self.level

    def program_at(self, _tick: int) -> Program:
        return self.program

    def is_reliable_up_to(self, tick: int) -> bool:
        """Return whether no time limit cut off a thought up to this tick."""
        return self._recording.last_reliable >= tick

    async def map_ticks(
        self,
        first: int,
        last: int,
        work: Callable[[Frame, Mind, threading.Event], T],
        *,
        to_victory: bool = False,
    ) -> AsyncGenerator[T]:
        """Yield the result of `work`, called in a thread, for each tick, or raise Stopped."""
        tick, over = first, False
        while tick <= last and not over:
            batch = partial(self._map_batch, tick, last, work, to_victory)
            results, over = await self.thinker.do(batch)
            for result in results:
                yield result
            tick += len(results)

    async def close(self) -> None:
        """Save the computed ticks, and free the mind."""
        try:
            await self.thinker.do(lambda _stop: self._recording.save())
        finally:
            await self.thinker.close()

    # The rest is called in the thread.

    def _map_batch(
        self,
        tick: int,
        last: int,
        work: Callable[[Frame, Mind, threading.Event], T],
        to_victory: bool,
        stop: threading.Event,
    ) -> tuple[list[T], bool]:
        deadline = CLOCK.now() + _SECONDS
        results: list[T] = []
        over = False
        while not over and tick + len(results) <= last and (not results or CLOCK.now() < deadline):
            frame = self._computed_frame(tick + len(results), stop, deadline=deadline)
            if frame is None:
                break
            mind = self.thinker.mind(self.program, self.level, self.limits)
            results.append(work(frame, mind, stop))
            over = to_victory and frame.after.won_at is not None
        return results, over

    def _compute_to_end(self, last: int, stop: threading.Event) -> tuple[int, bool]:
        """Return the tick reached after a while, and whether the run ends there."""
        deadline = CLOCK.now() + _SECONDS
        try:
            self._compute(min(self.last, last), stop, deadline)  # if it was dropped
            while True:
                tick = min(self._recording.last, last)
                ends = (self.moment(tick).after.won_at, self.level.match_ticks, last)
                end = min(filter(None, ends))
                if end <= tick or CLOCK.now() >= deadline:
                    return min(tick, end), end <= tick
                self._compute(tick + 1, stop, deadline)
        except DamagedRunError:
            self._forget()
            return 0, False

    def _computed_frame(self, tick: int, stop: threading.Event, *, deadline: float) -> Frame | None:
        try:
            return self._stored_frame(tick) if self._compute(tick, stop, deadline) else None
        except DamagedRunError:
            self._forget()
            return None

    def _compute(self, tick: int, stop: threading.Event, deadline: float) -> bool:
        """Compute ticks up to one, unless that takes too long; return whether it is there."""
        if any(self._recording.is_in_gap(t) for t in (max(tick - 1, 0), tick)):
            with self._guard:
                self._recording.return_to_gap()
        while self._recording.last < tick and CLOCK.now() < deadline:
            old = self._stored_frame(self._recording.last)
            mind = self.thinker.mind(self.program, self.level, self.limits)
            world = self._worlds.world_for(self.level)
            world.restore(old.after)
            frame = self._latest = play_tick(world, mind, old, stop)
            distance = self.moment(old.tick).driven + frame.distance
            with self._guard:
                self._recording.add(Moment.from_frame(frame, distance))
        return tick <= self._recording.last

    def _forget(self) -> None:
        with self._guard:
            self._recording.forget()
            self._moment = self._start
        self._latest = start_frame(self.level)

    def _stored_frame(self, tick: int) -> Frame:
        if self._latest.tick != tick:
            self._latest = frame_of(self._worlds, self.recorded(tick))
        return self._latest


def run_key(level: Level, program: Program, limits: Limits) -> str:
    """Return the digest of everything on which the ticks of a run depend, including the code."""
    parts = [level_digest(level), program.texts, asdict(limits)]
    digest = hashlib.sha256(simulation_digest())
    digest.update(json.dumps(parts).encode())
    return digest.hexdigest()


def level_digest(level: Level) -> str:
    """Return the digest of everything in a level on which its ticks depend."""
    parts = {
        "size": (level.width, level.height),
        "walls": hashlib.sha256(level.walls.tobytes()).hexdigest(),
        "visibility": asdict(level.visibility),
        "sensors": asdict(level.sensors),
        "match_ticks": level.match_ticks,
        **{key: getattr(level, key) for key in FLAGS},
    }
    for kind in ("robots", "beacons", "areas", "teams", "scores"):
        parts[kind] = [asdict(entity) for entity in getattr(level, kind)]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


SIMULATION = (
    *("world", "language", "mind", "schema.py", "values.py", "game/advancing.py", "game/frame.py"),
    *("game/minds.py", "game/run.py", "game/history"),
)
"""Parts of the package on whose code a tick depends; nothing that only shows or explains it."""


@cache
def simulation_digest() -> bytes:
    code = digest_of_code([_CODE / part for part in SIMULATION], ("logica", "numpy", "sqlglot"))
    return code + f"{sqlite3.sqlite_version} {platform.python_version()}".encode()
