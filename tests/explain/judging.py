"""Whether a proof is true: each rule that holds, each step that fails, each deciding element."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count
from random import Random
from typing import NamedTuple

from hypothesis import settings

from logical_robots_tui.explain import Ask, ProofNode
from logical_robots_tui.values import Value
from tests.explain.checking import Checker, Claim, claims_of, wrong_aggregates
from tests.explain.rules import Aggregate, Written, aggregates, apart, equal, names, parts, spelled

_VALUED = re.compile(r"^(\w+)\([^()]*\) = ", re.MULTILINE)
_DECIDED = ("Min", "Max", "ArgMin", "ArgMax")
_Fixed = tuple[str, ...]


def judge_until(number: int, judge: Callable[[int], int], first: int = 0) -> None:
    """Judge what is made of one seed after another until so many things were judged.

    `make proof` begins with another seed each time.
    """
    is_same = settings.default is None or settings.default.derandomize
    judged = 0
    for seed in count(first if is_same else Random().randrange(10**9)):
        judged += judge(seed)
        if judged >= number:
            break


def claims_in(
    nodes: Sequence[ProofNode], asked: Ask, checker: Checker, copies: Mapping[str, str]
) -> tuple[list[Claim], list[str]]:
    """What a proof claims, and what is false in it without asking the program.

    `copies` has what is filled in for predicates made with ``:=``.
    """
    judge = _Judge(checker, copies)
    claims = list(judge.answer(nodes, asked))
    return claims, [wrong for rule in judge.giving for wrong in wrong_aggregates(rule)]


def false_of(node: ProofNode, checker: Checker) -> Iterator[str]:
    """What is false about one rule that is said to give a row."""
    fixed = _holding(node)
    if fixed[0]:
        said = f"{node.text} does not hold with {fixed}"
        yield from checker.false([Claim(fixed, "", True, said)])
    yield from wrong_aggregates(node)


class _Judge:
    def __init__(self, checker: Checker, copies: Mapping[str, str]) -> None:
        self._checker, self._copies = checker, copies
        self._valued = {*_VALUED.findall(checker.program.text)}
        self._open = {p.name for p in checker.program.predicates if not p.has_rows}
        self._is_open = False  # whether what is wanted is needed to compute anything
        self.giving: list[ProofNode] = []

    def answer(self, nodes: Sequence[ProofNode], asked: Ask) -> Iterator[Claim]:
        made = self._copies.get(asked.within or asked.predicate, "")
        self._is_open = asked.predicate in self._open
        for node in nodes:
            if node.is_rule:
                for derivation in _derivations(node):
                    yield from self._rule(derivation, asked.given, made)
        for node in nodes:
            yield from self._called(node)

    def _called(self, node: ProofNode) -> Iterator[Claim]:
        if node.query is not None:
            rules = [n for n in node.children if n.is_rule]
            yield from self.answer(rules, node.query)
        for child in node.children:
            if node.query is None or not child.is_rule:
                yield from self._called(child)

    def _rule(self, node: ProofNode, given: Mapping[str, Value], made: str) -> Iterator[Claim]:
        written = parts(node.text)
        wanted = {column: value for column, value in given.items() if column in written.columns}
        known = [equal(written.columns[column], value) for column, value in wanted.items()]
        if node.holds and "but not the " not in node.remark:
            self.giving.append(node)
            fixed = (*_holding(node), *known)
            if any(fixed):
                yield Claim(fixed, made, True, f"{node.text} does not hold with {fixed}")
            yield from self._aggregates(node, written, fixed, made)
            yield from self._denials(node.children, fixed, made)
        elif node.holds is False and written.body:
            if not written.collected:
                said = f"{node.text} is refuted for {given}, but holds"
                # A call in the head that has no row leaves the rule without one.
                rest = [value for name, value in written.columns.items() if name not in wanted]
                others = [f"other{n}_ == {value}" for n, value in enumerate(rest)]
                yield Claim((*known, written.body, *others), made, False, said)
            yield from self._refutation(node.children, (), known, made)

    # -- refutations -----------------------------------------------------------------------------

    def _refutation(
        self, nodes: Sequence[ProofNode], context: tuple[str, ...], known: list[str], made: str
    ) -> Iterator[Claim]:
        """What is claimed of steps that are said to hold, and of the one that is said to fail.

        The context holds around them; what is wanted of variables is known where they are bound.
        """
        for branch in _branches(nodes):
            yield from self._branch(branch, context, known, made)

    def _branch(
        self, branch: _Branch, context: tuple[str, ...], known: list[str], made: str
    ) -> Iterator[Claim]:
        steps = (*context, *map(_step, branch.held))
        told = [claim for node in branch.held for claim in claims_of(node, itself=True)]
        if branch.held:
            yield Claim((*steps, *told), made, True, f"said to hold: {steps} with {told}")
        yield from self._denials(branch.held, (*steps, *told), made)
        for node in branch.failing:
            failing = _step(node)
            if node.kind == "call" and failing.partition("(")[0] in self._valued:
                failing = f"result_ == {failing}"
            bound = {*names(", ".join([*steps, failing]))}
            is_anyhow = node.remark.startswith("no match") and not self._is_open
            here = [] if is_anyhow else [c for c in known if bound.issuperset(names(c))]
            said = f"said to fail: {failing}, after {steps} for {here}"
            yield Claim((*steps, *here, failing), made, False, said)
            if node.kind == "denial" and node.remark == "there is a match":
                there = _step(node).lstrip("~ ")
                claims = [c for n in node.children for c in claims_of(n, itself=True)]
                said = f"said to be there: {there} with {claims}"
                yield Claim((*steps, *told, there, *claims), made, True, said)
            elif node.kind != "alternative":
                yield from self._examples(node, steps, made)

    def _examples(self, node: ProofNode, before: tuple[str, ...], made: str) -> Iterator[Claim]:
        for child in node.children:
            if child.kind not in ("rule", "contributor") and child.span is not None:
                for claim in filter(None, [equal(child.text, value) for value in child.values[:3]]):
                    said = f"said of {node.text}: {claim}, after {before}"
                    yield Claim((*before, claim), made, True, said)

    def _denials(self, nodes: Sequence[ProofNode], fixed: _Fixed, made: str) -> Iterator[Claim]:
        for node in nodes:
            if node.kind == "denial" and node.holds and node.text.startswith("~"):
                yield from self._refutation(node.children, fixed, [], made)
            elif node.kind == "alternative":
                yield from self._denials(node.children, fixed, made)

    # -- aggregates ------------------------------------------------------------------------------

    def _aggregates(
        self, rule: ProofNode, written: Written, fixed: _Fixed, made: str
    ) -> Iterator[Claim]:
        for column in rule.children:
            if column.kind == "aggregate" and column.text in written.collected:
                body = written.body or "1 == 1"
                aggregate = written.collected[column.text]._replace(body=body)
                is_all = not column.remark.endswith("of this rule")
                yield from self._elements(column, aggregate, _row(rule, written), made, is_all)
        for node in _inside(rule):
            for aggregate in aggregates(rule.text):
                if node.text in (aggregate.text, f"({aggregate.text})") and node.values:
                    yield from self._elements(node, apart(aggregate, rule.text), fixed, made)

    def _elements(
        self, node: ProofNode, aggregate: Aggregate, fixed: _Fixed, made: str, is_all: bool = True
    ) -> Iterator[Claim]:
        for child in node.children:
            elements = [child] if child.kind == "contributor" else child.children[:5]
            if child.kind == "note" and "aggregates no rows" in child.text:
                said = f"{aggregate} goes over something"
                yield Claim((*fixed, aggregate.body), made, False, said)
            elif child.kind in ("contributor", "note"):
                for element in elements:
                    if element.kind == "contributor":
                        value = element.values[0]
                        told = (*fixed, aggregate.body, equal(aggregate.value, value))
                        said = f"no element {element.text} = {value}: {told}"
                        yield Claim(told, made, True, said)
            is_decided = child.kind == "contributor" and child.values[0] is not None
            if is_decided and aggregate.operator in _DECIDED and is_all:
                yield from self._best(child, aggregate, fixed, made)

    def _best(
        self, node: ProofNode, aggregate: Aggregate, fixed: _Fixed, made: str
    ) -> Iterator[Claim]:
        """That the element that is said to decide is the best, as the engine orders them."""
        extreme = "Min" if aggregate.operator.endswith("Min") else "Max"
        key = aggregate.by or aggregate.value
        conditions = ", ".join(filter(None, (*fixed, aggregate.body)))
        found = self._checker.rows(f"Best(b? {extreme}= {key}) distinct :- {conditions}", made)
        if not found or found[0][0] is None:
            return
        best = found[0][0]
        told = (*fixed, aggregate.body, equal(aggregate.value, node.values[0]), equal(key, best))
        yield Claim(told, made, True, f"{node.text} = {node.values[0]} decides, not {best}")
        shown = node.text.rpartition(" -> ")[2]
        if aggregate.by and not isinstance(best, float) and shown not in (str(best), spelled(best)):
            yield Claim(("1 == 2",), "", True, f"{node.text} decides, but the best is {best}")


class _Branch(NamedTuple):
    """Steps that are said to hold, and what is said to fail after them."""

    held: list[ProofNode]
    failing: list[ProofNode]


def _branches(nodes: Sequence[ProofNode]) -> Iterator[_Branch]:
    """The ways through a body that are told apart, each with all that is said of it."""
    steps = [node for node in nodes if node.kind not in ("rule", "column", "instance", "note")]
    ended = [at for at, n in enumerate(steps) if n.kind == "alternative" and not n.holds]
    before = steps[: ended[0]] if ended else []
    for at in ended:
        yield _branch([*before, *steps[at].children], steps[at])
    rest = steps[ended[-1] + 1 :] if ended else steps
    if rest:
        yield _branch([*before, *rest])


def _branch(nodes: Sequence[ProofNode], alternative: ProofNode | None = None) -> _Branch:
    held: list[ProofNode] = []
    for node in nodes:
        if node.kind == "alternative" and node.holds:
            held += node.children or [node]
        elif node.holds:
            held.append(node)
    failing = [node for node in nodes if node.holds is False and node.kind != "alternative"]
    if alternative is not None and alternative.holds is False:
        failing.append(alternative)
    return _Branch(held, failing)


def _inside(rule: ProofNode) -> Iterator[ProofNode]:
    """All nodes of a derivation, without those of the rules that it calls."""
    for child in rule.children:
        if not child.is_rule:
            yield child
            yield from _inside(child)


def _derivations(rule: ProofNode) -> Iterator[ProofNode]:
    """The rule with each of the derivations of its row that are shown."""
    others = [child for child in rule.children if child.kind == "derivation"]
    yield replace(rule, children=tuple(n for n in rule.children if n.kind != "derivation"))
    for other in others:
        yield replace(rule, children=other.children)


def _holding(node: ProofNode) -> tuple[str, ...]:
    """What is claimed of a rule that is said to give a row."""
    written = parts(node.text)
    return (written.body, *_row(node, written), *claims_of(node))


def _row(node: ProofNode, written: Written) -> tuple[str, ...]:
    told = [child for child in node.children if child.kind == "column" and child.values]
    return tuple(
        equal(value, child.values[0])
        for column, value in written.columns.items()
        for child in told
        if child.text.partition(": ")[0] in (column, "value" if column == "logica_value" else value)
    )


def _step(node: ProofNode) -> str:
    text = node.span.text if node.span is not None else node.text
    return f"({text})" if node.kind in ("condition", "alternative") else text
