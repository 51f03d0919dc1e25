"""A thread with a mind, for work off the event loop."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

from logical_robots_tui.game.advancing import RecordedTick, Worlds, frame_of
from logical_robots_tui.game.frame import Frame
from logical_robots_tui.mind import Stopped
from logical_robots_tui.world import Level

if TYPE_CHECKING:
    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind import Limits, Mind, Program

T = TypeVar("T")


class Thinker:
    """One thread with one mind at a time; its work can be stopped."""

    def __init__(self, name: str) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix=f"logical-robots-{name}")
        self._stop = threading.Event()
        self._mind: Mind | None = None
        self._serves: tuple[object, ...] = ()
        self._worlds: Worlds | None = None

    def mind(self, program: Program, level: Level, limits: Limits) -> Mind:
        """Return the mind for a program in a level; call it in the thread."""
        teams = {robot.name: robot.team for robot in level.robots} if level.teams else {}
        serves = (program, level.visibility, teams)
        if self._mind is None or serves != self._serves:
            from logical_robots_tui.game.minds import mind_for

            self._forget()
            self._serves = serves
            self._mind = mind_for(program, level, limits)
        return self._mind

    def replay(
        self, program: Program, before: TickState, known: RecordedTick, limits: Limits
    ) -> tuple[Frame, Mind]:
        if self._worlds is None:
            self._worlds = Worlds(known.level)
        frame = frame_of(self._worlds, before, known)
        return frame, self.mind(program, known.level, limits)

    async def do(self, work: Callable[[threading.Event], T]) -> T:
        """Run work in the thread, passing it the event that asks it to stop."""
        stop = self._stop = threading.Event()

        def unless_stopped() -> T:
            if stop.is_set():
                raise Stopped
            return work(stop)

        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, unless_stopped)
        except asyncio.CancelledError:
            stop.set()
            raise

    def stop(self) -> None:
        self._stop.set()

    async def close(self) -> None:
        self._stop.set()
        await asyncio.get_running_loop().run_in_executor(self._pool, self._forget)
        self._pool.shutdown(wait=False)

    def _forget(self) -> None:
        if self._mind is not None:
            self._mind.close()
            self._mind = None
