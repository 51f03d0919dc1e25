"""The first difference between two proofs of one decision.

Steps are compared before the columns computed from them, and premises before their node, so
that the difference is not merely a consequence of another.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui import explain
from logical_robots_tui.explain import Ask, Explanation, Node, Proof
from logical_robots_tui.game.advancing import RecordedTick, Thinker
from logical_robots_tui.game.frame import Superseded
from logical_robots_tui.mind import Limits, QueryError
from logical_robots_tui.mind.relations import alike

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.explainer import Explainer
    from logical_robots_tui.game.game import Game
    from logical_robots_tui.game.history.branch import Divergence
    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind import Program


_DECISIONS = ("desire", "memory", "notices")


@dataclass(frozen=True, slots=True)
class Comparison:
    """Why a robot decides differently in two branches.

    `condition` holds on one side only, if another rule was chosen; None if unknown.
    """

    robot: str
    differing: ProofDifference | None
    condition: tuple[Node, Side] | None = None


async def compare_proofs(game: Game, divergence: Divergence) -> Comparison | None:
    """Compare proofs for the first robot that decides differently; None if there is none.

    The current branch is "here". Cancelling the call ends the work. Raises NoSuchTickError,
    QueryError if a decision can't be proved, or Superseded.
    """
    robot = next((d.robot_name for d in divergence.differences if d.matter in _DECISIONS), None)
    if robot is None:
        return None
    history, tick = game.history, divergence.tick
    turns = history.turns
    here = _Branch(robot, *history.replay(tick), game.limits)
    there = _Branch(robot, *history.in_other(tick), game.limits)
    programs = history.program_at(tick), history.program_in_other(tick)
    team = game.level.team_of(robot)
    mine, other = ((program or game.program).for_team(team) for program in programs)
    try:
        proofs = await here.proof(mine), await there.proof(other)
        found = first_difference(*proofs, mine.text, other.text)
        condition = None
        if found is not None and found.kind == "rule":
            whys = await here.why(mine, found.asked), await there.why(other, found.asked)
            condition = condition_of(found, *whys)
    finally:
        await here.thinker.close()
        await there.thinker.close()
    if history.turns != turns:
        raise Superseded
    return Comparison(robot, found, condition)


class _Branch:
    """One of the two branches at the compared tick, with the thread that examines it."""

    def __init__(self, robot: str, before: TickState, known: RecordedTick, limits: Limits) -> None:
        self._robot, self._before, self._known, self._limits = robot, before, known, limits
        self.thinker = Thinker("compare")

    async def proof(self, program: Program) -> Proof:
        return await self.thinker.do(lambda stop: self._explainer(program, stop).proof())

    async def why(self, program: Program, asked: Ask) -> Explanation | None:
        try:
            return await self.thinker.do(lambda stop: self._explainer(program, stop).why(asked))
        except QueryError:
            return None

    def _explainer(self, program: Program, stop: threading.Event) -> Explainer:
        frame, mind = self.thinker.replay(program, self._before, self._known, self._limits)
        return explain.Explainer(mind, self._robot, frame.sensors, frame.memories_before, stop=stop)


Side: TypeAlias = Literal["here", "there"]

_DECIDED_AT_ONCE = ("call", "denial")
"""Nodes whose children are about something else where they don't hold."""

_STATED = ("alternative", "call", "condition", "denial", "element", "value")


@dataclass(frozen=True, slots=True)
class ProofDifference:
    """The first difference of two proofs: another rule, a missing step, or only a value.

    `asked` is the row whose derivation differs, with the values that both proofs share.
    """

    kind: Literal["rule", "step", "value"]
    asked: Ask
    here: Node | None
    there: Node | None


def first_difference(
    here: Proof, there: Proof, here_text: str, there_text: str
) -> ProofDifference | None:
    asked = _common_question(here.explanation.asked, there.explanation.asked)
    texts = _in_one_line(here_text), _in_one_line(there_text)
    walks = (_Walk(*texts, values=values) for values in (False, True))
    found = (walk.rules(asked, here.nodes, there.nodes) for walk in walks)
    return next((each for each in found if each is not None), None)


def condition_of(
    differing: ProofDifference, here: Explanation | None, there: Explanation | None
) -> tuple[Node, Side] | None:
    """Return a condition that holds on one side only, and that side; None if it is unknown."""
    stopped = _stop_of(differing.there, here)
    if stopped is not None:
        return stopped, "there"
    stopped = _stop_of(differing.here, there)
    return None if stopped is None else (stopped, "here")


