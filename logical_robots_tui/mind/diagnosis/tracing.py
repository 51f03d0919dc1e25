"""Queries for everything that a rule does: its parts, its conditions, the functions that it calls.

In the compile process.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.clauses.scopes import (
    EVERY_COLUMN,
    Scope,
    column_name,
    flat,
    in_order,
    names,
)
from logical_robots_tui.mind.clauses.trees import (
    as_expression,
    filled,
    outer_calls,
)
from logical_robots_tui.mind.compiling.rules import equated, operands, value_of, variable_of
from logical_robots_tui.mind.diagnosis.values import ValueTracing, head_value
from logical_robots_tui.mind.diagnosis.watching import At, Segment, Trail
from logical_robots_tui.mind.program import INPUTS, VALUE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.mind.compiling.rules import Rule

_LEAVES = ("desire", VALUE)
"""Columns whose ``if`` branches are watched."""


class Tracer(ValueTracing):
    """Traces rules part by part."""

    def copy(self, name: str) -> None:
        """Trace the rules that ``:=`` copied."""
        _, self._within = self.copies[name]
        for rule in self._own[name]:
            self.rule(rule, tells_robot=False)
        self._within = ""

    def rule(self, rule: Rule, *, tells_robot: bool) -> None:
        """Trace a rule that has rows of its own."""
        columns = {fv["field"]: fv["value"] for fv in rule["head"]["record"]["field_value"]}
        head = {column_name(f): v.get("expression") for f, v in columns.items()}
        parts = flat(rule.get("body"))
        heads = [v.get("expression", v.get("aggregation")) for v in columns.values()]
        variables = frozenset[str]().union(*map(names, [*parts, *heads]))
        number = self._numbers[id(rule)]
        self._memories = set()
        decided = (columns[name].get("expression") or {} for name in _LEAVES if name in columns)
        self._leaves = {*map(variable_of, decided)} - {""}
        at = At(
            Trail(Segment([])),
            number,
            Scope(dict.fromkeys(self._functions, EVERY_COLUMN), variables),
            frozenset(),
            {},
        )
        done = self._parts(parts, at)
        if done is None:
            return
        at = done
        for name, value in columns.items():
            expression = value.get("expression")
            if expression is None:
                self._value(value["aggregation"]["argument"], at)
                continue
            if self._relations(expression):
                local = trees.variable(self._new("head"))
                site = self._site("part", expression, at)
                at = self._next(at, site, trees.equal(local, filled(expression, at.given)))
            is_leaf = name in _LEAVES and "variable" not in expression
            self._value(expression, at, is_leaf=is_leaf)
        who = head.get("robot_name") if tells_robot else None
        self._emit(at.trail, gives=number, who=filled(who, at.given) if who else None)

    def _parts(self, parts: Sequence[Rule], at: At) -> At | None:
        ordered, left = in_order(parts, at.scope, at.known)
        for part, known in ordered:
            at = self._part(part, at, known)
        return None if left else at

    def _part(self, part: Rule, at: At, known: frozenset[str]) -> At:
        if self._is_condition(part, at.known):
            condition = as_expression(part)
            name = str(part.get("predicate", {}).get("predicate_name", ""))
            column = self._truth(condition, at, "denial" if name == "IsNull" else "condition")
            if column < 0:
                return self._next(at, -1, filled(part, at.given))
            at.trail.filters = (*at.trail.filters, column)
            return replace(at.when(column, holds=True), known=known)
        pair = self._bound(part, at.known)
        if pair is not None and not self._relations(pair[1]):
            self._value(pair[1], at, is_leaf=pair[0] in self._leaves)
            self._remember(pair[0], pair[1], at)
            at.trail.segment.body.append(filled(part, at.given))
            return replace(at, known=known)
        call = part.get("predicate", {})
        name = str(call.get("predicate_name", ""))
        if name in self._functions and (inner := self._asked(name, call, at)) is not None:
            rule, within = inner
            done = self._parts(flat(rule.get("body")), within)
            if done is not None:
                return replace(at, guard=done.guard, known=known)
        called = self.copies.get(name, (name, ""))[0]
        site = self._site("part", part, at, predicate=called)
        self._in_part(part, at)
        if name == "Memory":
            for fv in call["record"]["field_value"]:
                variable = variable_of(value_of(fv) or {})
                if fv["field"] in ("memory", 1, "*") and variable:
                    self._memories.add(self._called(variable, at))
                elif fv["field"] in ("memory", 1, "*"):
                    self.reads_all = True
        return replace(self._next(at, site, filled(part, at.given)), known=known)

    def _in_part(self, part: Rule, at: At) -> None:
        """Trace what is inside a part with rows."""
        if "disjunction" in part:
            for branch in part["disjunction"]["disjunct"]:
                self._aside(flat(branch), at, at.scope, at.given, ())
            return
        if "inclusion" in part:
            self._value(part["inclusion"]["list"], at)
            return
        values = equated(part) or (operands(part["predicate"]) if "predicate" in part else ())
        for value in values:
            if at.scope.mentioned(value) <= at.known:
                self._value(value, at)

    def _next(self, at: At, site: int, part: Rule) -> At:
        """Continue after a part with rows."""
        trail = at.trail
        body = [*self._all_of(at), part]
        self._emit(trail, before=site)
        trail.segment = Segment(body, site)
        trail.filters = ()
        return replace(at, guard=())

    def _asked(self, name: str, call: Rule, at: At) -> tuple[Rule, At] | None:
        """Return the only rule of a function that is used as a condition, and a place in it."""
        rules = self._own.get(name, [])
        if len(rules) != 1 or name in at.inside or head_value(rules[0]) is not None:
            return None
        found = self._entered(rules[0], name, call, at)
        return None if found is None else (rules[0], found)

    def _is_condition(self, part: Rule, known: frozenset[str]) -> bool:
        pair = equated(part)
        if pair is not None:
            both = names(pair[0]) | names(pair[1])
            return both <= known and not self._relations(part)
        name = str(part.get("predicate", {}).get("predicate_name", ""))
        is_call = name in self._own or name in INPUTS
        return bool(name) and not is_call and not self._relations(part)

    def _bound(self, part: Rule, known: frozenset[str]) -> tuple[str, Rule] | None:
        """Return the variable that a part binds, and its value; or None."""
        pair = equated(part)
        if pair is None:
            return None
        left, right = pair
        for pattern, value in ((left, right), (right, left)):
            name = variable_of(pattern)
            if name and name not in known and names(value) <= known:
                return name, value
        return None

    def _remember(self, name: str, value: Rule, at: At) -> None:
        if self._is_memory(value, at):
            self._memories.add(self._called(name, at))

    def _relations(self, tree: Any) -> list[Rule]:
        """Yield the calls in a tree of predicates that may have no row, outside aggregates."""
        own = self._own.keys() - self._functions
        return list(outer_calls(tree, own))
