"""Frames that are computed, replayed or edited, and the thread with a mind that does it."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from logical_robots_tui.clock import CLOCK
from logical_robots_tui.game.frame import Frame, ends
from logical_robots_tui.mind import Stopped
from logical_robots_tui.world import Level, World

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.clock import Clock
    from logical_robots_tui.game.debugging.breakpoints import Hit, Watch
    from logical_robots_tui.game.history.packing import Moment
    from logical_robots_tui.mind import Decision, Limits, Mind, Program
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import WorldState

    Decide = Callable[[int, tuple[Decision, ...]], tuple[Decision, ...]]

T = TypeVar("T")


class Advance(NamedTuple):
    frame: Frame
    hits: tuple[Hit, ...]


class RecordedTick(NamedTuple):
    """A tick of a history: the level in which the robots sensed, the moments before and after."""

    level: Level
    previous: Frame | Moment
    moment: Moment


def advance(
    worlds: Worlds,
    level: Level,
    mind: Mind,
    previous: Frame,
    recorded: Sequence[RecordedTick],
    watch: Watch,
    stop: threading.Event,
    clock: Clock,
    seconds: float,
    limit: int | None = None,
    decide: Decide | None = None,
) -> list[Advance]:
    """Return the ticks after a past one, up to their end or a breakpoint. Blocks.

    If the next ticks are `recorded`, they are replayed and no others computed. No tick starts after
    `seconds`. The robots follow what `decide` returns for a tick and its decisions. Raises
    Stopped.
    """
    if recorded:
        limit = len(recorded) if limit is None else min(limit, len(recorded))
    deadline = clock.now() + seconds
    advances: list[Advance] = []
    while True:
        if recorded:
            frame = frame_of(worlds, recorded[len(advances)]._replace(previous=previous))
        else:
            world = worlds.world_for(level)
            world.restore(previous.after)
            frame = play_tick(world, mind, previous, stop, decide, clock)
        is_watched = watch.breakpoints and frame.decisions
        hits = watch.hits(previous, frame, mind, stop) if is_watched else ()
        advances.append(Advance(frame, hits))
        if hits or ends(level, frame) or len(advances) == limit or clock.now() > deadline:
            return advances
        previous = frame


def frame_of(worlds: Worlds, recorded: RecordedTick) -> Frame:
    """Restore a frame: let the robots sense again from the end of the previous tick."""
    level, previous, moment = recorded
    world = worlds.world_for(level)
    if not moment.decisions:
        return fresh_frame(world, moment.after, moment.memories)
    world.restore(previous.after)
    start, end, rows = previous.after, moment.after, tuple(world.sense())
    memories, milliseconds = previous.memories, moment.think_milliseconds
    decisions = moment.decisions
    return Frame(end.tick, start, end, rows, memories, decisions, moment.memories, milliseconds)


def play_tick(
    world: World,
    mind: Mind,
    previous: Frame,
    stop: threading.Event | None = None,
    decide: Decide | None = None,
    clock: Clock = CLOCK,
) -> Frame:
    """Let all robots sense, think and follow `decide` once after a past frame, or raise Stopped."""
    rows = tuple(world.sense())
    start_time = clock.now()
    decisions = tuple(mind.think(rows, previous.memories, stop=stop))
    milliseconds = 1000 * (clock.now() - start_time)
    if decide is not None:
        decisions = decide(world.tick, decisions)
    world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
    memories = {d.robot_name: d.memory for d in decisions}
    end, start = world.save(), previous.after
    return Frame(end.tick, start, end, rows, previous.memories, decisions, memories, milliseconds)


def start_frame(level: Level, world: World | None = None) -> Frame:
    """Return frame 0 of a level, before any thought; needs no program."""
    world = world or World(level)
    return fresh_frame(world, world.save(), {robot.name: "" for robot in level.robots})


def fresh_frame(world: World, state: WorldState, memories: Mapping[str, Value]) -> Frame:
    """Return a frame without decisions, and leave the world in this state."""
    world.restore(state)
    return Frame(state.tick, state, state, tuple(world.look()), memories, (), memories, 0.0)


class Worlds:
    """Holds one world; a world for a similar level is created from it quickly."""

    def __init__(self, level: Level) -> None:
        self._world = World(level)

    def world_for(self, level: Level) -> World:
        """Return the world of a level, in the state it was left in."""
        if self._world.level is not level:
            self._world = World(level, like=self._world)
        return self._world


def are_decisions_valid(old: Level, new: Level) -> bool:
    """Return whether robots, teams, areas and visibility match, so decisions stay valid."""
    names = (
        ([(robot.name, robot.team) for robot in level.robots], [area.name for area in level.areas])
        for level in (old, new)
    )
    return old.visibility == new.visibility and next(names) == next(names)


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
        self, program: Program, recorded: RecordedTick, limits: Limits
    ) -> tuple[Frame, Mind]:
        self._worlds = self._worlds or Worlds(recorded.level)
        return frame_of(self._worlds, recorded), self.mind(program, recorded.level, limits)

    async def do(self, work: Callable[[threading.Event], T]) -> T:
        """Run work in the thread, passing it the event that asks it to stop."""
        stop = self._stop = threading.Event()

        def work_unless_stopped() -> T:
            if stop.is_set():
                raise Stopped
            return work(stop)

        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, work_unless_stopped)
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
