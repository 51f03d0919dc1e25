"""Comparing proofs: the first derivation that differs where two courses of a game diverge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from logical_robots_tui import explain
from logical_robots_tui.game.debugging.proof_difference import condition_of, first_difference
from logical_robots_tui.game.frame import Superseded
from logical_robots_tui.game.thinker import Thinker
from logical_robots_tui.mind import QueryError

if TYPE_CHECKING:
    import threading

    from logical_robots_tui.explain import Ask, Explanation, Node, Proof
    from logical_robots_tui.explain.why.explainer import Explainer
    from logical_robots_tui.game.advancing import RecordedTick
    from logical_robots_tui.game.debugging.proof_difference import ProofDifference, Side
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.divergence import Divergence
    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind import Limits, Program

_DECISIONS = ("desire", "memory", "notices")


@dataclass(frozen=True, slots=True)
class Comparison:
    """Why a robot decides differently in two courses.

    `condition` holds on one side only, if another rule was chosen; None if unknown.
    """

    robot: str
    differing: ProofDifference | None
    condition: tuple[Node, Side] | None = None


async def compare_proofs(game: Game, divergence: Divergence) -> Comparison | None:
    """Compare proofs for the first robot that decides differently; None if there is none.

    The current course is "here". Cancelling the call ends the work. Raises NoSuchTickError,
    QueryError if a decision can't be proved, or Superseded.
    """
    robot = next((d.robot_name for d in divergence.differences if d.matter in _DECISIONS), None)
    if robot is None:
        return None
    history, tick = game.history, divergence.tick
    turns = history.turns
    here = _Course(robot, *history.replay(tick), game.limits)
    there = _Course(robot, *history.in_other(tick), game.limits)
    programs = history.program_at(tick), history.program_in_other(tick)
    team = game.level.team_of(robot)
    mine, other = ((program or game.program).for_team(team) for program in programs)
    try:
        proofs = await here.proof(mine), await there.proof(other)
        found = first_difference(*proofs, mine.text, other.text)
        condition = None
        if found is not None and found.kind == "rule":
            asked = found.asked
            condition = condition_of(
                found, await here.why(mine, asked), await there.why(other, asked)
            )
    finally:
        await here.close()
        await there.close()
    if history.turns != turns:
        raise Superseded
    return Comparison(robot, found, condition)


class _Course:
    """One of the two courses at the compared tick, with the thread that examines it."""

    def __init__(self, robot: str, before: TickState, known: RecordedTick, limits: Limits) -> None:
        self._robot, self._before, self._known, self._limits = robot, before, known, limits
        self._thinker = Thinker("compare")

    async def proof(self, program: Program) -> Proof:
        return await self._thinker.do(lambda stop: self._explainer(program, stop).proof())

    async def why(self, program: Program, asked: Ask) -> Explanation | None:
        try:
            return await self._thinker.do(lambda stop: self._explainer(program, stop).why(asked))
        except QueryError:
            return None

    async def close(self) -> None:
        await self._thinker.close()

    def _explainer(self, program: Program, stop: threading.Event) -> Explainer:
        frame, mind = self._thinker.replay(program, self._before, self._known, self._limits)
        return explain.Explainer(mind, self._robot, frame.sensors, frame.memories_before, stop=stop)
