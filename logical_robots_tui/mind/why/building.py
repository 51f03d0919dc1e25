"""Taking rules apart: a query for every beginning of a rule's body. In the compile process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.mind.compiling.rules import VALUE, value_of
from logical_robots_tui.mind.program import INPUTS
from logical_robots_tui.mind.why import sides, trees
from logical_robots_tui.mind.why.probing import (
    GIVEN,
    Call,
    Inside,
    Part,
    Query,
    RuleParts,
    Side,
    Span,
)
from logical_robots_tui.mind.why.scopes import Scope, combines, flat, in_order, names
from logical_robots_tui.mind.why.spans import span_of

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping, Sequence

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.text import Prepared

__all__ = ["PROBE", "Builder"]

PROBE = "WhyProbe"
"""What the names of the predicates begin with that are made to be asked."""

_LOCAL = "why_"
_DEEPEST = 4  # parts within parts

Kind = Literal["call", "condition", "value", "element", "choice", "denial", "head"]


@dataclass(frozen=True, slots=True)
class _Step:
    """A part that is to be asked.

    Attributes:
        kind: As `Part` has it.
        tree: The part.
        known: The variables that have a value before it.
        after: The variables that have a value after it.
        shown: The piece of the syntax tree to show for it.
    """

    kind: Kind
    tree: Rule
    known: frozenset[str]
    after: frozenset[str]
    shown: Any


class Builder:
    """Takes rules apart and collects the predicates to be compiled for that.

    In place of SQL its queries have the names of these predicates.

    Args:
        text: The program.
        source: The same, prepared.
        own: Names of the program's own predicates.
        functions: Names of those that have rows only for given arguments.

    Attributes:
        probes: The rules of these predicates, by their names.
    """

    def __init__(
        self, text: str, source: Prepared, own: Container[str], functions: frozenset[str]
    ) -> None:
        self.probes: dict[str, Rule] = {}
        self._text, self._source = text, source
        self._own, self._functions = own, functions

    def rule(self, rule: Rule, *, is_function: bool) -> RuleParts:
        """Take a rule apart.

        Args:
            rule: As it was parsed.
            is_function: Whether its arguments have to be given.
        """
        head, body = _head(rule), flat(rule.get("body"))
        scope = self._scope(head, body)
        begin: list[Rule] = []
        checks: list[Rule] = []
        known: frozenset[str] = frozenset()
        if is_function:
            begin, checks, known = _arguments(head)
        steps = self._steps([*checks, *body], scope, known)
        known_last = steps[-1].after if steps else known
        row = {**head, **_collected(rule)}
        for column, value in head.items():
            if sides.has_conditions(value) or self._may_fail(value):
                row[column] = trees.variable(f"{_LOCAL}head_{column}")
                bound = trees.equal(row[column], value)
                steps.append(_Step("head", bound, known_last, known_last, value))
        start, parts = self._parts(steps, begin, known, scope, head, [*row.values()], 0)
        return RuleParts(self._span(rule), start, parts, tuple(row))

    def needs_given(self, rule: Rule) -> bool:
        """Whether a rule gives rows only when values are given for columns of its head."""
        head, body = _head(rule), flat(rule.get("body"))
        ordered, left = in_order(body, self._scope(head, body), frozenset())
        known = ordered[-1][1] if ordered else frozenset[str]()
        return bool(left) or not all(names(value) <= known for value in head.values())

    # -- inside --------------------------------------------------------------------------------

    def _scope(self, head: Mapping[str, Rule], body: Sequence[Rule]) -> Scope:
        """The scope of a rule."""
        variables = frozenset[str]().union(*map(names, [*body, *head.values()]))
        return Scope(self._functions, variables)

    def _steps(self, body: Sequence[Rule], scope: Scope, known: frozenset[str]) -> list[_Step]:
        """The parts of a body in an order in which they can be asked."""
        steps = []
        ordered, left = in_order(body, scope, known)
        for part, after in ordered:
            steps.append(_Step(self._kind(part), part, known, after, part))
            known = after
        if left:
            together = {"conjunction": {"conjunct": left}}
            steps.append(_Step("condition", together, known, scope.variables, left))
        return steps

    def _parts(
        self,
        steps: Sequence[_Step],
        begin: Sequence[Rule],
        known: frozenset[str],
        scope: Scope,
        head: Mapping[str, Rule],
        last: Sequence[Rule],
        depth: int,
    ) -> tuple[Query, tuple[Part, ...]]:
        """The query before the first part, and the parts with theirs.

        Args:
            steps: The parts.
            begin: What is asked before them.
            known: The variables that have a value before them.
            scope: Where they stand.
            head: The columns whose values are to be known.
            last: Expressions whose values are to be told when all parts hold.
            depth: How deep within other parts this is.
        """
        told = [self._told(step) for step in steps]
        told.append([(each, False) for each in last])
        body = list(begin)
        start = self._query(body, known, told[0], head)
        parts = []
        for number, step in enumerate(steps):
            inside = self._inside(step, body, scope, head, depth) if depth < _DEEPEST else ()
            body = [*body, step.tree]
            query = self._query(body, step.after, told[number + 1], head)
            calls = self._calls(step, told[number])
            parts.append(Part(step.kind, self._span(step.shown), query, calls, inside))
        return start, tuple(parts)

    def _query(
        self,
        body: Sequence[Rule],
        known: Iterable[str],
        told: Sequence[tuple[Rule, bool]],
        head: Mapping[str, Rule],
    ) -> Query:
        """A query for the ways in which all of a body holds; its SQL is to be compiled."""
        variables = sorted(known)
        values = [trees.variable(name) for name in variables] + [value for value, _ in told]
        columns: dict[str | int, Rule] = {f"c{i}": value for i, value in enumerate(values)}
        known_head = {c: value for c, value in head.items() if names(value) <= frozenset(variables)}
        places: dict[str, str] = {}
        for column, value in known_head.items():
            if not (any(combines(value)) or self._may_fail(value)):
                places[column] = f"h{len(places)}"
                columns[places[column]] = value
        columns["one"] = trees.number("1")
        name = f"{PROBE}{len(self.probes)}"
        self.probes[name] = trees.rule(name, columns, body, name)
        shown = tuple(name.replace(_LOCAL, "") for name in variables)
        texts = tuple(Side(self._span(value).text, truth) for value, truth in told)
        return Query(name, shown, texts, places)

    def _inside(
        self,
        step: _Step,
        body: Sequence[Rule],
        scope: Scope,
        head: Mapping[str, Rule],
        depth: int,
    ) -> tuple[Inside, ...]:
        """The parts that stand within a part."""
        found = []
        if "disjunction" in step.tree:
            for branch in step.tree["disjunction"]["disjunct"]:
                steps = self._steps(flat(branch), scope, step.known)
                start, parts = self._parts(steps, body, step.known, scope, head, (), depth + 1)
                found.append(Inside("either", self._span(branch), start, parts))
            return tuple(found)
        for combine in combines(step.tree):
            inner = flat(combine.get("body"))
            if not inner:
                continue
            span = self._span(combine["full_text"])
            local = names([combine["head"], *inner], inside=True) - scope.variables
            new = {name: f"{_LOCAL}{name}" for name in local}
            inner, outer = trees.renamed(inner, new), trees.renamed(combine["head"], new)
            within = scope.within(inner)
            steps = self._steps(inner, within, step.known)
            is_denied = step.kind == "denial"
            last = [] if is_denied else [*_collected({"head": outer}).values()]
            start, parts = self._parts(steps, body, step.known, within, head, last, depth + 1)
            found.append(Inside("denied" if is_denied else "collected", span, start, parts))
        return tuple(found)

    def _told(self, step: _Step) -> list[tuple[Rule, bool]]:
        """Expressions whose values before a part tell why it holds or not."""
        tree = step.tree
        found = [] if "disjunction" in tree else list(sides.compared(tree))
        for call in sides.outer_calls(tree, self._own):
            found += [(value, False) for _, value in sides.asks(call)]
        kept: dict[str, tuple[Rule, bool]] = {}
        for value, is_truth in found:
            if names(value) <= step.known:
                text = self._span(value).text
                if self._may_fail(value):
                    value = trees.any_value(value, f"{_LOCAL}side_{len(kept)}")
                kept.setdefault(text, (value, is_truth))
        return list(kept.values())

    def _calls(self, step: _Step, told: Sequence[tuple[Rule, bool]]) -> tuple[Call, ...]:
        numbers = {self._span(value).text: number for number, (value, _) in enumerate(told)}
        found = []
        for call in sides.outer_calls(step.tree, self._own):
            given = ((column, self._span(value).text) for column, value in sides.asks(call))
            arguments = {column: numbers[text] for column, text in given if text in numbers}
            found.append(Call(str(call["predicate_name"]), arguments))
        return tuple(found)

    def _kind(self, part: Rule) -> Kind:
        if "disjunction" in part:
            return "choice"
        if "inclusion" in part:
            return "element"
        if "unification" in part:
            return "value"
        name = str(part.get("predicate", {}).get("predicate_name", ""))
        if name == "=":
            return "value"
        if name == "IsNull" and any(map(_is_denial, combines(part))):
            return "denial"
        return "call" if name in self._own or name in INPUTS else "condition"

    def _may_fail(self, value: Rule) -> bool:
        return any(sides.outer_calls(value, self._own))

    def _span(self, tree: Any) -> Span:
        return span_of(tree, self._text, self._source)


def _head(rule: Rule) -> dict[str, Rule]:
    """The columns of a rule's head that are not aggregated, and their expressions."""
    columns = rule["head"]["record"]["field_value"]
    found = {sides.column_name(c["field"]): value_of(c) for c in columns if c["field"] != "*"}
    return {name: value for name, value in found.items() if value is not None}


