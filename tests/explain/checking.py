"""Whether an explanation is true, as an evaluator of another kind has it: whole queries.

What is told of a row is put into its rule: all variables and expressions that are shown are set to
the values that are shown, and the program itself is asked whether its rule holds so.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from logical_robots_tui.explain import ProofNode
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind import Mind, Program, ProgramError
from logical_robots_tui.mind.relations import same
from logical_robots_tui.values import Value
from tests.explain.rules import equal

_BOUND = re.compile(r"(\w+)\s*==?\s")
_OPERATOR = re.compile(r"(\w+|\+)(?:\{| over )")
_FIELD = re.compile(r"^\w+: ")  # of a record that is written out
_MORE = re.compile(r"and ([\d,]+) more")
_EQUATION = re.compile(r"[^=<>!]==?[^=]")
_AT_ONCE = 32  # claims that are compiled together


class Claim(NamedTuple):
    """That some conditions hold together in some way, or in none."""

    conditions: tuple[str, ...]
    made: str  # what is filled in with `:=` where the rule that they are from is a copy, or ""
    is_so: bool
    said: str  # what is false if that is not so


class Checker:
    """Asks a program whether what is claimed holds in the mind of a robot; "" if all are alike."""

    def __init__(
        self, program: Program, mind: Mind, rows: Any, memories: Any, robot: str = ""
    ) -> None:
        self.program, self.mind, self.robot = program, mind, robot
        self.rows_sensed, self.memories = rows, memories
        self.asked = self.unknown = 0
        self._told: set[Claim] = set()
        self.refused: list[tuple[str, str]] = []
        self._known: dict[str, tuple[tuple[Value, ...], ...] | None] = {}

    def false(self, claims: Iterable[Claim]) -> Iterator[str]:
        """What is said in claims that are false. One that can't be asked is left out."""
        by_made: dict[str, list[Claim]] = {}
        for claim in claims:
            if claim not in self._told:
                self._told.add(claim)
                by_made.setdefault(claim.made, []).append(claim)
        for made, together in by_made.items():
            for at in range(0, len(together), _AT_ONCE):
                yield from self._false(together[at : at + _AT_ONCE], made)

    def rows(self, rules: str, made: str) -> tuple[tuple[Value, ...], ...] | None:
        """The rows of rules, or of a copy of them; None if they can't be asked."""
        name = rules.partition("(")[0]
        asked = f"{rules};\nMade := {name}({made})" if made else rules
        if asked not in self._known:
            self._known[asked] = self._ask(asked)
        return self._known[asked]

    def _false(self, claims: Sequence[Claim], made: str) -> Iterator[str]:
        rules = [
            f"Holds(n: {n}) distinct :- {', '.join(each for each in claim.conditions if each)}"
            for n, claim in enumerate(claims)
        ]
        found = self.rows(";\n".join(rules), made)
        if found is None and len(claims) > 1:
            half = len(claims) // 2
            yield from self._false(claims[:half], made)
            yield from self._false(claims[half:], made)
            return
        self.asked += len(claims)
        self.unknown += found is None
        holding = {row[0] for row in found or ()}
        for n, claim in enumerate(claims):
            if found is not None and (n in holding) != claim.is_so:
                yield claim.said

    def _ask(self, asked: str) -> tuple[tuple[Value, ...], ...] | None:
        try:
            table = self.mind.ask(self.program.question(asked), self.rows_sensed, self.memories)
        except (ProgramError, QueryError) as error:
            if " does not use " in str(error):
                return self.rows(asked.partition(";\nMade :=")[0], "")
            self.refused.append((asked, str(error)))
            return None
        return table.in_mind_of(self.robot).rows


def claims_of(node: ProofNode, *, itself: bool = False) -> list[str]:
    """What is claimed of variables and expressions below a node, or by the node, too."""
    found = _claims(replace(node, children=(node,)) if itself else node)
    return [claim for claim in found if claim]


def _claims(node: ProofNode) -> Iterator[str | None]:
    for child in node.children:
        if child.is_rule or child.kind in ("aggregate", "denial", "contributor", "note", "column"):
            if child.kind == "column":
                yield from _claims(child)
            continue
        if len(child.values) == 1:
            text, is_step = child.text, child.span is not None and child.holds
            if is_step and (bound := _BOUND.match(text)):
                text = bound.group(1)
            text = _FIELD.sub("", text)
            if child.span is None or not _EQUATION.search(text):
                yield equal(text, child.values[0])
        elif child.holds is not None and child.kind == "value" and not child.values:
            yield f"({child.text})" if child.holds else None
        yield from _claims(child)


def wrong_aggregates(node: ProofNode) -> Iterator[str]:
    """What is false about the elements of aggregates that are told of a rule."""
    for _, inner in node.walk():
        if len(inner.values) == 1 and any(c.text.startswith("aggregates") for c in inner.children):
            yield from _wrong_aggregate(inner)


def _wrong_aggregate(node: ProofNode) -> Iterator[str]:
    value: Any = node.values[0]
    elements = [n.values[0] for _, n in node.walk() if n.kind == "contributor"]
    note = next((n for n in node.children if n.kind == "note" and "aggregates" in n.text), None)
    if node.remark.endswith("of this rule"):
        return
    if not elements or note is None:
        if elements and not same(elements[0], value):
            yield f"{node.text}: {elements[0]} is said to decide, {value} came out"
        return
    direct = [n for n in note.children if n.kind == "contributor"]
    elements = [n.values[0] for n in direct]
    unseen = sum(int(m[1].replace(",", "")) for n in note.children if (m := _MORE.match(n.text)))
    found = _OPERATOR.search(node.remark or node.text)
    operator = found.group(1) if found else ""
    known = {repr(e) for e in elements if e is not None}
    expected: Any = value
    if operator in ("+", "Sum") and not unseen:  # what is no number counts as 0, but not null
        expected = sum(e for e in elements if isinstance(e, int | float)) if known else None
    elif operator == "List":
        left = Counter(map(repr, value or []))
        left.subtract(map(repr, elements))
        number = left.total()
        is_so = number >= unseen if " or more " in note.text else number == unseen
        expected = value if is_so and min(left.values(), default=0) >= 0 else elements
    elif operator == "Set":
        told = {*map(repr, value or [])}
        expected = value if (known <= told if unseen else known == told) else elements
    elif operator == "Count":
        expected = max(value, len(known)) if unseen else len(known)
    if not same(expected, value):
        yield f"{node.text} = {value}, but goes over {elements} and {unseen} more"
