"""Answering questions about finished ticks: queries and explanations."""

from __future__ import annotations

import asyncio
import contextlib
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from logical_robots_tui import explain
from logical_robots_tui.game.debugging.pins import read
from logical_robots_tui.game.debugging.watching import matching_rows
from logical_robots_tui.game.frame import Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import Limits, ProgramError, QueryError, Stopped, Table

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from logical_robots_tui.explain import Explanation, Proof
    from logical_robots_tui.explain.why.explainer import Explainer
    from logical_robots_tui.explain.why.nearest import Suggestion
    from logical_robots_tui.game.debugging.pins import Pin, Reading
    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.mind import Mind, Program, QueryPlan
    from logical_robots_tui.values import Value
    from logical_robots_tui.world import Level

T = TypeVar("T")

_LIMITS = Limits()


class Inquiry:
    """Answers questions about frames of a level, while the game may continue.

    Questions have no side effects. A newer question of the same kind cancels an older one, which
    raises Superseded.
    """

    def __init__(self, level: Level) -> None:
        self._level = level
        self._asker = Thinker("ask")
        self._explainer = Thinker("explain")
        self._surveyor = Thinker("survey")
        self._watcher = Thinker("watch")

    async def ask(self, program: Program, query: str, frame: Frame) -> Table:
        """Evaluate any query at a frame.

        A query is a call, an expression, conditions, or whole rules of which the last is evaluated.

        Raises:
            ProgramError: The query is wrong; the diagnostics refer to its lines and columns.
            QueryError: It failed at this tick.
        """

        def work(mind: Mind, stop: threading.Event) -> Table:
            question = program.question(query, stop=stop, limits=_LIMITS)
            return mind.ask(question, frame.sensors, frame.memories_before, stop=stop)

        return await self._do(self._asker, program, work)

    async def why(
        self,
        program: Program,
        robot: str,
        frame: Frame,
        *,
        predicate: str = "Robot",
        given: Mapping[str, Value] | None = None,
        within: str = "",
    ) -> Explanation:
        """Explain why a predicate has its rows, or none, in a robot's reasoning at a frame.

        Only rows with the given values in some of the columns are explained. `within` is a
        predicate made with ``:=`` whose rules contain the call.

        Raises:
            QueryError: There is no such predicate or robot, or a function lacks its arguments.
        """
        return await self._explain(
            self._explainer, program, robot, frame, lambda each: each.why(predicate, given, within)
        )

    async def proof(
        self,
        program: Program,
        robot: str,
        frame: Frame,
        *,
        predicate: str = "Robot",
        given: Mapping[str, Value] | None = None,
        within: str = "",
        depth: int = 100,
    ) -> Proof:
        """Return the whole proof of a row in a robot's reasoning at a frame, as `Mind.proof` does.

        The first row with the given values is proved, `depth` predicates deep.

        Raises:
            QueryError: As `why` does.
        """

        def work(explainer: Explainer) -> Proof:
            return explainer.proof(predicate, given, within, depth=depth)

        return await self._explain(self._explainer, program, robot, frame, work)

    async def calls(self, program: Program, robot: str, frame: Frame, predicate: str) -> Table:
        """Return the calls of a function in a robot's reasoning at a frame, as `Mind.calls` does.

        Raises:
            QueryError: There is no such robot or function, or a rule that calls it failed.
        """
        return await self._explain(
            self._surveyor, program, robot, frame, lambda each: each.calls(predicate)
        )

    async def nearest(
        self, program: Program, robot: str, frame: Frame, predicate: str
    ) -> list[tuple[int, Suggestion]]:
        """Return the single changes that would have produced a row, for each rule without one.

        Each is given with the line of its rule; the smallest change of a rule comes first.

        Raises:
            QueryError: The program is too complex.
        """

        def work(explainer: Explainer) -> list[tuple[int, Suggestion]]:
            return [(rule.line, found) for rule, found in explainer.nearest(predicate)]

        return await self._explain(self._explainer, program, robot, frame, work)

    async def query_plans(self, program: Program, frame: Frame) -> list[QueryPlan]:
        """Return how each of the program's predicates is computed at a frame, slowest first."""
        names = [p.name for p in program.predicates if p.kind == "program" and p.has_rows]

        def work(mind: Mind, stop: threading.Event) -> list[QueryPlan]:
            found = []
            for name in names:
                with contextlib.suppress(QueryError):
                    sensors, memories = frame.sensors, frame.memories_before
                    mind.query(name, sensors, memories, stop=stop)  # the first time is slower
                    found.append(mind.query_plan(name, sensors, memories, stop=stop))
            return sorted(found, key=lambda each: -each.milliseconds)

        return await self._do(self._explainer, program, work)

    async def survey(self, program: Program, frame: Frame) -> dict[str, Table | QueryError]:
        """Return the rows of all predicates that have rows, or why one has none."""
        names = [each.name for each in program.predicates if each.has_rows]
        return await self._do(self._surveyor, program, partial(_tables, names, frame))

    async def readings(
        self, program: Program, frame: Frame, pins: Sequence[Pin]
    ) -> dict[Pin, Reading]:
        """Return the values of pins at a frame."""

        def work(mind: Mind, stop: threading.Event) -> dict[Pin, Reading]:
            tables = _tables(dict.fromkeys(pin.predicate for pin in pins), frame, mind, stop)
            return {pin: read(pin, tables[pin.predicate]) for pin in pins}

        return await self._do(self._watcher, program, work)

    async def close(self) -> None:
        """Stop all work and free the minds."""
        thinkers = (self._asker, self._explainer, self._surveyor, self._watcher)
        await asyncio.gather(*(thinker.close() for thinker in thinkers))

    async def _explain(
        self,
        thinker: Thinker,
        program: Program,
        robot: str,
        frame: Frame,
        work: Callable[[Explainer], T],
    ) -> T:
        def explained(mind: Mind, stop: threading.Event) -> T:
            return work(
                explain.Explainer(mind, robot, frame.sensors, frame.memories_before, stop=stop)
            )

        return await self._do(thinker, program, explained)

    async def _do(
        self, thinker: Thinker, program: Program, work: Callable[[Mind, threading.Event], T]
    ) -> T:
        thinker.stop()
        try:
            return await thinker.do(
                lambda stop: work(thinker.mind(program, self._level, _LIMITS), stop)
            )
        except Stopped:
            raise Superseded from None


def _tables(
    predicates: Iterable[str], frame: Frame, mind: Mind, stop: threading.Event
) -> dict[str, Table | QueryError]:
    """Return the rows of predicates or questions at a frame, or why one has none."""
    found: dict[str, Table | QueryError] = {}
    for name in predicates:
        try:
            found[name] = _table(name, frame, mind, stop)
        except ProgramError as error:
            found[name] = QueryError(f"This can't be asked: {error.diagnostics[0].message}.")
        except QueryError as error:
            found[name] = error
    return found


def _table(name: str, frame: Frame, mind: Mind, stop: threading.Event) -> Table:
    """Return the rows of a predicate, or those for which a question holds."""
    sensors, memories = frame.sensors, frame.memories_before
    if name.isidentifier():
        return mind.query(name, sensors, memories, stop=stop)
    question = mind.program.question(name, stop=stop, limits=mind.limits)
    table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
    return matching_rows(question, table)
