"""Seeking: the nearest tick of a game's history in which a question holds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.game.advancing import Known, known_frame
from logical_robots_tui.game.history import NoSuchTickError
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.game.watching import rows_that_count
from logical_robots_tui.game.worlds import Worlds
from logical_robots_tui.mind import QueryError, Stopped

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Sequence

    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history import History
    from logical_robots_tui.game.packing import Moment
    from logical_robots_tui.mind import Program, Question

__all__ = ["Sought", "seek"]

_TOGETHER = 16  # ticks that are asked at once
_ROBOTS = 200  # that are taken from history at once, so that the event loop is not held up

_Tick: TypeAlias = "tuple[Moment, Known]"
"""What the tick before left behind, and the tick."""


@dataclass(frozen=True, slots=True)
class Sought:
    """How a search ended.

    Attributes:
        tick: The tick that was found, or None.
        last: The last tick that was asked.
        holds_here: Whether the question holds in the tick where the search began.
        trouble: Why it failed in the first tick in which it did, or "".
    """

    tick: int | None
    last: int
    holds_here: bool
    trouble: str = ""


async def seek(
    game: Game,
    query: str,
    way: Literal[-1, 1],
    told: Callable[[int], object] = lambda _tick: None,
) -> Sought:
    """Find the nearest tick after or before the present one in which a question holds.

    If it holds in the present tick, the ticks next to it in which it does, too, are passed over.
    Robots sense and reason off the event loop; cancelling the call ends that.

    Args:
        game: In whose history, from the present tick on, and about whose program.
        query: A call, an expression, conditions, or whole rules of which the last is asked.
        way: 1 to look at later ticks, -1 at earlier ones.
        told: Called meanwhile with the tick up to which was looked; what it raises ends the search.

    Raises:
        ProgramError: The query is wrong.
    """
    program, history, here = game.program, game.history, game.frame.tick
    end = history.last if way > 0 else history.first
    ticks = range(here, end + way, way)
    worlds: list[Worlds] = []
    thinker = Thinker("seek")

    def ask(question: Question, some: Sequence[_Tick], stop: threading.Event) -> list[bool | str]:
        answers: list[bool | str] = []
        for before, known in some:
            if not worlds:
                worlds.append(Worlds(known.level))
            frame = known_frame(worlds[0], before.after, before.memories, known)
            mind = thinker.mind(program, known.level, game.limits)
            try:
                sensors, memories = frame.sensors, frame.memories_before
                table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
                answers.append(bool(rows_that_count(question, table).rows))
            except QueryError as error:
                answers.append(str(error))
            if stop.is_set():
                raise Stopped
        return answers

    trouble, holds_here, is_outside, last = "", False, False, here
    try:
        question = await thinker.do(partial(_compiled, game, program, query))
        together = max(1, min(_TOGETHER, _ROBOTS // len(game.level.robots)))
        for at in range(0, len(ticks), together):
            numbers = ticks[at : at + together]
            try:
                some = [_taken(history, tick) for tick in numbers]
            except NoSuchTickError:  # forgotten meanwhile
                break
            for tick, answer in zip(
                numbers, await thinker.do(partial(ask, question, some)), strict=True
            ):
                last = tick
                if isinstance(answer, str):
                    trouble = trouble or f"Tick {tick}: {answer}"
                holds = answer is True
                if tick == here:
                    holds_here = holds
                elif holds and is_outside:
                    return Sought(tick, tick, holds_here, trouble)
                is_outside = is_outside or not holds
            told(last)
    finally:
        await thinker.close()
    return Sought(None, last, holds_here, trouble)


def _taken(history: History, tick: int) -> _Tick:
    """A tick out of a history.

    Raises:
        NoSuchTickError: The history does not hold it.
    """
    before, moment = history.around(tick)
    return before, Known(history.level_at(tick - bool(moment.decisions)), moment)


def _compiled(game: Game, program: Program, query: str, stop: threading.Event) -> Question:
    return program.question(query, stop=stop, limits=game.limits)
