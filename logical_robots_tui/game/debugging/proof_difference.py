"""Proofs of one decision in two branches, compared line by line."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from difflib import unified_diff
from itertools import islice
from typing import TYPE_CHECKING

from logical_robots_tui import explain
from logical_robots_tui.explain import Proof, ProofNode
from logical_robots_tui.game.advancing import Thinker
from logical_robots_tui.game.frame import Superseded
from logical_robots_tui.values import spell

if TYPE_CHECKING:
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.branch import Divergence

_DECISION = ("desire", "memory", "notices")
_MOST_NODES = 2_000
_LONGEST_VALUE = 160  # characters
_CONTEXT = 2  # equal lines around a difference
_FROM_THE_TOP = ("@@ -1,", "@@ -1 ", "@@ -0,")  # nothing is left out before these lines


@dataclass(frozen=True, slots=True)
class Comparison:
    """The proofs of a robot's decision in two branches.

    Attributes:
        lines: What differs, as in a unified diff: lines of the current branch begin with ``-``,
            those of the other one with ``+``; ``@`` stands where equal lines are left out.
    """

    robot: str
    lines: tuple[str, ...]


async def compare_proofs(game: Game, divergence: Divergence) -> Comparison | None:
    """Compare proofs for the first robot that decides differently; None if there is none.

    Cancelling the call ends the work. Raises NoSuchTickError, QueryError if a decision can't be
    proved, or Superseded.
    """
    robot = next((d.robot_name for d in divergence.differences if d.matter in _DECISION), None)
    if robot is None:
        return None
    history, tick, team = game.history, divergence.tick, game.level.team_of(robot)
    turns = history.turns
    branches = (
        (history.program_at(tick), history.recorded(tick)),
        history.recorded_in_other(tick),
    )
    thinker = Thinker("compare")

    def compare(stop: threading.Event) -> tuple[str, ...]:
        proofs = []
        for program, recorded in branches:
            program_of_team = (program or game.program).for_team(team)
            frame, mind = thinker.replay(program_of_team, recorded, game.limits)
            explainer = explain.Explainer(
                mind, robot, frame.sensors, frame.memories_before, stop=stop
            )
            proofs.append(_lines(explainer.proof(nodes=_MOST_NODES)))
        lines, other_lines = proofs
        difference = islice(unified_diff(lines, other_lines, n=_CONTEXT, lineterm=""), 2, None)
        visible_lines = (line for line in difference if not line.startswith(_FROM_THE_TOP))
        return tuple("@" if line.startswith("@@") else line for line in visible_lines)

    try:
        lines = await thinker.do(compare)
    finally:
        await thinker.close()
    if history.turns != turns:
        raise Superseded
    return Comparison(robot, lines)


def _lines(proof: Proof) -> list[str]:
    return [f"{'  ' * depth}{_line(node)}" for root in proof.nodes for depth, node in root.walk()]


def _line(node: ProofNode) -> str:
    """Return a node's text without its place in the program, which any edit above it moves."""
    if node.holds is False:
        return f"{node.text} does not hold"
    values = " or ".join(spell(value, _LONGEST_VALUE) for value in node.values)
    return f"{node.text} = {values}" if values else node.text