class _Walk:
    def __init__(self, here: str, there: str, *, values: bool) -> None:
        self._here, self._there, self._values = here, there, values

    def rules(
        self, asked: Ask, here: Sequence[Node], there: Sequence[Node]
    ) -> ProofDifference | None:
        others = list(there)
        alone: list[Node] = []
        for node in here:
            same = next((each for each in others if each.text == node.text), None)
            if same is None:
                alone.append(node)
                continue
            others.remove(same)
            if found := self._rule(asked, node, same):
                return found
        mine, other = next(iter(alone), None), next(iter(others), None)
        if mine is None and other is None:
            return None
        if mine is not None and other is not None and self._are_edited(mine, other):
            for walk in (self, _Walk(self._here, self._there, values=True)):
                if (found := walk._rule(asked, mine, other)) is not None:
                    return found
        return ProofDifference("rule", asked, mine, other)

    def _are_edited(self, here: Node, there: Node) -> bool:
        if here.text in self._there or there.text in self._here:
            return False
        mine, other = ([step.text for step in _steps(node)] for node in (here, there))
        return 2 * len(set(mine) & set(other)) >= max(len(mine), len(other), 1)

    def _rule(self, asked: Ask, here: Node, there: Node) -> ProofDifference | None:
        if (found := self._nodes(asked, _steps(here), _steps(there))) is not None:
            return found
        if here.holds != there.holds:
            return ProofDifference("rule", asked, here, there)
        return self._nodes(asked, _columns(here), _columns(there))

    def _nodes(
        self, asked: Ask, here: Sequence[Node], there: Sequence[Node]
    ) -> ProofDifference | None:
        if any(node.kind == "contributor" for node in (*here, *there)):
            return self._contributors(asked, here, there)
        for mine, other in zip(here, there, strict=False):
            if (found := self._pair(asked, mine, other)) is not None:
                return found
        if len(here) == len(there):
            return None
        at = min(len(here), len(there))
        rest = [*here[at : at + 1], *there[at : at + 1]]
        # Steps after a failed one were not evaluated.
        if any(node.holds is False for node in (*here, *there)) and rest[0].holds is not False:
            return None
        return ProofDifference("step", asked, *_sides(here[at : at + 1], there[at : at + 1]))

    def _contributors(
        self, asked: Ask, here: Sequence[Node], there: Sequence[Node]
    ) -> ProofDifference | None:
        """Return the first difference between the contributors to an aggregate, in any order."""
        mine, others = ([n for n in side if n.kind == "contributor"] for side in (here, there))
        alone: list[Node] = []
        for node in mine:
            decide = len(mine) == len(others) == 1
            same = next((o for o in others if decide or _have_same_values(node, o)), None)
            if same is None:
                alone.append(node)
                continue
            others.remove(same)
            if found := self._pair(asked, node, same):
                return found
        if self._values and (alone or others):
            return ProofDifference("step", asked, *_sides(alone, others))
        if only := _only_in(alone, self._there):
            return ProofDifference("rule", only[0], only[1], None)
        if only := _only_in(others, self._here):
            return ProofDifference("rule", only[0], None, only[1])
        return None

    def _pair(self, asked: Ask, here: Node, there: Node) -> ProofDifference | None:
        has_values = here.kind in ("contributor", "note")  # in its text
        if here.kind != there.kind or (here.text != there.text and not has_values):
            return ProofDifference("step", asked, here, there)
        if here.holds != there.holds and here.kind in _DECIDED_AT_ONCE:
            return ProofDifference("step", asked, here, there)
        if (found := self._below(asked, here, there)) is not None:
            return found
        if here.holds != there.holds:
            return ProofDifference("step", asked, here, there)
        if self._values and (here.text != there.text or not _have_same_values(here, there)):
            return ProofDifference("value", asked, here, there)
        return None

    def _below(self, asked: Ask, here: Node, there: Node) -> ProofDifference | None:
        if here.holds is False and here.kind in _DECIDED_AT_ONCE:
            return None
        if here.asked is not None and there.asked is not None:
            called = _common_question(here.asked, there.asked)
            if (found := self.rules(called, _rules(here), _rules(there))) is not None:
                return found
        return self._nodes(asked, _steps(here), _steps(there)) or self._nodes(
            asked, _columns(here), _columns(there)
        )


def _stop_of(rule: Node | None, explanation: Explanation | None) -> Node | None:
    if rule is None or explanation is None:
        return None
    found = (each for each in explanation.rules if each.span.text == rule.text)
    stopped = next((each.stopped_by for each in found), None)
    return stopped if stopped is not None and stopped.kind in _STATED else None


def _only_in(nodes: Sequence[Node], program: str) -> tuple[Ask, Node] | None:
    for node in nodes:
        for _, each in node.walk():
            for rule in _rules(each):
                if each.asked is not None and rule.text not in program:
                    return each.asked, rule
    return None


def _rules(node: Node) -> list[Node]:
    return [child for child in node.children if child.kind == "rule"]


def _steps(node: Node) -> list[Node]:
    return [child for child in node.children if child.kind not in ("rule", "column")]


def _columns(node: Node) -> list[Node]:
    return [child for child in node.children if child.kind == "column"]


def _sides(here: Sequence[Node], there: Sequence[Node]) -> Iterator[Node | None]:
    yield here[0] if here else None
    yield there[0] if there else None


def _common_question(here: Ask, there: Ask) -> Ask:
    """Return a question with only those given values that another one shares."""
    others = there.given
    same = {c: v for c, v in here.given.items() if c in others and alike(v, others[c])}
    return replace(here, given=same)


def _have_same_values(here: Node, there: Node) -> bool:
    return len(here.values) == len(there.values) and all(
        alike(mine, other) for mine, other in zip(here.values, there.values, strict=True)
    )


def _in_one_line(text: str) -> str:
    """Return a program like the texts of its rules: without line ends and comments."""
    lines = (line.split("#")[0] if '"' not in line else line for line in text.split("\n"))
    return " ".join(" ".join(lines).split())
