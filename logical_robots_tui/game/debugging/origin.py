"""The origin of a value in a robot's memory, traced back to the rule that made it.

The trace crosses robots that read each other's memories, and continues with the values that
it was made from.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui import explain
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.explain.why.sourcing import Path, Provenance, Read, part_of
from logical_robots_tui.game.frame import Frame, NoSuchTickError, Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import QueryError
from logical_robots_tui.mind.relations import alike
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import Mind

_MOST_LINKS = 24
_MOST_READS = 4  # per link that are traced

Source: TypeAlias = "Callable[[int, str, Path], Awaitable[tuple[Provenance, Mapping[str, Value]]]]"
"""Returns how a part of a robot's memory was made in a tick, and all memories before that tick."""


@dataclass(frozen=True, slots=True)
class Link:
    """A value, and the tick in which it was made; 0 if it existed at the start.

    Attributes:
        until: The tick at which it is examined.
        before: Indices of the links for the values read that are traced further.
    """

    robot: str
    path: Path
    value: Value
    tick: int
    until: int
    span: Span | None
    rule: Span | None
    reads: tuple[Read, ...]
    before: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Origin:
    """A value's history, itself first; complete if traced to the start or to sensors."""

    links: tuple[Link, ...]
    complete: bool


async def origin_in_run(
    run: Run,
    robot: str,
    path: Path,
    tick: int,
    report: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace a part of a robot's memory after a tick of a run, or raise QueryError."""
    looked = 0

    async def source(at: int, whose: str, part: Path) -> tuple[Provenance, Mapping[str, Value]]:
        nonlocal looked
        looked += 1
        report(looked)
        work = partial(_source, whose, part)
        (found,) = [each async for each in run.each(at, at, work)]
        return found

    return await origin_of(source, robot, path, tick)


async def origin_in_game(
    game: Game,
    robot: str,
    path: Path,
    tick: int | None = None,
    report: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace part of a memory after a tick, by default the current, of a game.

    Each tick is examined with the program that decided it. Raises QueryError, or Superseded if
    the game switched to another course.
    """
    history = game.history
    turns = history.turns
    tick = game.frame.tick if tick is None else tick
    if tick == 0:
        value = part_of(history.around(0)[1].memories.get(robot), path)
        return Origin((Link(robot, path, value, 0, 0, None, None, ()),), complete=True)
    thinker = Thinker("origin")

    async def source(at: int, whose: str, part: Path) -> tuple[Provenance, Mapping[str, Value]]:
        if history.turns != turns:
            raise Superseded
        report(at)
        try:
            before, known = history.replay(at)
        except NoSuchTickError:
            raise QueryError(f"Tick {at} is no longer in the timeline.") from None
        program = history.program_at(at) or game.program
        program = program.for_team(known.level.team_of(whose))

        def work(stop: threading.Event) -> tuple[Provenance, Mapping[str, Value]]:
            frame, mind = thinker.replay(program, before, known, game.limits)
            return _source(whose, part, frame, mind, stop)

        return await thinker.do(work)

    try:
        return await origin_of(source, robot, path, tick)
    finally:
        await thinker.close()


async def origin_of(source: Source, robot: str, path: Path, tick: int) -> Origin:
    """Trace a part of a robot's memory after a tick, or raise QueryError."""
    links: list[Link] = []
    numbers: dict[tuple[int, str, Path], int] = {}
    waiting: list[tuple[int | None, int, str, Path]] = [(None, tick, robot, path)]
    complete = True
    while waiting:
        parent, at, whose, part = waiting.pop(0)
        if len(links) >= _MOST_LINKS:
            complete = False
            break
        try:
            link = await _link(source, whose, part, at)
        except QueryError:
            if parent is None:
                raise
            complete = False
            continue
        key = (link.tick, link.robot, link.path)
        number = numbers.setdefault(key, len(links))
        if parent is not None and number not in links[parent].before and number != parent:
            links[parent] = replace(links[parent], before=(*links[parent].before, number))
        if number < len(links):
            continue
        links.append(link)
        found = [read for read in link.reads if read.what == "memory" and read.value is not None]
        complete = complete and len(found) <= _MOST_READS
        if link.tick > 1:
            waiting += [(number, link.tick - 1, r.robot, r.path) for r in found[:_MOST_READS]]
    return Origin(tuple(links), complete)


def read_path(text: str) -> Path:
    """Parse a path such as ``memory.plan.at`` or ``memory.seen[0]``, or raise ValueError."""
    found = re.fullmatch(r"memory((?:\.[^.\[\]]+|\[-?\d+\])*)", text.strip())
    if found is None:
        raise ValueError(
            f"{text!r} is not a part of a memory such as memory.plan or memory.seen[0]"
        )
    pieces = re.findall(r"\.([^.\[\]]+)|\[(-?\d+)\]", found.group(1))
    return tuple(name if name else int(number) for name, number in pieces)


def _source(
    robot: str, path: Path, frame: Frame, mind: Mind, stop: threading.Event
) -> tuple[Provenance, Mapping[str, Value]]:
    explainer = explain.Explainer(mind, robot, frame.sensors, frame.memories_before, stop=stop)
    return explainer.source(path), frame.memories_before


async def _link(source: Source, robot: str, path: Path, tick: int) -> Link:
    until = tick
    while True:
        made, memories = await source(tick, robot, path)
        kept = _source_of(made, memories)
        if kept is None:
            return Link(robot, path, made.value, tick, until, made.span, made.rule, made.reads)
        robot, path = kept
        tick -= 1
        if tick < 1:
            return Link(robot, path, made.value, 0, until, None, None, ())


def _source_of(made: Provenance, memories: Mapping[str, Value]) -> tuple[str, Path] | None:
    if not made.reads or any(read.what != "memory" for read in made.reads):
        return None
    robots = {read.robot for read in made.reads}
    if len(robots) > 1:
        return None
    robot, path = robots.pop(), _common([read.path for read in made.reads])
    try:
        before = part_of(memories.get(robot), path)
    except QueryError:
        return None
    return (robot, path) if alike(before, made.value) else None


def _common(paths: Sequence[Path]) -> Path:
    length = 0
    while length < min(map(len, paths)) and len({path[length] for path in paths}) == 1:
        length += 1
    return paths[0][:length]
