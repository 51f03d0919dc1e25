"""The origin of a value, traced back through rules, ticks and robots, and in words.

A value in a memory comes from the tick of its last change, which recorded memories tell. Only
that tick is asked for its derivation; what was remembered before it has an origin of its own.
"""

from __future__ import annotations

import math
import re
import threading
from collections.abc import AsyncGenerator, Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from logical_robots_tui import explain
from logical_robots_tui.explain.why.explanation import Ask, Path, Read, Subject, ValueSource
from logical_robots_tui.game.advancing import Thinker
from logical_robots_tui.game.debugging.changes import FEWEST_STEPS, Change, Steps, last_change
from logical_robots_tui.game.debugging.inquiry import path_text
from logical_robots_tui.game.frame import Frame, NoSuchTickError, Superseded
from logical_robots_tui.mind import QueryError
from logical_robots_tui.mind.relations import alike
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.history import TickHistory
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import Limits, Mind, Program

_MOST_LINKS = 16
_MOST_READS = 4  # per link that are traced
_MOST_STEPS = 24  # that are asked for their derivation, in all
_SLICE = 256  # ticks compared on the event loop at a time


@dataclass(frozen=True, slots=True)
class Link:
    """A value in the chain.

    Attributes:
        tick: The tick that produced it, or the first known one if there is no source.
        until: The tick after which it was read; it has not changed since `tick`.
        source: What produced it; None if it existed from the start, or if that is unknown.
        path: The part of the robot's memory that it is; None if it is none.
        steps: Changes that led to it in the same manner, if it was made from its last value.
        input_links: For each of the inputs, the index of its link, or None if it is an end.
        began: The index of the link of the value before all steps.
        problem: Why the source is unknown, or "".
    """

    robot: str
    name: str
    value: Value
    tick: int
    until: int
    source: ValueSource | None = None
    path: Path | None = None
    steps: Steps | None = None
    input_links: tuple[int | None, ...] = ()
    began: int | None = None
    problem: str = ""

    @property
    def inputs(self) -> tuple[ValueSource, ...]:
        """What it was made from; if it was copied, that. Without itself, if there are steps."""
        source = self.source
        if source is None:
            return ()
        inputs = (*source.inputs, *source.decided_by)
        if source.read is not None:
            inputs = (source, *inputs)
        if self.steps is None:
            return inputs
        return tuple(s for s in inputs if (self.robot, self.path) not in _memories_in(s))


@dataclass(frozen=True, slots=True)
class Origin:
    """A value's history, itself first; complete if traced to its ends."""

    links: tuple[Link, ...]
    complete: bool


