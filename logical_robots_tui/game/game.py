"""The game: a world and a mind in step, with a history."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.clock import CLOCK, Clock
from logical_robots_tui.game.advancing import (
    Advance,
    RecordedTick,
    Thinker,
    Worlds,
    advance,
    are_decisions_valid,
    fresh_frame,
    start_frame,
)
from logical_robots_tui.game.debugging.breakpoints import (
    Breakpoint,
    Breakpoints,
    Hit,
    Watch,
    mistake_in,
)
from logical_robots_tui.game.frame import Frame, Superseded, ends
from logical_robots_tui.game.history.history import DEFAULT_LENGTH, History, Past
from logical_robots_tui.game.pace import Pace
from logical_robots_tui.mind import Limits, ResultTable, Stopped
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level, WorldState
from logical_robots_tui.world.world import Pose, change_state, former_names

if TYPE_CHECKING:
    from logical_robots_tui.game.advancing import Decide
    from logical_robots_tui.mind import Program

_BATCH = 16  # ticks taken from history at once
_SECONDS_SHOWN = 0.008  # of computing at once when each tick is to be shown soon
_SECONDS_AWAY = 0.03  # when only the end matters: switching threads costs half a tick


class Game:
    """World, mind and history of one level under one program.

    Ticks are computed off the event loop. The same level and program produce the same frames.
    Going back, restarting or changing the program while a tick is being computed drops that tick.

    After going back, stored ticks are replayed. They are recomputed only under another program;
    the branch they belonged to is then kept, to compare with and to switch to.

    Args:
        level: The level.
        program: The robots' program.
        limits: Limits on thinking.
        history: How many ticks it is possible to go back.
        breakpoints: Where `run` and `run_until` stop; may change at any time.
        clock: What paces the robots; it decides nothing else.

    Attributes:
        decide: Returns the decisions to follow in place of the program's, for a replay.
    """

    def __init__(
        self,
        level: Level,
        program: Program,
        *,
        limits: Limits | None = None,
        history: int = DEFAULT_LENGTH,
        breakpoints: Breakpoints | None = None,
        clock: Clock = CLOCK,
        pace: Pace | None = None,
    ) -> None:
        self.program = program
        self.limits = limits or Limits()
        self.run_number = 0
        self.pace = pace or Pace(clock=clock)
        self.clock = clock
        self.breakpoints = Breakpoints() if breakpoints is None else breakpoints
        self._listeners: list[Callable[[Frame], None]] = []
        self._thinker = Thinker("think")
        self._asker = Thinker("ask")
        self._running = False
        self._closed = False
        self._worlds = Worlds(level)  # used by the worker; the past has its own, on the event loop
        self._frame = start_frame(level)
        self.history = History(self._frame, level, history)
        self._past = Past(self.history)
        self._watch = Watch(())
        self._watched_by = program
        self._is_program_wanted = False
        self.decide: Decide | None = None

    @property
    def frame(self) -> Frame:
        """The current frame."""
        return self._frame

    @property
    def level(self) -> Level:
        """The level at the current frame, in which the game continues."""
        return self.history.level_at(self._frame.tick)

    @property
    def running(self) -> bool:
        """Whether `run` is in progress."""
        return self._running

    @property
    def won_at(self) -> int | None:
        """The tick of victory as of the current frame, or None."""
        return self._frame.after.won_at

    @property
    def hits(self) -> tuple[Hit, ...]:
        """The breakpoints that were hit in the current tick."""
        return self.history.hits_at(self._frame.tick)

    def problem_with(self, breakpoint_: Breakpoint) -> str:
        """Return why a breakpoint can't be hit, one sentence, or ""."""
        mistake = mistake_in(breakpoint_, self.level, self.program)
        return mistake or self._present_watch().problems.get(breakpoint_, "")

    def listen(self, listener: Callable[[Frame], None]) -> None:
        """Call `listener` with each new current frame, on the event loop's thread."""
        self._listeners.append(listener)

    def frame_at(self, tick: int) -> Frame:
        """Restore the exact frame of a past tick, or raise NoSuchTickError."""
        return self._frame if tick == self._frame.tick else self._past.frame(tick)

    async def query(self, predicate: str, frame: Frame | None = None) -> ResultTable:
        """Return the rows of a predicate at a frame, by default the current one.

        The current program is evaluated, even for ticks that another program decided. Raises
        QueryError, and Superseded if the program changed or a newer query came meanwhile.
        """
        frame = frame or self._frame
        program, level = self.program, self.history.level_at(frame.tick)
        self._asker.stop()

        def ask(stop: threading.Event) -> ResultTable:
            mind = self._asker.mind(program, level, self.limits)
            return mind.query(predicate, frame.sensors, frame.memories_before, stop=stop)

        table = await self._asker.do(ask)
        if program is not self.program:
            raise Superseded
        return table

    async def step(self) -> Frame:
        """Compute the next tick, or replay it from history, and make it the current one.

        Cancelling the call stops the thinking and leaves the game where it was. Raises Superseded
        if the game was restarted, rewound or reprogrammed in the meantime.
        """
        await self._advance(1)
        return self._frame

    def back(self, ticks: int = 1) -> Frame:
        """Go back a number of ticks, at most to the earliest one in history."""
        return self.go_to(max(self._frame.tick - ticks, self.history.first))

    def go_to(self, tick: int) -> Frame:
        """Go to a tick in history, from which the game continues, or raise NoSuchTickError."""
        frame = self.frame_at(tick)
        if frame is not self._frame:
            self._supersede()
            self._show(frame)
        return frame

    def restart(self, level: Level | None = None) -> Frame:
        """Restart a level, by default the current one, and undo live edits."""
        self._supersede()
        level = level or self.level
        frame = start_frame(level)
        if not self.history.begins_with(frame, level):
            self.history.begin_anew(frame, level)
        self._is_program_wanted = True
        self._show(frame)
        return frame

    def look_at(self, team: str) -> None:
        """Answer questions about this team's program from now on; robots are unaffected."""
        self.program = self.program.for_team(team)

    def use(self, program: Program) -> None:
        """Use another program from the next tick on; world and memories are kept."""
        self._supersede()
        self.program = program
        self._is_program_wanted = True

    def change_level(self, level: Level, poses: Mapping[str, Pose] | None = None) -> Frame:
        """Change the level from the end of the current tick on; earlier ticks are unaffected."""
        frame, old_level = self._frame, self.level
        old_names = former_names(old_level, level)
        values: dict[str, Value] = {name: frame.memories[old] for name, old in old_names.items()}
        memories = {robot.name: values.get(robot.name, "") for robot in level.robots}
        state = change_state(frame.after, old_level, level, poses or {})
        keeps_decisions = bool(frame.decisions) and are_decisions_valid(old_level, level)
        return self.go_on_in(level, state, memories, keeps_decisions)

    def go_on_in(
        self, level: Level, state: WorldState, memories: Mapping[str, Value], keeps_decisions: bool
    ) -> Frame:
        """Continue in a given state; one of another tick begins a new branch of history."""
        frame = replace(self._frame, after=state)
        if not keeps_decisions:
            frame = fresh_frame(self._past.worlds.world_for(level), state, memories)
        self._supersede()
        if state.tick == self._frame.tick:
            self.history.change_level(frame, level)
        else:
            self.history.begin_anew(frame, level)
        self._past.forget()
        self._show(frame)
        return frame

    def change_branch(self) -> Frame:
        """Switch to the branch that was abandoned when another branch began, and to its program.

        The tick stays the same, if the other branch holds it. May raise NoSuchTickError.
        """
        self._supersede()
        history = self.history
        history.change_branch()
        self.program = history.program_at(history.last) or self.program
        self._is_program_wanted = False
        self._show(self._past.frame(min(max(self._frame.tick, history.first), history.last)))
        return self._frame

    def forget_future(self) -> None:
        """Discard the ticks after the current one, so that they are recomputed."""
        self._supersede()
        self.history.forget_future(self._frame.tick)

    async def run(self) -> None:
        """Step at the speed of `pace` until a breakpoint, a pause, the end or cancellation.

        The end is victory, or that of a match; a game that is over continues.
        """
        if self._running:
            return
        self._running = True
        self.pace.start()
        try:
            while self._running:
                try:
                    if await self._advance(self.pace.batch_size) or ends(self.level, self._frame):
                        return
                except Superseded:
                    continue
                await self.pace.wait()
        finally:
            self._running = False
            self.pace.stop()

    async def run_until(
        self, *, tick: int | None = None, condition: Callable[[Frame], bool] | None = None
    ) -> Frame:
        """Step flat out until a tick, a breakpoint or a condition is met, or the game ends.

        Raises Superseded as `step` does.
        """
        while tick is None or self._frame.tick < tick:
            limit = None if tick is None else tick - self._frame.tick
            is_met = await self._advance(limit, condition, _SECONDS_AWAY)
            if is_met or ends(self.level, self._frame):
                break
        return self._frame

    def pause(self) -> None:
        """End `run` and stop the current thought; the unfinished tick is dropped."""
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

    async def _advance(
        self,
        limit: int | None,
        condition: Callable[[Frame], bool] | None = None,
        seconds: float = _SECONDS_SHOWN,
    ) -> bool:
        """Advance some ticks and show each; return whether a condition or breakpoint was met."""
        run, tick, texts = self.run_number, self._frame.tick, self.program.texts
        batch = min(limit or _BATCH, _BATCH)
        is_on_branch = not self._is_program_wanted
        stored = self.history.stored_ahead(tick, batch, texts, follow_branch=is_on_branch)
        for step in await self._compute_ahead(limit, stored, seconds):
            frame = step.frame
            follows = frame.before is self._frame.after or not frame.decisions
            if run != self.run_number or not follows:
                raise Superseded
            if not stored:
                self.history.add(frame, self.program)
                self._is_program_wanted = False
            self.history.note_hits(frame.tick, step.hits)
            self._show(frame)
            if step.hits or (condition and condition(step.frame)):
                return True
        return False

    async def _compute_ahead(
        self, limit: int | None, stored: list[RecordedTick], seconds: float
    ) -> list[Advance]:
        program, level, frame = self.program, self.level, self._frame
        watch = self._present_watch()
        decide, clock = self.decide, self.clock

        def ticks(stop: threading.Event) -> list[Advance]:
            mind = self._thinker.mind(program, level, self.limits)
            return advance(
                self._worlds, level, mind, frame, stored, watch, stop, clock, seconds, limit, decide
            )

        try:
            return await self._thinker.do(ticks)
        except Stopped:
            raise Superseded from None

    def _present_watch(self) -> Watch:
        breakpoints = self.breakpoints.enabled
        if self._watch.breakpoints != breakpoints or self._watched_by is not self.program:
            self._watch, self._watched_by = Watch(breakpoints), self.program
        return self._watch

    def _supersede(self) -> None:
        self.run_number += 1
        self._thinker.stop()

    def _show(self, frame: Frame) -> None:
        self._frame = frame
        self.pace.count()
        for listener in self._listeners:
            listener(frame)
