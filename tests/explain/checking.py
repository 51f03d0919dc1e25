"""Whether an explanation is true, as an evaluator of another kind has it: whole queries.

What is told of a row is put into its rule: all variables and expressions that are shown are set to
the values that are shown, and the program itself is asked whether its rule holds so.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.mind.relations import same

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.explain import Node
    from logical_robots_tui.mind import Mind

__all__ = ["Checker", "equal", "false_claims", "head_columns"]

_BOUND = re.compile(r"(\w+)\s*==?\s")
_OPERATOR = re.compile(r"(\w+|\+)(?:\{| over )")
_FIELD = re.compile(r"^\w+: ")  # of a record that is written out
_MORE = re.compile(r"and ([\d,]+) more")
_EQUATION = re.compile(r"[^=<>!]==?[^=]")


class Checker:
    """Asks a program whether what is claimed holds.

    Args:
        program: The program.
        mind: A mind with it.
        rows: Sensor rows.
        memories: By robot.
    """

    def __init__(self, program: Program, mind: Mind, rows: Any, memories: Any) -> None:
        self.program, self.mind = program, mind
        self.rows, self.memories = rows, memories
        self.asked = self.unknown = 0
        self._known: dict[tuple[str, str], bool | None] = {}

    def holds(self, conditions: Sequence[str], made: str) -> bool | None:
        """Whether there is a way in which all of some conditions hold; None if none can say.

        Args:
            conditions: The conditions.
            made: What is filled in with ``:=`` where the rule that they are from is a copy, or "".
        """
        rule = f"Holds(one: 1) :- {', '.join(conditions)}"
        if (rule, made) not in self._known:
            self._known[rule, made] = self._ask(rule, made)
        return self._known[rule, made]

    def _ask(self, rule: str, made: str) -> bool | None:
        self.asked += 1
        for asked in (rule, f"{rule};\nMade := Holds({made})") if made else (rule,):
            try:
                question = self.program.question(asked)
            except ProgramError:
                self.unknown += 1
                return None
            if self.mind.ask(question, self.rows, self.memories).rows:
                return True
        return False


def false_claims(node: Node, checker: Checker, made: str = "") -> Iterator[str]:
    """What is false about a rule that is said to give a row."""
    rule = node.text
    head, _, body = rule.partition(":-")
    if not body:
        return  # a fact, which was compared with the row
    claims = [*_claims(node)]
    fixed = [body.strip()]
    fixed += [claim for claim in claims if claim is not None]
    for column, expression in head_columns(head):
        values = [n.values[0] for n in node.children if _names(n, column) and n.values]
        fixed += [claim for value in values[:1] if (claim := equal(expression, value))]
    if checker.holds(fixed, made) is False:
        yield f"{rule} does not hold with {fixed}"
    for _, inner in node.walk():
        if len(inner.values) == 1 and any(c.text.startswith("goes over") for c in inner.children):
            yield from _wrong_aggregate(inner)


def _claims(node: Node) -> Iterator[str | None]:
    """What is claimed of the variables and expressions of one derivation."""
    for child in node.children:
        if child.kind in ("aggregate", "denial", "contributor", "rule", "note", "column"):
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


def equal(expression: str, value: Any) -> str | None:
    if value is None:
        return f"({expression}) is null"
    if isinstance(value, float) and not value.is_integer():  # a sum depends on the order of rows
        return f"Abs(({expression}) - ({value!r})) < {max(1, abs(value)) * 1e-12!r}"
    if isinstance(value, bool | int | float | str):
        return f"({expression}) == {json.dumps(value)}"
    return None


def head_columns(head: str) -> Iterator[tuple[str, str]]:
    """Columns of a head of the generated kind that are not aggregated, and their expressions."""
    found = re.match(r"\w+\(x: (.*), y: (.*)\)(?: distinct)?\s*$", head.strip())
    if found:
        yield "x", found.group(1)
        yield "y", found.group(2)
    elif found := re.match(r"\w+\(x: (.*), y\?", head.strip()):
        yield "x", found.group(1)


def _names(node: Node, column: str) -> bool:
    return node.kind == "column" and (node.text == column or node.text.startswith(f"{column}: "))


def _wrong_aggregate(node: Node) -> Iterator[str]:
    """What is false about the elements of an aggregate."""
    value: Any = node.values[0]
    elements = [n.values[0] for _, n in node.walk() if n.kind == "contributor"]
    note = next((n for n in node.children if n.kind == "note" and "goes over" in n.text), None)
    if node.said.endswith("of this rule"):
        return
    if not elements or note is None:
        if elements and not same(elements[0], value):
            yield f"{node.text}: {elements[0]} is said to decide, {value} came out"
        return
    direct = [n for n in note.children if n.kind == "contributor"]
    elements = [n.values[0] for n in direct]
    unseen = sum(int(m[1].replace(",", "")) for n in note.children if (m := _MORE.match(n.text)))
    found = _OPERATOR.search(node.said or node.text)
    operator = found.group(1) if found else ""
    numbers = [e for e in elements if isinstance(e, int | float)]
    known = {repr(e) for e in elements if e is not None}
    expected: Any = value
    if operator in ("+", "Sum"):
        # What is no number counts as 0; only null is left out.
        expected = sum(numbers) if any(e is not None for e in elements) else None
        expected = value if unseen else expected
    elif operator in ("List",):
        left = Counter(map(repr, value or []))
        left.subtract(map(repr, elements))
        number = left.total()
        is_so = number >= unseen if " or more " in note.text else number == unseen
        expected = value if is_so and min(left.values(), default=0) >= 0 else elements
    elif operator in ("Set",):
        told = {*map(repr, value or [])}
        expected = value if (known <= told if unseen else known == told) else elements
    elif operator in ("Count",):
        expected = max(value, len(known)) if unseen else len(known)
    if not same(expected, value):
        yield f"{node.text} = {value}, but goes over {elements} and {unseen} more"