async def origin_in_run(
    run: Run,
    robot: str,
    subject: Subject,
    tick: int,
    report: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace a value at a tick of a run, or raise QueryError."""

    async def trace() -> Origin:
        await run.frame(tick, report)
        ticks = _TracedTicks(run, run.program, run.limits, run.thinker, report)
        return await _origin_of(ticks, robot, subject, tick)

    return await run.repeat_if_damaged(trace)


async def origin_in_game(
    game: Game,
    robot: str,
    subject: Subject,
    tick: int | None = None,
    report: Callable[[int], object] = lambda _tick: None,
) -> Origin:
    """Trace a value at a tick, by default the current, of a game.

    Each tick is examined with the program that decided it. Raises QueryError, or Superseded if
    the game switched to another branch.
    """
    thinker = Thinker("origin")
    ticks = _TracedTicks(game.history, game.program, game.limits, thinker, report)
    try:
        tick = game.frame.tick if tick is None else tick
        return await _origin_of(ticks, robot, subject, tick)
    finally:
        await thinker.close()


async def _origin_of(ticks: _TracedTicks, robot: str, subject: Subject, tick: int) -> Origin:
    """Trace a value at a tick, or raise QueryError."""
    tracing = _Tracing(ticks)
    if is_memory(subject):
        await tracing.memory(robot, subject.path, tick)
    elif tick < 1:
        raise QueryError("No decision yet.")
    else:
        source = await ticks.source(tick, robot, subject)
        column = subject.column or source.name.rpartition(".")[2]
        subject = replace(subject, column=column)
        tracing.value(source, robot, tick, subject_name(robot, subject))
    return await tracing.finish()


def is_memory(subject: Subject) -> bool:
    """Return whether a subject is a part of the memory that a robot keeps after the tick."""
    is_own = subject.query in (Ask(), Ask("Robot")) and not subject.span and not subject.variable
    return is_own and subject.column == "memory"


def read_part(text: str) -> tuple[str, Path]:
    """Parse a part such as ``memory.plan.at`` or ``desire.left_engine``, or raise ValueError.

    Returns the column and the path in it.
    """
    match = re.fullmatch(r"(\w+)((?:\.[^.\[\]]+|\[-?\d+\])*)", text.strip())
    if match is None:
        raise ValueError(
            f"{text!r} is not a part such as memory.plan, memory.seen[0] or desire.left_engine"
        )
    pieces = re.findall(r"\.([^.\[\]]+)|\[(-?\d+)\]", match.group(2))
    return match.group(1), tuple(name if name else int(number) for name, number in pieces)


def subject_name(robot: str, subject: Subject) -> str:
    """Return a value in words: ``Ada's desire.left_engine``."""
    if subject.span is not None or subject.variable:
        name = subject.variable or (subject.span.text if subject.span else "")
        return path_text(subject.path, name)
    predicate, column = subject.query.predicate, subject.column
    row = "" if predicate == "Robot" else predicate
    return f"{robot}'s {path_text(subject.path, '.'.join(filter(None, (row, column))))}"


@dataclass(frozen=True, slots=True)
class _PendingInput:
    """An input still to be traced: a memory after a tick, or a value in a tick.

    `place` is the index of the input, or None for the value before all steps.
    """

    parent: int
    place: int | None
    source: ValueSource
    robot: str
    tick: int


class _Tracing:
    def __init__(self, ticks: _TracedTicks) -> None:
        self._ticks = ticks
        self._links: list[Link] = []
        self._numbers: dict[str, int] = {}
        self._pending: list[_PendingInput] = []
        self._complete = True
        self._asks = _MOST_STEPS

    async def finish(self) -> Origin:
        while self._pending:
            if len(self._links) >= _MOST_LINKS:
                self._complete = False
                break
            pending = self._pending.pop(0)
            source, read = pending.source, pending.source.read
            try:
                if read is not None:
                    number = await self.memory(read.robot, read.path, pending.tick)
                else:
                    number = self.value(source, pending.robot, pending.tick, source.name)
            except QueryError:
                self._complete = False
            else:
                self._connect(pending, number)
        return Origin(tuple(self._links), self._complete)

    async def memory(self, robot: str, path: Path, tick: int) -> int:
        """Add the link of a part of a memory after a tick; return its number."""
        change = await last_change(self._ticks.memories(robot, tick), path, tick)
        name = f"{robot}'s {path_text(path)}"
        link = Link(robot, name, change.value, change.tick, tick, path=change.path)
        key = repr((robot, change.path, change.tick))
        if key not in self._numbers and change.is_known:
            try:
                source = await self._ticks.source(change.tick, robot, Subject(path=change.path))
                if not alike(source.value, change.value):
                    raise QueryError("its source can't be determined")
            except QueryError as error:
                self._complete = False
                link = replace(link, problem=str(error).rstrip("."))
            else:
                steps = await self._steps(link, change, source)
                link = replace(link, source=source, steps=steps)
        elif change.tick and not change.is_known:
            self._complete = False
        return self._add(key, link)

    def value(self, source: ValueSource, robot: str, tick: int, name: str) -> int:
        """Add the link of a value within a tick; return its number."""
        key = repr((robot, tick, source.span, source.value, source.inputs))
        return self._add(key, Link(robot, name, source.value, tick, tick, source))

    async def _steps(self, link: Link, change: Change, source: ValueSource) -> Steps | None:
        """Return the steps to a value, if it was made from the one before in each of them."""
        steps, key = change.steps, (link.robot, change.path)
        if steps is None or key not in _memories_in(source) or steps.increment is not None:
            return steps if key in _memories_in(source) else None
        first_tick = change.tick
        while first_tick > steps.since and self._asks > 0:
            self._asks -= 1
            subject = Subject(path=change.path)
            old_source = await self._ticks.source(first_tick - 1, link.robot, subject)
            if key not in _memories_in(old_source):
                break
            source, first_tick = old_source, first_tick - 1
        times = change.tick - first_tick + 1
        if times < FEWEST_STEPS:
            return None
        return Steps(None, first_tick, times, _memories_in(source)[key])

    def _add(self, key: str, link: Link) -> int:
        if key in self._numbers:
            return self._numbers[key]
        number = self._numbers[key] = len(self._links)
        self._links.append(replace(link, input_links=(None,) * len(link.inputs)))
        if link.steps is not None and link.path is not None:
            read = Read("memory", link.robot, link.path, link.steps.begin)
            source = ValueSource("", read.value, read=read)
            self._pending.append(_PendingInput(number, None, source, "", link.steps.since - 1))
        reads = 0
        is_older = link.tick != self._links[0].tick  # then only what it was made from is traced
        decided_by = link.source.decided_by if link.source is not None and is_older else ()
        for place, source in enumerate(link.inputs):
            if any(source is s for s in decided_by):
                continue
            if source.read is None:
                if source.inputs and not source.is_constant:
                    pending = _PendingInput(number, place, source, link.robot, link.tick)
                    self._pending.append(pending)
            elif source.read.kind == "memory" and source.value is not None:
                reads += 1
                if reads <= _MOST_READS:
                    self._pending.append(_PendingInput(number, place, source, "", link.tick - 1))
        self._complete = self._complete and reads <= _MOST_READS
        return number

    def _connect(self, pending: _PendingInput, number: int) -> None:
        link = self._links[pending.parent]
        if pending.place is None:
            self._links[pending.parent] = replace(link, began=number)
        elif number != pending.parent:
            input_links = list(link.input_links)
            input_links[pending.place] = number
            self._links[pending.parent] = replace(link, input_links=tuple(input_links))


def _memories_in(source: ValueSource) -> dict[tuple[str, Path | None], Value]:
    memories: dict[tuple[str, Path | None], Value] = {}
    stack, visited = [source], {id(source)}
    while stack:
        node = stack.pop()
        if node.read is not None and node.read.kind == "memory":
            memories[node.read.robot, node.read.path] = node.read.value
        inner = [child for child in (*node.inputs, *node.decided_by) if id(child) not in visited]
        visited.update(map(id, inner))
        stack += inner
    return memories


class _TracedTicks:
    """The ticks of a history in which a value is traced."""

    def __init__(
        self,
        history: TickHistory,
        program: Program,
        limits: Limits,
        thinker: Thinker,
        report: Callable[[int], object],
    ) -> None:
        self._history, self._program, self._limits = history, program, limits
        self._thinker, self._report = thinker, report
        self._turns = history.turns

    async def memories(self, robot: str, tick: int) -> AsyncGenerator[Sequence[Value]]:
        """Yield a robot's memory after a tick, after the tick before, and so on, in batches."""
        while tick >= 0:
            batch: list[Value] = []
            for past_tick in range(tick, max(tick - _SLICE, -1), -1):
                try:
                    batch.append(self._history.memory(past_tick, robot))
                except (NoSuchTickError, LookupError):
                    break
            yield batch
            if len(batch) < _SLICE:
                return
            tick -= len(batch)
            self._report(tick)
            await self._thinker.do(lambda _stop: None)  # lets the event loop go on
            self._check()

    async def source(self, tick: int, robot: str, subject: Subject) -> ValueSource:
        """Return the source of a value in a robot's reasoning in a tick, or raise QueryError."""
        self._check()
        self._report(tick)
        try:
            recorded = self._history.recorded(tick)
        except NoSuchTickError:
            raise QueryError(f"Tick {tick} is no longer in the timeline.") from None
        if not recorded.moment.decisions:
            raise QueryError("No robot has decided in this tick.")
        program = self._history.program_at(tick) or self._program
        program = program.for_team(recorded.level.team_of(robot))

        def work(stop: threading.Event) -> ValueSource:
            frame, mind = self._thinker.replay(program, recorded, self._limits)
            return _source(robot, subject, frame, mind, stop)

        return await self._thinker.do(work)

    def _check(self) -> None:
        if self._history.turns != self._turns:
            raise Superseded


def _source(
    robot: str, subject: Subject, frame: Frame, mind: Mind, stop: threading.Event
) -> ValueSource:
    explainer = explain.Explainer(mind, robot, frame.sensors, frame.memories_before, stop=stop)
    decision = frame.decision_of(robot) if subject.query.predicate == "Robot" else None
    if decision and any(notice.kind == "several rows" for notice in decision.notices):
        # The row that counts differs from the others in what was decided.
        desire, columns = decision.desire, dict(subject.query.given)
        if subject.column == "desire" and desire is not None:
            engines = {"left_engine": desire.left_engine, "right_engine": desire.right_engine}
            columns["desire"] = engines
        elif subject.column == "memory":
            columns["memory"] = decision.memory
        subject = replace(subject, query=replace(subject.query, given=columns))
    return explainer.source(subject)


_SHOWN_INPUTS = 5
_SHOWN_CONDITIONS = 3

INCOMPLETE = "This is incomplete: some of the values that were read are not traced."


def link_lines(link: Link, written: Callable[[Value], str]) -> Iterator[str]:
    """Yield the lines below a link's value; `written` puts a value in a few words."""
    source = link.source
    if source is None:
        if link.tick or link.problem:
            suffix = f"; {link.problem}" if link.problem else " or longer"
            yield f"the same since tick {link.tick}{suffix}"
        else:
            yield f"there from the start until tick {link.until}"
        return
    if link.path is not None:
        rule = f" by the rule in line {source.rule.line}" if source.rule is not None else ""
        since = f"the same since tick {link.tick}, set then"
        yield (since if link.until > link.tick else f"set in tick {link.tick}") + rule
    if source.span is not None:
        text, fact = source.span.text, source.rule
        if fact and source.is_constant and ":-" not in fact.text and fact.holds(source.span):
            text = fact.text
        yield (
            f"line {source.span.line}: {text}" if text != link.name else f"line {source.span.line}"
        )
    for condition in source.conditions[:_SHOWN_CONDITIONS]:
        holds = "holds" if condition.holds else "does not hold"
        yield f"as in line {condition.span.line} {holds}: {condition.span.text}"
    if link.steps is not None:
        began = f" ({link.began + 1}.)" if link.began is not None else ""
        yield f"{_steps(link.steps, link.tick)}, from {written(link.steps.begin)}{began}"
    verb = "from"
    if source.read is not None:
        verb = "copied from" if source.read.kind == "memory" else "read from"
    pairs = list(zip(link.inputs, link.input_links, strict=True))
    for part, number in pairs[:_SHOWN_INPUTS]:
        reference = f" ({number + 1}.)" if number is not None else ""
        yield f"{verb} {_input(part, written)}{reference}"
        verb = "from"
    if (rest_count := len(pairs) - len(pairs[:_SHOWN_INPUTS]) + source.excess) > 0:
        numbers = [f"{n + 1}." for _, n in pairs[_SHOWN_INPUTS:] if n is not None]
        reference = f" ({', '.join(numbers)})" if numbers else ""
        yield f"and from {rest_count} more{reference}"


def _steps(steps: Steps, tick: int) -> str:
    since = f"since tick {steps.since}"
    if steps.increment is None:
        return f"changes in each tick {since}"
    words = f"counts {'up' if steps.increment > 0 else 'down'} by {abs(steps.increment):.10g}"
    is_in_each_tick = steps.times == tick - steps.since + 1
    return f"{words} {since}" if is_in_each_tick else f"{words}, {steps.times} times {since}"


def _input(source: ValueSource, written: Callable[[Value], str]) -> str:
    read = source.read
    if read is None:
        where = source.span if source.is_constant else None
        line = f" (line {where.line})" if where is not None else ""
        return f"{source.name} = {written(source.value)}{line}"
    if read.kind == "sensor" and read.path[:1] == ("radar",) and len(read.path) == 2:
        ray = read.value if isinstance(read.value, dict) else {}
        kind, label, angle = ray.get("object"), ray.get("label"), ray.get("angle")
        body = f"{kind}" if label in (kind, None) else f'{kind} "{label}"'
        degrees = f"{math.degrees(angle):.0f}°" if isinstance(angle, int | float) else "?"
        place = f"{read.robot}'s ray {read.path[1]} at {degrees}"
        return f"{place}: {body}, distance {ray.get('distance')}"
    return f"{read.robot}'s {path_text(read.path, read.kind)} = {written(read.value)}"
