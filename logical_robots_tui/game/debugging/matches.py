"""The ticks in which a question holds: the nearest one in a game, or all of a run."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.game.advancing import RecordedTick, Thinker
from logical_robots_tui.game.debugging.breakpoints import matching_rows
from logical_robots_tui.game.frame import Frame, NoSuchTickError
from logical_robots_tui.mind import QueryError, Stopped
from logical_robots_tui.mind.compilation import Task, find_result, keep_result

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.run import Run
    from logical_robots_tui.mind import CompiledQuery, Mind


@dataclass(frozen=True, slots=True)
class Matches:
    """The ticks of a run in which a question holds: first and last of each stretch.

    `failed` is the same for failures, for the first `reason`. It `is_reliable` unless the clock
    cut off a thought.
    """

    ticks: int
    won_at: int | None
    stretches: tuple[tuple[int, int], ...]
    failed: tuple[tuple[int, int], ...] = ()
    reason: str = ""
    is_reliable: bool = True

    @property
    def holds_in(self) -> int:
        return sum(last - first + 1 for first, last in self.stretches)

    @property
    def failed_in(self) -> int:
        return sum(last - first + 1 for first, last in self.failed)


class _FindMatches(Task, frozen=True):
    run: str
    question: str
    sql: str
    robot: str
    ticks: int


async def find_matches(
    run: Run,
    question: CompiledQuery,
    ticks: int,
    robot: str = "",
    report: Callable[[int], object] = lambda _tick: None,
) -> Matches:
    """Evaluate a question at every tick up to victory, by default for any robot; cached."""
    task = _FindMatches(run.key, question.text, question.sql, robot, ticks)
    if (matches := await asyncio.to_thread(find_result, task, Matches)) is not None:
        return matches

    def ask(frame: Frame, mind: Mind, stop: threading.Event) -> tuple[Frame, bool | str]:
        return frame, _answer(question, frame, mind, stop, robot)

    is_reliable = True
    holds: list[tuple[int, int]] = []
    failed: list[tuple[int, int]] = []
    reason, last, won_at = "", 0, None
    async for frame, answer in run.map_ticks(1, ticks, ask, to_victory=True):
        last, won_at = frame.tick, frame.after.won_at
        is_reliable = is_reliable and frame.is_reliable
        if isinstance(answer, str):
            _add(failed, last)
            reason = reason or answer
        elif answer:
            _add(holds, last)
        report(last)
    matches = Matches(last, won_at, tuple(holds), tuple(failed), reason, is_reliable)
    if is_reliable and run.is_reliable_up_to(last) and not failed:  # or it may have lacked time
        await asyncio.to_thread(keep_result, task, matches)
    return matches


def _answer(
    question: CompiledQuery, frame: Frame, mind: Mind, stop: threading.Event, robot: str = ""
) -> bool | str:
    sensors, memories = frame.sensors, frame.memories_before
    try:
        table = mind.ask(question, sensors, memories, stop=stop, in_order=False)
    except QueryError as error:
        return str(error)
    return bool(matching_rows(question, table, robot).rows)


def _add(stretches: list[tuple[int, int]], tick: int) -> None:
    if stretches and stretches[-1][1] == tick - 1:
        stretches[-1] = (stretches[-1][0], tick)
    else:
        stretches.append((tick, tick))


_TOGETHER = 16  # ticks evaluated at once
_ROBOTS = 200  # taken from history at once, so that the event loop is not blocked


@dataclass(frozen=True, slots=True)
class SearchResult:
    """The result of a search.

    `problem` is the reason for the first failure, or "".
    """

    tick: int | None
    last: int
    holds_here: bool
    problem: str = ""


async def search_ticks(
    game: Game,
    query: str,
    direction: Literal[-1, 1],
    report: Callable[[int], object] = lambda _tick: None,
) -> SearchResult:
    """Find the nearest later (`direction` is 1) or earlier (-1) tick in which a question holds.

    Adjacent ticks are skipped if it holds now. `report` gets each searched tick, and may end the
    search with an exception. Raises ProgramError for a wrong query.
    """
    program, history, start = game.program, game.history, game.frame.tick
    end = history.last if direction > 0 else history.first
    ticks = range(start, end + direction, direction)
    thinker = Thinker("search")

    def ask(
        question: CompiledQuery, batch: Sequence[RecordedTick], stop: threading.Event
    ) -> list[bool | str]:
        answers: list[bool | str] = []
        for recorded in batch:
            frame, mind = thinker.replay(program, recorded, game.limits)
            answers.append(_answer(question, frame, mind, stop))
            if stop.is_set():
                raise Stopped
        return answers

    problem, holds_here, is_outside, last = "", False, False, start
    try:
        question = await thinker.do(
            lambda stop: program.question(query, stop=stop, limits=game.limits)
        )
        size = max(1, min(_TOGETHER, _ROBOTS // len(game.level.robots)))
        for offset in range(0, len(ticks), size):
            batch_ticks = ticks[offset : offset + size]
            try:
                batch = [history.recorded(tick) for tick in batch_ticks]
            except NoSuchTickError:  # dropped in the meantime
                break
            answers = await thinker.do(partial(ask, question, batch))
            for tick, answer in zip(batch_ticks, answers, strict=True):
                last = tick
                if isinstance(answer, str):
                    problem = problem or f"Tick {tick}: {answer}"
                holds = answer is True
                if tick == start:
                    holds_here = holds
                elif holds and is_outside:
                    return SearchResult(tick, tick, holds_here, problem)
                is_outside = is_outside or not holds
            report(last)
    finally:
        await thinker.close()
    return SearchResult(None, last, holds_here, problem)
