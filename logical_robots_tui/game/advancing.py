"""Advancing: the next ticks of a game, computed, or as they are known from history."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

from logical_robots_tui.game.frame import Frame
from logical_robots_tui.game.start import fresh_frame

if TYPE_CHECKING:
    import threading
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.game.breakpoints import Hit
    from logical_robots_tui.game.packing import Moment
    from logical_robots_tui.game.watching import Watch
    from logical_robots_tui.game.worlds import Worlds
    from logical_robots_tui.mind import Mind
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level, World, WorldState

__all__ = ["Advance", "Known", "advance", "known_frame"]


@dataclass(frozen=True, slots=True)
class Advance:
    """One tick further.

    Attributes:
        frame: The tick.
        hits: The breakpoints that it hits.
    """

    frame: Frame
    hits: tuple[Hit, ...]


@dataclass(frozen=True, slots=True)
class Known:
    """A tick that is known from history.

    Attributes:
        level: In which the robots sensed in it.
        moment: What it left behind.
    """

    level: Level
    moment: Moment


def advance(
    worlds: Worlds,
    level: Level,
    mind: Mind,
    past: Frame,
    known: Sequence[Known],
    watch: Watch,
    stop: threading.Event,
    seconds: float,
    most: int | None = None,
) -> list[Advance]:
    """The ticks after a past one, up to victory or a breakpoint. Blocks.

    Args:
        worlds: Where to compute them.
        level: The level to compute them in.
        mind: What to think with, and to ask for breakpoints.
        past: After which tick.
        known: The first of the next ticks if they are known; no others are computed then.
        watch: What to stop at.
        stop: Set it from another thread to give up.
        seconds: How much time to begin another one in.
        most: At most so many, by default as many as there is time for.

    Raises:
        Stopped: `stop` was set.
    """
    if known:
        most = len(known) if most is None else min(most, len(known))
    until = perf_counter() + seconds
    done: list[Advance] = []
    while True:
        if known:
            frame = known_frame(worlds, past.after, past.memories, known[len(done)])
        else:
            frame = _next_frame(worlds.of(level), mind, past, stop)
        is_watched = watch.breakpoints and frame.decisions
        hits = watch.hits(past, frame, mind, stop) if is_watched else ()
        done.append(Advance(frame, hits))
        has_won = frame.after.won_at == frame.tick
        if hits or has_won or len(done) == most or perf_counter() > until:
            return done
        past = frame


def known_frame(
    worlds: Worlds, before: WorldState, memories_before: Mapping[str, Value], known: Known
) -> Frame:
    """A frame as it was: the robots sense again what they sensed then."""
    world, moment = worlds.of(known.level), known.moment
    if not moment.decisions:
        return fresh_frame(world, moment.after, moment.memories)
    world.restore(before)
    return Frame(
        moment.after.tick,
        before,
        moment.after,
        tuple(world.sense()),
        memories_before,
        moment.decisions,
        moment.memories,
        moment.think_milliseconds,
    )


def _next_frame(world: World, mind: Mind, past: Frame, stop: threading.Event) -> Frame:
    """Sense, think and act once, from a past frame."""
    before = past.after
    world.restore(before)
    sensors = tuple(world.sense())
    began = perf_counter()
    decisions = tuple(mind.think(sensors, past.memories, stop=stop))
    milliseconds = (perf_counter() - began) * 1000
    world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
    after = world.save()
    memories = {d.robot_name: d.memory for d in decisions}
    return Frame(
        after.tick, before, after, sensors, past.memories, decisions, memories, milliseconds
    )
