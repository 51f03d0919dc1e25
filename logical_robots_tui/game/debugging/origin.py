"""The origin of a value in a robot's memory: tracing back through the ticks that only kept it.

A value is traced from the tick in which it is seen to the one in which a rule made it, across
robots that read each other's memories, and from there to the values that it was made from.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui import explain
from logical_robots_tui.explain.why.sourcing import part_of
from logical_robots_tui.game.frame import NoSuchTickError, Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import QueryError
from logical_robots_tui.mind.relations import alike

if TYPE_CHECKING:
    import threading
    from collections.abc import Awaitable, Callable, Mapping, Sequence

    from logical_robots_tui.explain.why.probing import Span
    from logical_robots_tui.explain.why.sourcing import Made, Path, Read
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import Mind
    from logical_robots_tui.values import Value

_MOST_LINKS = 24
_MOST_READS = 4  # per link that are traced

Source: TypeAlias = "Callable[[int, str, Path], Awaitable[tuple[Made, Mapping[str, Value]]]]"
"""Returns how a part of a robot's memory was made in a tick, and all memories before that tick."""


@dataclass(frozen=True, slots=True)
class Link:
    """A value, and the tick in which it was made.

    Attributes:
        robot: The robot in whose memory it was made.
        path: The part of that memory.
        value: The value.
        tick: The tick in which it was made; 0 if it existed at the start.
        until: The tick at which it is examined.
        span: The expression that made it.
        rule: The rule that contains the expression.
        reads: The values that were read to make it.
        before: Indices of the links for those of them that are traced further.
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
    """The history of a value.

    Attributes:
        links: The value itself, then the values it was made from, and so on.
        complete: Whether everything was traced to the start or to sensors.
    """

    links: tuple[Link, ...]
    complete: bool


async def origin_in_run(
    run: Run,
    robot: str,
    path: Path,
    tick: int,
    told: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace a part of a robot's memory after a tick of a run.

    `told` is called with the number of ticks examined so far.

    Raises:
        QueryError: There is no such robot or part, or its origin can't be determined.
    """
    looked = 0

    async def source(at: int, whose: str, part: Path) -> tuple[Made, Mapping[str, Value]]:
        nonlocal looked
        looked += 1
        told(looked)
        work = partial(_source, whose, part)
        (found,) = [each async for each in run.each(at, at, work)]
        return found

    return await origin_of(source, robot, path, tick)


async def origin_in_game(
    game: Game,
    robot: str,
    path: Path,
    tick: int | None = None,
    told: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace a part of a robot's memory after a tick of a game.

    Each tick is examined with the program that decided it. Cancelling the call ends the work. The
    tick is by default the current one. `told` is called with each tick that is examined.

    Raises:
        QueryError: There is no such robot or part, or its origin can't be determined.
        Superseded: The game switched to another course in the meantime.
    """
    history = game.history
    turns = history.turns
    tick = game.frame.tick if tick is None else tick
    if tick == 0:
        value = part_of(history.around(0)[1].memories.get(robot), path)
        return Origin((Link(robot, path, value, 0, 0, None, None, ()),), complete=True)
    thinker = Thinker("origin")

    async def source(at: int, whose: str, part: Path) -> tuple[Made, Mapping[str, Value]]:
        if history.turns != turns:
            raise Superseded
        told(at)
        try:
            before, known = history.replay(at)
        except NoSuchTickError:
            raise QueryError(f"Tick {at} is no longer in the timeline.") from None
        program = history.program_at(at) or game.program
        program = program.for_team(known.level.team_of(whose))

        def work(stop: threading.Event) -> tuple[Made, Mapping[str, Value]]:
            frame, mind = thinker.replay(program, before, known, game.limits)
            return _source(whose, part, frame, mind, stop)

        return await thinker.do(work)

    try:
        return await origin_of(source, robot, path, tick)
    finally:
        await thinker.close()


async def origin_of(source: Source, robot: str, path: Path, tick: int) -> Origin:
    """Trace a part of a robot's memory after a tick.

    Raises:
        QueryError: There is no such robot or part, or its origin can't be determined.
    """
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
    """Parse the path of a part of a memory, such as ``memory.plan.at`` or ``memory.seen[0]``.

    Raises:
        ValueError: The text is not such a path.
    """
    found = re.fullmatch(r"memory((?:\.[^.\[\]]+|\[-?\d+\])*)", text.strip())
    if found is None:
        raise ValueError(
            f"{text!r} is not a part of a memory such as memory.plan or memory.seen[0]"
        )
    pieces = re.findall(r"\.([^.\[\]]+)|\[(-?\d+)\]", found.group(1))
    return tuple(name if name else int(number) for name, number in pieces)


def _source(
    robot: str, path: Path, frame: Frame, mind: Mind, stop: threading.Event
) -> tuple[Made, Mapping[str, Value]]:
    explainer = explain.Explainer(mind, robot, frame.sensors, frame.memories_before, stop=stop)
    return explainer.source(path), frame.memories_before


async def _link(source: Source, robot: str, path: Path, tick: int) -> Link:
    """Return the link for the tick in which a value was made, or for the start."""
    until = tick
    while True:
        made, memories = await source(tick, robot, path)
        kept = _kept(made, memories)
        if kept is None:
            return Link(robot, path, made.value, tick, until, made.span, made.rule, made.reads)
        robot, path = kept
        tick -= 1
        if tick < 1:
            return Link(robot, path, made.value, 0, until, None, None, ())


def _kept(made: Made, memories: Mapping[str, Value]) -> tuple[str, Path] | None:
    """Return the robot and path that held a value before, if the tick only kept it."""
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
    """Return the longest common prefix of paths."""
    length = 0
    while length < min(map(len, paths)) and len({path[length] for path in paths}) == 1:
        length += 1
    return paths[0][:length]
