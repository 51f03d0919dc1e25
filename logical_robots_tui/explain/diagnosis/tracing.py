"""Queries for everything that a rule does: its parts, conditions, and called functions."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logical_robots_tui.explain.clauses.scopes import EVERY_COLUMN, Scope, in_order
from logical_robots_tui.explain.clauses.trees import as_expression, outer_calls
from logical_robots_tui.explain.diagnosis.values import ValueTracing
from logical_robots_tui.explain.diagnosis.watching import At, Segment, Trail
from logical_robots_tui.language.tree import (
    REST,
    Aggregation,
    Atom,
    Disjunction,
    Equation,
    Membership,
    Variable,
    conjuncts,
    equated,
    operands,
    substitute,
    variable_of,
    variables,
)
from logical_robots_tui.schema import INPUTS, VALUE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from logical_robots_tui.language.tree import Call, Expression, Proposition, Rule, Tree

_LEAVES = ("desire", VALUE)
"""Columns whose ``if`` branches are watched."""


class Tracer(ValueTracing):
    def copy(self, name: str) -> None:
        _, self._within = self.copies[name]
        for rule in self._own[name]:
            self.rule(rule, tells_robot=False)
        self._within = ""

    def rule(self, rule: Rule, *, tells_robot: bool) -> None:
        columns = rule.head.columns
        parts = conjuncts(rule.body)
        number = self._numbers[id(rule)]
        self._memories = set()
        leaves = [column for column in columns if column.field in _LEAVES]
        self._leaves = {variable_of(column.expression) for column in leaves} - {""}
        scope = Scope(dict.fromkeys(self._functions, EVERY_COLUMN), variables([*parts, rule.head]))
        done = self._parts(parts, At(Trail(Segment([])), number, scope, frozenset(), {}))
        if done is None:
            return
        at = done
        for column in columns:
            value = column.value
            if isinstance(value, Aggregation):
                self._value(value.argument, at)
                continue
            if self._relations(value):
                local = Variable(self._new("head"))
                site = self._site("part", value, at)
                at = self._next(at, site, Equation(local, substitute(value, at.given)))
            is_leaf = column.field in _LEAVES and not isinstance(value, Variable)
            self._value(value, at, is_leaf=is_leaf)
        name = rule.head.column("robot_name") if tells_robot else None
        who = substitute(name.expression, at.given) if name and name.expression else None
        self._emit(at.trail, gives=number, who=who)

    def _parts(self, parts: Sequence[Proposition], at: At) -> At | None:
        ordered, left = in_order(parts, at.scope, at.known)
        for part, known in ordered:
            at = self._part(part, at, known)
        return None if left else at

    def _part(self, part: Proposition, at: At, known: frozenset[str]) -> At:
        name = part.name if isinstance(part, Atom) else ""
        if self._is_condition(part, at.known):
            column = self._truth(
                as_expression(part), at, "denial" if name == "IsNull" else "condition"
            )
            if column < 0:
                return self._next(at, -1, substitute(part, at.given))
            at.trail.filters = (*at.trail.filters, column)
            return replace(at.when(column, holds=True), known=known)
        pair = self._bound(part, at.known)
        if pair is not None and not self._relations(pair[1]):
            self._value(pair[1], at, is_leaf=pair[0] in self._leaves)
            self._remember(pair[0], pair[1], at)
            at.trail.segment.body.append(substitute(part, at.given))
            return replace(at, known=known)
        if isinstance(part, Atom) and (inner := self._condition_of(part, at)) is not None:
            rule, within = inner
            done = self._parts(conjuncts(rule.body), within)
            if done is not None:
                return replace(at, guard=done.guard, known=known)
        predicate = str(self.copies.get(name, (name, ""))[0])
        site = self._site("part", part, at, predicate=predicate)
        self._in_part(part, at)
        if isinstance(part, Atom) and name == "Memory":
            for argument in part.arguments:
                variable = variable_of(argument.expression)
                if argument.field in ("memory", 1, REST) and variable:
                    self._memories.add(self._called(variable, at))
                elif argument.field in ("memory", 1, REST):
                    self.reads_all = True
        return replace(self._next(at, site, substitute(part, at.given)), known=known)

    def _in_part(self, part: Proposition, at: At) -> None:
        if isinstance(part, Disjunction):
            for branch in part.alternatives:
                self._aside(conjuncts(branch), at, at.scope, at.given, ())
            return
        if isinstance(part, Membership):
            self._value(part.collection, at)
            return
        values = operands(part.arguments) if isinstance(part, Atom) else equated(part) or ()
        for value in values:
            if at.scope.mentioned(value) <= at.known:
                self._value(value, at)

    def _next(self, at: At, site: int, part: Proposition) -> At:
        trail = at.trail
        body = [*self._all_of(at), part]
        self._emit(trail, before=site)
        trail.segment = Segment(body, site)
        trail.filters = ()
        return replace(at, guard=())

    def _condition_of(self, atom: Atom, at: At) -> tuple[Rule, At] | None:
        """Return the only rule of a function that is used as a condition, and a place in it."""
        rules = self._own.get(atom.name, []) if atom.name in self._functions else []
        if len(rules) != 1 or atom.name in at.inside or rules[0].value is not None:
            return None
        found = self._entered(rules[0], atom, at)
        return None if found is None else (rules[0], found)

    def _is_condition(self, part: Proposition, known: frozenset[str]) -> bool:
        if self._relations(part):
            return False
        pair = equated(part)
        if pair is not None:
            return variables(pair) <= known
        return isinstance(part, Atom) and part.name not in self._own and part.name not in INPUTS

    def _bound(self, part: Proposition, known: frozenset[str]) -> tuple[str, Expression] | None:
        pair = equated(part)
        if pair is None:
            return None
        left, right = pair
        for pattern, value in ((left, right), (right, left)):
            name = variable_of(pattern)
            if name and name not in known and variables(value) <= known:
                return name, value
        return None

    def _remember(self, name: str, value: Expression, at: At) -> None:
        if self._is_memory(value, at):
            self._memories.add(self._called(name, at))

    def _relations(self, node: Tree) -> list[Call | Atom]:
        """Return the calls in a tree of predicates that may have no row, outside aggregates."""
        return list(outer_calls(node, self._own.keys() - self._functions))
