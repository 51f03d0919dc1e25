"""A whole proof: each node that calls a predicate followed by the proof of that call."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from logical_robots_tui.mind.diagnostics import QueryError
from logical_robots_tui.mind.why.explanation import Explanation, Node

if TYPE_CHECKING:
    from collections.abc import Mapping

    from logical_robots_tui.mind.why.explanation import Ask
    from logical_robots_tui.mind.why.proving import Prover
    from logical_robots_tui.values import Value

__all__ = ["Proof", "unfold"]


@dataclass(frozen=True, slots=True)
class Proof:
    """A row, or that there is none, with all that it follows from.

    Attributes:
        explanation: Of the row itself.
        nodes: The rules of it, unfolded: those that give the row, or all if there is none.
        complete: Whether everything was unfolded.
    """

    explanation: Explanation
    nodes: tuple[Node, ...]
    complete: bool


def unfold(
    prover: Prover,
    predicate: str,
    given: Mapping[str, Value],
    within: str = "",
    *,
    depth: int,
    nodes: int,
) -> Proof:
    """Return the proof of the first row with given values, or why there is none.

    Args:
        prover: Whom to ask.
        predicate: The predicate.
        given: Values of its columns.
        within: The predicate made with ``:=`` in whose copy of the rules it is asked, or "".
        depth: How many predicates deep.
        nodes: Where unfolding ends.

    Raises:
        QueryError: As `Prover.explain` does.
    """
    explanation = prover.explain(predicate, given, within)
    unfolding = _Unfolding(prover, nodes)
    roots = tuple(unfolding.node(node, depth, ()) for node in _proving(explanation))
    return Proof(explanation, roots, unfolding.complete)


class _Unfolding:
    """One proof under way."""

    def __init__(self, prover: Prover, most: int) -> None:
        self._prover, self._left = prover, most
        self._known: dict[str, tuple[Node, ...] | str] = {}
        self.complete = True

    def node(self, node: Node, depth: int, above: tuple[str, ...]) -> Node:
        """Return a node with the calls in it unfolded."""
        self._left -= 1
        children = tuple(self.node(child, depth, above) for child in node.children)
        if node.asked is not None:
            children = (*children, *self._called(node.asked, depth, above))
        return replace(node, children=children)

    def _called(self, asked: Ask, depth: int, above: tuple[str, ...]) -> tuple[Node, ...]:
        """Return the proof of a call."""
        key = json.dumps([asked.predicate, asked.within, asked.given], sort_keys=True)
        if depth <= 1 or self._left <= 0 or key in above:
            self.complete = False
            return ()
        try:
            self._prover.spend(len(key))
        except QueryError as error:
            self.complete = False
            return (Node("note", str(error)),)
        found = self._known.get(key)
        if found is None:
            try:
                explained = self._prover.explain(asked.predicate, asked.given, asked.within)
                found = _proving(explained)
            except QueryError as error:
                found = str(error)
            self._known[key] = found
        if isinstance(found, str):
            return (Node("note", found),)
        return tuple(self.node(each, depth - 1, (*above, key)) for each in found)


def _proving(explanation: Explanation) -> tuple[Node, ...]:
    """Return the rules that give the row; all of them, if there is none."""
    if explanation.row is None:
        return explanation.nodes
    giving = tuple(rule.node for rule in explanation.rules if rule.row is not None)
    if not giving:
        return (explanation.rules[-1].node,)
    # Several rules may contribute to what is aggregated; else one of them is enough.
    is_aggregated = any(child.kind == "aggregate" for child in giving[0].children)
    return giving if is_aggregated else giving[:1]