def _collected(rule: Rule) -> dict[str, Rule]:
    """The columns of a rule's head that are aggregated, and what goes into them."""
    columns = rule["head"]["record"]["field_value"]
    found = {
        sides.column_name(c["field"]): c["value"].get("aggregation", {}).get("argument")
        for c in columns
    }
    return {name: value for name, value in found.items() if value is not None}


def _arguments(head: Mapping[str, Rule]) -> tuple[list[Rule], list[Rule], frozenset[str]]:
    """The call for given arguments, what they must be equal to, and the variables they give."""
    columns: dict[str | int, Rule] = {}
    checks = []
    for column, value in head.items():
        if column == VALUE:
            continue
        if "variable" in value:
            columns[column] = value
        else:
            columns[column] = trees.variable(f"{_LOCAL}given_{column}")
            checks.append(trees.equal(columns[column], value))
    known = frozenset(str(each["variable"]["var_name"]) for each in columns.values())
    return [trees.asked(GIVEN, columns)] if columns else [], checks, known


def _is_denial(combine: Rule) -> bool:
    """Whether this is how the package writes that something has no rows."""
    (column,) = combine["head"]["record"]["field_value"]
    argument = column["value"].get("aggregation", {}).get("argument", {})
    literal = argument.get("literal", {}).get("the_number", {}).get("number")
    return literal == "1" and not hasattr(literal, "heritage")
