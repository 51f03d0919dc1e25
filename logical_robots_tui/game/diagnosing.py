"""Diagnosis of a run: every rule and condition watched tick by tick, and what stands out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from logical_robots_tui.game.findings import findings_of
from logical_robots_tui.game.game import Superseded
from logical_robots_tui.game.happenings import happenings
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import Limits
from logical_robots_tui.mind.diagnosis.counting import Tally
from logical_robots_tui.mind.diagnosis.sites import check_up

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.game.frame import Frame
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.happenings import Happenings
    from logical_robots_tui.mind.diagnosis.finding import Finding
    from logical_robots_tui.mind.diagnosis.sites import Checkup
    from logical_robots_tui.world import Level

__all__ = ["Diagnosis", "diagnose", "extent"]

_FEWEST = 20  # ticks that are looked at
_QUESTIONS = 20_000  # that all robots are asked at most when some ticks are looked at
_MORE_QUESTIONS = 60_000  # when what seems never to happen is looked for in the others
_TOGETHER = 20  # ticks, before what is settled is no longer asked
_SAMPLES = 12  # ticks in which a robot's way is explained


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """What was found in a run.

    Attributes:
        findings: The most telling first.
        first: The first tick of the run.
        last: The last one.
        won_at: The tick of victory, or None.
        step: Every how many ticks all was looked at.
        second_step: Every how many ticks was looked for what seemed never to happen.
        left_out: How many places could not be watched.
    """

    findings: tuple[Finding, ...]
    first: int
    last: int
    won_at: int | None
    step: int
    second_step: int
    left_out: int


async def diagnose(
    game: Game,
    *,
    report: Callable[[int, int], None] = lambda _done, _all: None,
    limits: Limits | None = None,
) -> Diagnosis:
    """Diagnose what a game's history holds of its present program. Cancel it to stop it.

    Args:
        game: The game; it may go on meanwhile.
        report: Called with how much is done and how much there is to do.
        limits: Bounds on compiling and thinking.

    Raises:
        QueryError: The program is too entangled.
        Superseded: Another future began meanwhile.
    """
    return await _Diagnosing(game, report, limits or Limits()).diagnose()


def extent(found: Diagnosis) -> str:
    """What was looked at, one or two sentences."""
    if found.last < found.first:
        return "There are no ticks to look at yet."
    end = "won" if found.won_at is not None else "not won"
    said = f"Ticks {found.first} to {found.last}, {end}."
    if found.second_step > 1:
        said += f" Looked at every {found.second_step}. tick: what is rarer may be missed."
    if found.left_out:
        said += f" Of {found.left_out} places too much was to be asked: nothing is said of them."
    return said


class _Diagnosing:
    """One diagnosis."""

    def __init__(self, game: Game, report: Callable[[int, int], None], limits: Limits) -> None:
        self._game, self._report, self._limits = game, report, limits
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
            happened = await happenings(history, first, last)
            return await self._look(checkup, happened)
        finally:
            await self._thinker.close()

    # -- inside --------------------------------------------------------------------------------

    async def _look(self, checkup: Checkup, happened: Happenings) -> Diagnosis:
        ticks = range(happened.first, happened.last + 1)
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
        for robot, wanted in _to_explain(happened):
            tally_of_it = closer[robot, wanted[0]] = Tally(checkup)
            await self._watch(tally_of_it, wanted, close, (robot,))
        found = findings_of(tally, happened, closer, self._game.level)
        return Diagnosis(
            tuple(found),
            happened.first,
            happened.last,
            happened.won_at,
            step,
            second,
            checkup.left_out + len(tally.given_up),
        )

    async def _watch(
        self,
        tally: Tally,
        ticks: Sequence[int],
        probes: Sequence[int],
        viewers: tuple[str, ...] | None = None,
    ) -> None:
        """Ask probes at some ticks."""
        names = {tally.checkup.probes[number].name: number for number in probes}
        for tick in ticks if names else ():
            if self._game.history.turns != self._turns:
                raise Superseded
            if tick < self._game.history.first:
                continue  # it was forgotten meanwhile
            frame = self._game.frame_at(tick)
            level = self._game.history.level_at(tick)
            await self._thinker.do(partial(self._ask, tally, names, frame, level, viewers))
            self._done += 1
            self._report(self._done, max(self._all, self._done))

    def _ask(
        self,
        tally: Tally,
        names: Mapping[str, int],
        frame: Frame,
        level: Level,
        viewers: tuple[str, ...] | None,
        stop: threading.Event,
    ) -> None:
        """Ask the probes of these names at a frame, and count what they give. In the thread."""
        mind = self._thinker.mind(tally.checkup.program, level, self._limits)
        sensors, memories = frame.sensors, frame.memories_before
        for name, rows in mind.each([*names], sensors, memories, viewers=viewers, stop=stop):
            if rows is None:
                tally.give_up(names[name])
            else:
                tally.add(frame.tick, names[name], rows)


def _to_explain(happened: Happenings) -> list[tuple[str, list[int]]]:
    """Robots, and the ticks in which what they do is to be looked at closely."""
    wanted: dict[tuple[str, int], list[int]] = {}
    for kind in {kind for kind, _ in happened.notices}:
        tick, robot = happened.first_notice(kind)
        wanted[robot, tick] = [tick]
    for loss in happened.first_losses():
        wanted[loss.robot, loss.tick] = [loss.tick]
    for stretch in happened.stretches:
        length = stretch.period or stretch.last - stretch.first
        last = min(stretch.last, stretch.first + max(length, _SAMPLES))
        step = max(1, (last - stretch.first) // _SAMPLES)
        wanted[stretch.robot, stretch.first] = list(range(stretch.first, last + 1, step))
    return [(robot, ticks) for (robot, _), ticks in wanted.items()]
