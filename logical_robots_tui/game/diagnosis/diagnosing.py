"""Diagnosis of a run: observes every rule and condition tick by tick and reports anomalies."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.explain.diagnosis.counting import Tally
from logical_robots_tui.explain.diagnosis.sites import Checkup, check_up
from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.game.advancing import RecordedTick
from logical_robots_tui.game.diagnosis.findings import Observations, findings_of, observe
from logical_robots_tui.game.frame import Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import Limits

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.packing import TickState

_FEWEST = 20  # ticks that are examined
_QUESTIONS = 20_000  # most probes of all robots when only some ticks are examined
_MORE_QUESTIONS = 60_000  # the same when searching the other ticks for what seems never to happen
_TOGETHER = 20  # ticks before settled probes are dropped
_SAMPLES = 12  # ticks in which a robot's movement is explained


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The result of a diagnosis, the most significant finding first.

    Attributes:
        step: The interval, in ticks, at which everything was examined.
        second_step: The interval of the search for what seemed never to happen.
        left_out: How many places could not be observed.
    """

    findings: tuple[Finding, ...]
    first: int
    last: int
    won_at: int | None
    step: int
    second_step: int
    left_out: int
    is_reliable: bool = True


async def diagnose(
    game: Game, *, report: Callable[[int, int], None] = lambda _done, _all: None
) -> Diagnosis:
    """Diagnose the current program over a game's history; cancelling the call stops it.

    `report` gets the work done and the total. Raises QueryError for a program that is too
    complex, Superseded if another future began.
    """
    return await _Diagnosing(game, report).diagnose()


def extent(found: Diagnosis) -> str:
    if found.last < found.first:
        return "There are no ticks to examine yet."
    end = "won" if found.won_at is not None else "not won"
    said = f"Ticks {found.first} to {found.last}, {end}."
    if found.second_step > 1:
        said += f" Only one tick in {found.second_step} was examined: rare events may be missed."
    if found.left_out:
        said += f" Places not covered, because they are too expensive to examine: {found.left_out}."
    if not found.is_reliable:
        said += " A time limit ended a thought: another run may differ."
    return said


class _Diagnosing:
    def __init__(self, game: Game, report: Callable[[int, int], None]) -> None:
        self._game, self._report, self._limits = game, report, Limits()
        self._program = game.program
        self._thinker = Thinker("diagnose")
        self._turns = game.history.turns
        self._done = self._all = 0

    async def diagnose(self) -> Diagnosis:
        history = self._game.history
        began = [begin for begin, program in history.programs(history.last)][-1:]
        first, last = max([1, history.first, *began]), history.last
        if last < first:
            return Diagnosis((), first, last, None, 1, 1, 0)
        try:
            checkup = await self._thinker.do(
                lambda stop: check_up(self._program, stop=stop, limits=self._limits)
            )
            observed = await observe(history, first, last)
            return await self._look(checkup, observed)
        finally:
            await self._thinker.close()

    async def _look(self, checkup: Checkup, observed: Observations) -> Diagnosis:
        ticks = range(observed.first, observed.last + 1)
        robots = len(self._game.level.robots)
        questions = max(1, len(checkup.probes) * robots)
        step = max(1, -(-len(ticks) // max(_FEWEST, _QUESTIONS // questions)))
        sample = list(ticks[::step])
        rest = [tick for tick in ticks if (tick - ticks[0]) % step]
        tally = Tally(checkup)
        self._all = len(ticks)
        second = 1
        for begin in range(0, len(sample), _TOGETHER):
            await self._watch(tally, sample[begin : begin + _TOGETHER], tally.doubtful_probes())
        questions = len(tally.doubtful_probes()) * robots
        second = max(1, -(-len(rest) * questions // _MORE_QUESTIONS))
        chosen = rest[::second]
        self._all = self._done + len(chosen)
        for begin in range(0, len(chosen), _TOGETHER):
            await self._watch(tally, chosen[begin : begin + _TOGETHER], tally.doubtful_probes())
        close = [n for n, probe in enumerate(checkup.probes) if probe.closeness != "wider"]
        closer: dict[tuple[str, int], Tally] = {}
        for robot, wanted in _to_explain(observed):
            tally_of_it = closer[robot, wanted[0]] = Tally(checkup, robot)
            await self._watch(tally_of_it, wanted, close, (robot,))
        is_complete = second == 1
        found = findings_of(tally, observed, closer, self._game.level, is_complete=is_complete)
        return Diagnosis(
            tuple(found),
            observed.first,
            observed.last,
            observed.won_at,
            step,
            second,
            checkup.left_out + len(tally.given_up),
            self._game.history.is_reliable_up_to(observed.last),
        )

    async def _watch(
        self,
        tally: Tally,
        ticks: Sequence[int],
        probes: Sequence[int],
        viewers: tuple[str, ...] | None = None,
    ) -> None:
        names = {tally.checkup.probes[number].name: number for number in probes}
        history = self._game.history
        for tick in ticks if names else ():
            if history.turns != self._turns:
                raise Superseded
            if tick < history.first:
                continue  # it was dropped in the meantime
            before, known = history.replay(tick)
            await self._thinker.do(partial(self._ask, tally, names, before, known, viewers))
            self._done += 1
            self._report(self._done, max(self._all, self._done))

    def _ask(
        self,
        tally: Tally,
        names: Mapping[str, int],
        before: TickState,
        known: RecordedTick,
        viewers: tuple[str, ...] | None,
        stop: threading.Event,
    ) -> None:
        """Evaluate probes by name at a tick, and count the results. Runs in the thread."""
        frame, mind = self._thinker.replay(tally.checkup.program, before, known, self._limits)
        sensors, memories = frame.sensors, frame.memories_before
        for name, rows in mind.each([*names], sensors, memories, viewers=viewers, stop=stop):
            if rows is None:
                tally.give_up(names[name])
            else:
                tally.add(frame.tick, names[name], rows)


def _to_explain(observed: Observations) -> list[tuple[str, list[int]]]:
    wanted: dict[tuple[str, int], list[int]] = {}
    for kind in {kind for kind, _ in observed.notices}:
        tick, robot = observed.first_notice(kind)
        wanted[robot, tick] = [tick]
    for loss in observed.first_losses():
        wanted[loss.robot, loss.tick] = [loss.tick]
    for stretch in observed.stretches:
        length = stretch.period or stretch.last - stretch.first
        last = min(stretch.last, stretch.first + max(length, _SAMPLES))
        step = max(1, (last - stretch.first) // _SAMPLES)
        wanted[stretch.robot, stretch.first] = list(range(stretch.first, last + 1, step))
    return [(robot, ticks) for (robot, _), ticks in wanted.items()]
