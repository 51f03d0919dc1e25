"""Searching a game's history for ticks in which a question holds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.game.debugging.watching import matching_rows
from logical_robots_tui.game.frame import NoSuchTickError
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import QueryError, Stopped

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Sequence

    from logical_robots_tui.game.advancing import Known
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.packing import Moment
    from logical_robots_tui.mind import Program, Question

__all__ = ["SearchResult", "search_ticks"]

_TOGETHER = 16  # ticks evaluated at once
_ROBOTS = 200  # taken from history at once, so that the event loop is not blocked

_Tick: TypeAlias = "tuple[Moment, Known]"
"""The state after the previous tick, and the tick."""


@dataclass(frozen=True, slots=True)
class SearchResult:
    """The result of a search.

    Attributes:
        tick: The tick that was found, or None.
        last: The last tick that was evaluated.
        holds_here: Whether the question holds in the tick where the search began.
        problem: Why it failed in the first tick in which it did, or "".
    """

    tick: int | None
    last: int
    holds_here: bool
    problem: str = ""


async def search_ticks(
    game: Game,
    query: str,
    way: Literal[-1, 1],
    told: Callable[[int], object] = lambda _tick: None,
) -> SearchResult:
    """Find the nearest tick after or before the current one in which a question holds.

    If it holds in the current tick, the adjacent ticks in which it holds too are skipped. Robots
    sense and reason off the event loop; cancelling the call ends the search.

    Args:
        game: The game; the search starts at its current tick and uses its program.
        query: A call, an expression, conditions, or whole rules of which the last is evaluated.
        way: 1 to search later ticks, -1 to search earlier ones.
        told: Called with the last tick searched; an exception that it raises ends the search.

    Raises:
        ProgramError: The query is wrong.
    """
    program, history, here = game.program, game.history, game.frame.tick
    end = history.last if way > 0 else history.first
    ticks = range(here, end + way, way)
    thinker = Thinker("search")

    def ask(question: Question, some: Sequence[_Tick], stop: threading.Event) -> list[bool | str]:
        answers: list[bool | str] = []
        for before, known in some:
            frame, mind = thinker.replay(program, before, known, game.limits)
            try:
                sensors, memories = frame.sensors, frame.memories_before
                table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
                answers.append(bool(matching_rows(question, table).rows))
            except QueryError as error:
                answers.append(str(error))
            if stop.is_set():
                raise Stopped
        return answers

    problem, holds_here, is_outside, last = "", False, False, here
    try:
        question = await thinker.do(partial(_compiled, game, program, query))
        together = max(1, min(_TOGETHER, _ROBOTS // len(game.level.robots)))
        for at in range(0, len(ticks), together):
            numbers = ticks[at : at + together]
            try:
                some = [(history.around(tick)[0], history.known(tick)) for tick in numbers]
            except NoSuchTickError:  # dropped in the meantime
                break
            for tick, answer in zip(
                numbers, await thinker.do(partial(ask, question, some)), strict=True
            ):
                last = tick
                if isinstance(answer, str):
                    problem = problem or f"Tick {tick}: {answer}"
                holds = answer is True
                if tick == here:
                    holds_here = holds
                elif holds and is_outside:
                    return SearchResult(tick, tick, holds_here, problem)
                is_outside = is_outside or not holds
            told(last)
    finally:
        await thinker.close()
    return SearchResult(None, last, holds_here, problem)


def _compiled(game: Game, program: Program, query: str, stop: threading.Event) -> Question:
    return program.question(query, stop=stop, limits=game.limits)
