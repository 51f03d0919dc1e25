"""Where a value in a robot's memory comes from: back through the ticks that only kept it.

A value is followed from the tick in which it is seen to the one in which a rule made it, across
robots that read each other's memories; and from there on to what it was made from.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.game.advancing import known_frame
from logical_robots_tui.game.frame import NoSuchTickError, Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.game.worlds import Worlds
from logical_robots_tui.mind import QueryError
from logical_robots_tui.mind.why.relations import alike
from logical_robots_tui.mind.why.sourcing import part_of

if TYPE_CHECKING:
    import threading
    from collections.abc import Awaitable, Callable, Mapping, Sequence

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import Mind
    from logical_robots_tui.mind.why.probing import Span
    from logical_robots_tui.mind.why.sourcing import Made, Path, Read
    from logical_robots_tui.values import Value

__all__ = [
    "Link",
    "Origin",
    "origin_in_game",
    "origin_in_run",
    "origin_of",
    "read_path",
    "written_path",
]

MOST_LINKS = 24
_MOST_READS = 4  # of one link that are followed

Source: TypeAlias = "Callable[[int, str, Path], Awaitable[tuple[Made, Mapping[str, Value]]]]"
"""Gives for a tick, a robot and a part of its memory how that came about, and the memories of all
robots before that tick."""


@dataclass(frozen=True, slots=True)
class Link:
    """A value, and the tick in which it was made.

    Attributes:
        robot: In whose memory it was made.
        path: The part of that memory.
        value: The value.
        tick: The tick in which it was made; 0 if it was there at the start.
        until: The tick in which it is looked at.
        span: The expression that made it.
        rule: The rule in which that stands.
        reads: What was read for it.
        before: Numbers of the links, from 0, of the values among these that are followed.
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
        links: The value itself, then what it was made from, and so on.
        complete: Whether all was followed to the start or to sensors.
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
    """Where a part of the memory comes from that a robot has after a tick of a run.

    Args:
        run: The run.
        robot: Name of the robot.
        path: The part: names of fields and places in lists.
        tick: The tick, from 1.
        told: Called meanwhile with the number of ticks that were looked at.

    Raises:
        QueryError: There is no such robot or part, or how it came about can't be told.
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
    """Where a part of the memory comes from that a robot has after a tick of a game.

    Each tick is asked with the program that decided in it. Cancelling the call ends the work.

    Args:
        game: The game.
        robot: Name of the robot.
        path: The part: names of fields and places in lists.
        tick: The tick, by default the present one; 0 is the start.
        told: Called meanwhile with the tick that is looked at.

    Raises:
        QueryError: There is no such robot or part, or how it came about can't be told.
        Superseded: The game went over to another course meanwhile.
    """
    history = game.history
    turns = history.turns
    tick = game.frame.tick if tick is None else tick
    if tick == 0:
        value = part_of(history.around(0)[1].memories.get(robot), path)
        return Origin((Link(robot, path, value, 0, 0, None, None, ()),), complete=True)
    thinker = Thinker("origin")
    worlds: list[Worlds] = []

    async def source(at: int, whose: str, part: Path) -> tuple[Made, Mapping[str, Value]]:
        if history.turns != turns:
            raise Superseded
        told(at)
        try:
            before, _ = history.around(at)
            known = history.known(at)
        except NoSuchTickError:
            raise QueryError(f"Tick {at} is not in the timeline any more.") from None
        program = history.program_at(at) or game.program

        def work(stop: threading.Event) -> tuple[Made, Mapping[str, Value]]:
            if not worlds:
                worlds.append(Worlds(known.level))
            frame = known_frame(worlds[0], before.after, before.memories, known)
            mind = thinker.mind(program, known.level, game.limits)
            return _source(whose, part, frame, mind, stop)

        return await thinker.do(work)

    try:
        return await origin_of(source, robot, path, tick)
    finally:
        await thinker.close()


async def origin_of(
    source: Source, robot: str, path: Path, tick: int, *, most: int = MOST_LINKS
) -> Origin:
    """Where a part of the memory comes from that a robot has after a tick.

    Args:
        source: Gives how a part of a memory came about in a tick.
        robot: Name of the robot.
        path: The part: names of fields and places in lists.
        tick: The tick, from 1.
        most: Most links.

    Raises:
        QueryError: There is no such robot or part, or how it came about can't be told.
    """
    links: list[Link] = []
    numbers: dict[tuple[int, str, Path], int] = {}
    waiting: list[tuple[int | None, int, str, Path]] = [(None, tick, robot, path)]
    complete = True
    while waiting:
        parent, at, whose, part = waiting.pop(0)
        if len(links) >= most:
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
    """The part of a memory that a text names, such as ``memory.plan.at`` or ``memory.seen[0]``.

    Raises:
        ValueError: It names none.
    """
    found = re.fullmatch(r"memory((?:\.[^.\[\]]+|\[-?\d+\])*)", text.strip())
    if found is None:
        raise ValueError(f"{text!r} is no part of a memory, such as memory.plan or memory.seen[0]")
    pieces = re.findall(r"\.([^.\[\]]+)|\[(-?\d+)\]", found.group(1))
    return tuple(name if name else int(number) for name, number in pieces)


def written_path(path: Path, what: str = "memory") -> str:
    """The same the other way round."""
    return what + "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in path)


def _source(
    robot: str, path: Path, frame: Frame, mind: Mind, stop: threading.Event
) -> tuple[Made, Mapping[str, Value]]:
    explainer = mind.explainer(robot, frame.sensors, frame.memories_before, stop=stop)
    return explainer.source(path), frame.memories_before


async def _link(source: Source, robot: str, path: Path, tick: int) -> Link:
    """The tick in which a value was made, or that it was there from the start."""
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
    """Whose memory, and which part of it, has held a value before, if it was only kept."""
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
    """The longest beginning that paths have in common."""
    length = 0
    while length < min(map(len, paths)) and len({path[length] for path in paths}) == 1:
        length += 1
    return paths[0][:length]
