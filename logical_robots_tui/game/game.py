"""The game: a world and a mind in step, with a history."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.history import History
from logical_robots_tui.game.pace import FLAT_OUT, Pace
from logical_robots_tui.game.start import start_frame
from logical_robots_tui.game.thinker import Thinker, next_frame
from logical_robots_tui.mind import Limits, Stopped
from logical_robots_tui.world import World

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.mind import Engine, Program, Table
    from logical_robots_tui.world import Level

__all__ = ["Answer", "Game", "Superseded"]

Listener: TypeAlias = Callable[[Frame], None]
_TOGETHER_SECONDS = 0.008  # of computing, before what was computed is shown


class Superseded(Exception):  # noqa: N818 - not an error: the player did something else meanwhile
    """The work belonged to a run that is over; its result was dropped."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Rows of a predicate at one tick.

    Attributes:
        run: Number of the run it belongs to; stale when ``game.run_number`` has moved on.
        tick: The tick it speaks of.
        predicate: Name of the predicate.
        table: Its columns and rows.
    """

    run: int
    tick: int
    predicate: str
    table: Table


class Game:
    """World, mind and history of one level under one program.

    Ticks are computed off the event loop. Same level, same program: same frames.
    Going back, restarting or changing the program while a tick is being computed drops that tick.

    Args:
        level: Where it happens.
        program: What the robots think.
        limits: Bounds on thinking.
        history: How many ticks can be gone back.
        engine: What robots think with, as `Mind` has it.
    """

    def __init__(
        self,
        level: Level,
        program: Program,
        *,
        limits: Limits | None = None,
        history: int | None = None,
        engine: Engine = "sqlite",
    ) -> None:
        self.level = level
        self.program = program
        self.limits = limits or Limits()
        self.run_number = 0
        self.pace = Pace()
        self.history = History() if history is None else History(history)
        self._listeners: list[Listener] = []
        self._thinker = Thinker("think", engine)
        self._asker = Thinker("ask")
        self._running = False
        self._closed = False
        # The worker's world computes ticks; the other one re-senses past ones on the event loop.
        self._world = World(level)
        self._past_world = World(level)
        self._frame = start_frame(self.level)
        self.history.add(self._frame)

    # -- looking -------------------------------------------------------------------------------

    @property
    def frame(self) -> Frame:
        """The frame on which the game stands."""
        return self._frame

    @property
    def running(self) -> bool:
        """Whether `run` is under way."""
        return self._running

    @property
    def won_at(self) -> int | None:
        """The tick of victory as of the present frame, or None."""
        return self._frame.after.won_at

    def listen(self, listener: Listener) -> None:
        """Call `listener` with each new present frame, on the event loop's thread."""
        self._listeners.append(listener)

    def frame_at(self, tick: int) -> Frame:
        """The frame of a past tick, exactly as it was.

        Raises:
            NoSuchTickError: History does not reach that far.
        """
        if tick == self._frame.tick:
            return self._frame
        before, moment = self.history.around(tick)
        if tick == 0:
            return start_frame(self.level)
        self._past_world.restore(before.after)
        return Frame(
            tick=tick,
            before=before.after,
            after=moment.after,
            sensors=tuple(self._past_world.sense()),
            memories_before=before.memories,
            decisions=moment.decisions,
            memories=moment.memories,
            think_milliseconds=moment.think_milliseconds,
        )

    async def query(self, predicate: str, frame: Frame | None = None) -> Answer:
        """Rows of a predicate of the program at a frame, by default the present one.

        Raises:
            Superseded: The program changed, or a newer query came, before the answer was there.
            QueryError: The predicate has no rows of its own, or failed.
        """
        frame = frame or self._frame
        run, program = self.run_number, self.program
        self._asker.stop()

        def ask(stop: threading.Event) -> Table:
            mind = self._asker.mind(program, self.level, self.limits)
            return mind.query(predicate, frame.sensors, frame.memories_before, stop=stop)

        table = await self._asker.do(ask)
        if program is not self.program:
            raise Superseded
        return Answer(run, frame.tick, predicate, table)

    # -- moving --------------------------------------------------------------------------------

    async def step(self) -> Frame:
        """Compute the next tick and make it the present.

        Cancelling the call stops the thinking and leaves the game where it was.

        Raises:
            Superseded: The game was restarted, gone back or reprogrammed meanwhile.
        """
        run = self.run_number
        (frame,) = await self._compute(1)
        self._take(frame, run)
        return frame

    def back(self) -> Frame:
        """Return to the tick before; at the earliest tick in history stay there."""
        return self.go_to(max(self._frame.tick - 1, self.history.first))

    def go_to(self, tick: int) -> Frame:
        """Return to a tick of history. The game goes on from there.

        Raises:
            NoSuchTickError: History does not hold it.
        """
        frame = self.frame_at(tick)
        if frame is not self._frame:
            self._supersede()
            self._show(frame)
        return frame

    def restart(self) -> Frame:
        """Begin again at the start of the level, with the same program."""
        self._supersede()
        frame = start_frame(self.level)
        self.history.add(frame)
        self._show(frame)
        return frame

    def use(self, program: Program) -> None:
        """Think with another program from the next tick on; world and memories stay."""
        self._supersede()
        self.program = program

    async def run(self) -> None:
        """Step at the speed of `pace` until paused, won or cancelled.

        A game that is already won goes on.
        """
        if self._running:
            return
        self._running = True
        was_won = self.won_at is not None
        self.pace.start()
        try:
            while self._running:
                try:
                    await self._go_on(None if self.pace.speed is FLAT_OUT else 1)
                except Superseded:
                    was_won = self.won_at is not None
                    continue
                if self.won_at is not None and not was_won:
                    return
                await self.pace.wait()
        finally:
            self._running = False
            self.pace.stop()

    async def run_until(
        self, *, tick: int | None = None, condition: Callable[[Frame], bool] | None = None
    ) -> Frame:
        """Step flat out until a tick is reached, a condition holds, or the game is won.

        Args:
            tick: Stop when this tick is finished.
            condition: Stop when it is true of the frame just finished.

        Raises:
            Superseded: The game was restarted, gone back or reprogrammed meanwhile.
        """
        was_won = self.won_at is not None
        while tick is None or self._frame.tick < tick:
            most = None if tick is None else tick - self._frame.tick
            met = await self._go_on(most, condition)
            if met or (self.won_at is not None and not was_won):
                break
        return self._frame

    def pause(self) -> None:
        """End `run`, stopping a thought under way; the unfinished tick is dropped."""
        if self._running:
            self._running = False
            self._supersede()
            self.pace.wake()

    async def close(self) -> None:
        """Stop all work and free the minds. The game can't be used afterwards."""
        if self._closed:
            return
        self._closed = True
        self._running = False
        self.run_number += 1
        self.pace.wake()
        await asyncio.gather(self._thinker.close(), self._asker.close())

    # -- inside --------------------------------------------------------------------------------

    async def _go_on(
        self, most: int | None, condition: Callable[[Frame], bool] | None = None
    ) -> bool:
        """Compute some ticks and show each, up to victory or one of which a condition is true.

        Returns:
            Whether the condition was true.
        """
        run = self.run_number
        for frame in await self._compute(most):
            self._take(frame, run)
            if condition and condition(frame):
                return True
        return False

    async def _compute(self, most: int | None) -> list[Frame]:
        """The next ticks: at most so many, or as many as a fraction of a second allows.

        To change between threads takes about as long as a quick tick does.
        """
        program, past = self.program, self._frame

        def ticks(stop: threading.Event) -> list[Frame]:
            mind = self._thinker.mind(program, self.level, self.limits)
            until = perf_counter() + _TOGETHER_SECONDS
            frames = [next_frame(self._world, mind, past, stop)]
            while most is None or len(frames) < most:
                if perf_counter() > until or frames[-1].after.won_at == frames[-1].tick:
                    break
                frames.append(next_frame(self._world, mind, frames[-1], stop))
            return frames

        try:
            return await self._thinker.do(ticks)
        except Stopped:
            raise Superseded from None

    def _take(self, frame: Frame, run: int) -> None:
        """Make a computed frame the present, if it still follows the present one."""
        if run != self.run_number or frame.before is not self._frame.after:
            raise Superseded
        self.history.add(frame)
        self._show(frame)

    def _supersede(self) -> None:
        self.run_number += 1
        self._thinker.stop()

    def _show(self, frame: Frame) -> None:
        self._frame = frame
        self.pace.count()
        for listener in self._listeners:
            listener(frame)
