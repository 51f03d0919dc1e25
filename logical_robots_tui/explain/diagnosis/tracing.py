"""Queries for everything that a rule does: its parts, conditions, and called functions."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from typing import Any

from logical_robots_tui.explain.bodies import (
    Scope,
    in_order,
    parameters,
    part_kind,
    without_equations,
)
from logical_robots_tui.explain.diagnosis.sites import Field, Stands
from logical_robots_tui.explain.diagnosis.watching import At, Segment, Trail, Watching
from logical_robots_tui.explain.why.probing import ORDERING
from logical_robots_tui.language.tree import (
    COMPARISONS,
    CONDITIONS,
    JUNCTIONS,
    REST,
    Aggregate,
    Aggregation,
    Atom,
    Call,
    Choice,
    Disjunction,
    Equation,
    Expression,
    FieldAccess,
    List,
    Literal,
    Membership,
    PredicateName,
    Proposition,
    Record,
    Rule,
    Tree,
    Variable,
    call,
    conjuncts,
    equation_sides,
    is_aggregate,
    operands,
    substitute,
    text_of,
    variable_of,
    variables,
    walk,
)

_DEEPEST = 8  # nesting of functions
_NOT_VALUES = frozenset({"TryCast"})  # the second argument is a type


class _EveryColumn:
    """Contains every column name."""

    def __contains__(self, column: object) -> bool:
        return True


_EVERY_COLUMN = _EveryColumn()
"""The columns of a function whose required columns are unknown."""


class Tracer(Watching):
    def _value(self, node: Expression, at: At, *, is_leaf: bool = False) -> None:
        if isinstance(node, Choice):
            for branch in node.branches:
                column = self._truth(branch.condition, at, "branch")
                if column < 0:
                    self._miss(node, at)
                    return
                within = replace(at.when(column, holds=True), chosen=(branch.condition, at.rule))
                self._value(branch.value, within, is_leaf=is_leaf)
                at = at.when(column, holds=False)
            self._value(node.otherwise, at, is_leaf=is_leaf)
            return
        name = node.name if isinstance(node, Call) else ""
        if is_leaf and not isinstance(node, Literal | List | PredicateName):
            self._nulls(node, at)
            # A predicate with rows is watched in its own rules.
            has_rows = name in self._own and name not in self._functions
            details = {"places": ()} if has_rows else {}
            self._add(at, self._site("leaf", node, at, **details), (), "always")
        if name in CONDITIONS:
            self._truth(node, at, "operand")
            return
        match node:
            case Call():
                given = operands(node.arguments)
                for value in given[:1] if name in _NOT_VALUES else given:
                    self._value(value, at)
                for value, default in pairwise(given) if name == "Coalesce" else ():
                    self._fallback(value, default, at)
                if name in self._functions:
                    self._function(node, at, is_leaf=is_leaf)
            case Aggregate():
                self._aggregate(node, at)
            case FieldAccess():
                self._read(node, at)
            case Record():
                for value in operands(node.arguments):
                    self._value(value, at)
            case List():
                for value in node.elements:
                    self._value(value, at)
            case Variable() if self._called(node.name, at) in self._memories:
                self.reads_all = True

    def _nulls(self, node: Expression, at: At) -> None:
        waiting = [node]
        while waiting:
            node = waiting.pop(0)
            is_function = isinstance(node, Call) and node.name in self._functions
            if isinstance(node, Aggregate) or is_function:
                lacks = call("IsNull", substitute(node, at.given))
                self._add(at, self._site("value", node, at), (lacks,), "truth", lacks)
            if isinstance(node, Record) or (
                isinstance(node, Call) and node.name not in _NOT_VALUES
            ):
                waiting += operands(node.arguments)

    def _fallback(self, value: Expression, default: Expression, at: At) -> None:
        """Watch whether a value is ever null, so that a computed default is used."""
        if not isinstance(default, Literal) and not self._relations(value):
            lacks = call("IsNull", substitute(value, at.given))
            site = self._site("fallback", value, at, other=self._span(default).text)
            self._add(at, site, (lacks,), "truth", lacks)

    def _truth(self, condition: Expression, at: At, kind: Any) -> int:
        """Watch a condition; return its column, or -1 if there are too many."""
        name = condition.name if isinstance(condition, Call) else ""
        given = operands(condition.arguments) if isinstance(condition, Call) else ()
        found = (name, *given) if name in COMPARISONS and len(given) == 2 else None
        whole = substitute(condition, at.given)
        asked: list[Expression] = [whole]
        how, literal, other, lacks = "truth", None, "", None
        if found is not None:
            sign, *both = found
            asked_sides = [substitute(side, at.given) for side in both]
            texts = [text_of(side) for side in asked_sides]
            other = self._span(both[0]).text
            if sign in ORDERING:
                lacks = call("-", left=asked_sides[0], right=asked_sides[1])
            elif sign == "==" and texts.count(None) == 1:
                place = 0 if texts[0] is not None else 1
                how, literal, asked = "text", texts[place], [asked_sides[1 - place]]
                other = self._span(both[1 - place]).text
                if text_of(both[place]) is None:
                    site = self._site("text", asked_sides[place], at, literal=literal, other=other)
                    self._add(at, site, asked, "text")
                    how, literal, asked = "truth", None, [whole]
            elif sign == "==" and kind == "condition":
                how, asked = "pair", asked_sides
        operator = found[0] if found else name if name in (*JUNCTIONS, "!") else ""
        details = {"literal": literal, "other": other, "operator": operator}
        site = self._site(kind, condition, at, **details)
        column = self._add(at, site, asked, how, whole)
        if column < 0:
            self._miss(condition, at)
            return column
        if lacks is not None:
            at.trail.segment.differences[column] = lacks
        if name in JUNCTIONS:
            first = self._truth(given[0], at, "operand")
            if first >= 0:
                self._truth(given[1], at.when(first, holds=name == "&&"), "operand")
        elif name == "!":
            self._truth(given[0], at, "operand")
        elif isinstance(condition, Call):
            within = replace(at, stands="denied") if kind == "denial" else at
            for value in given:
                self._value(value, within)
            if name in self._functions:
                self._function(condition, at, is_leaf=False)
        else:
            self._value(condition, at)
        return column

    def _aggregate(self, node: Aggregate, at: At) -> None:
        inner = conjuncts(node.body)
        if not inner:
            self._value(node.argument, at)
            return
        local = variables([node.argument, *inner], inside=True) - at.scope.variables
        given = {**at.given, **{name: Variable(self._new(name)) for name in local}}
        stands: Stands = "denied" if at.stands == "denied" else "aggregate"
        scope = Scope(at.scope.functions, at.scope.variables | variables(inner))
        self._aside(inner, at, scope, given, [(node.argument, False)], stands=stands)

    def _function(self, node: Call, at: At, *, is_leaf: bool) -> None:
        if node.name in at.inside or len(at.inside) >= _DEEPEST:
            self._miss(node, at)
            return
        for rule in self._own.get(node.name, ()):
            found = self._entered(rule, node, at)
            if found is None or rule.value is None:
                self._miss(node, at)
                continue
            body = conjuncts(rule.body)
            if body:
                self._aside(body, found, found.scope, found.given, [(rule.value, is_leaf)])
            else:
                self._value(rule.value, found, is_leaf=is_leaf)

    def _read(self, node: FieldAccess, at: At) -> None:
        if self._is_memory(node.record, at):
            name, span = str(node.field), self._span(node)
            self.reads.setdefault((name, span.start), Field(name, span))
        else:
            self._value(node.record, at)

    def _is_memory(self, value: Expression, at: At) -> bool:
        """Return whether an expression is a memory, perhaps cast or with a default."""
        value = substitute(value, at.given)
        while isinstance(value, Call) and value.name in ("TryCast", "Coalesce"):
            value = operands(value.arguments)[0]
        return variable_of(value) in self._memories

    def _entered(self, rule: Rule, called: Call | Atom, at: At) -> At | None:
        expected = parameters(rule)
        values = {each.column: each.expression for each in called.arguments}
        if expected is None or id(rule) not in self._numbers:
            return None
        given: dict[str, Expression] = {}
        for column, variable in expected:
            value = values.get(column)
            if value is None:
                return None
            given[variable] = substitute(value, at.given)
        inner = [*conjuncts(rule.body), *rule.head.columns]
        scope = Scope(dict.fromkeys(self._functions, _EVERY_COLUMN), variables(inner))
        known = frozenset(given)
        for local in variables(inner, inside=True) - known:
            given[local] = Variable(self._new(local))
        return replace(
            at,
            rule=self._numbers[id(rule)],
            scope=scope,
            known=known,
            given=given,
            inside=(*at.inside, str(called.name)),
        )

    def _aside(
        self,
        parts: Sequence[Proposition],
        at: At,
        scope: Scope,
        given: Mapping[str, Expression],
        values: Sequence[tuple[Expression, bool]],
        **changed: Any,
    ) -> None:
        trail = Trail(Segment(self._all_of(at)))
        within = replace(at, trail=trail, scope=scope, given=given, guard=(), **changed)
        done = self._parts(parts, within)
        if done is None:
            self._miss([*parts, *(value for value, _ in values)], at)
        else:
            for value, is_leaf in values:
                self._value(value, done, is_leaf=is_leaf)
        self._emit(trail)
        telling = (self.probes[name][1] for name in trail.probes)
        if not any(probe.columns or self._tells(probe) for probe in telling):
            for name in trail.probes:
                del self.probes[name]

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
        self._owner = rule.name
        leaves = [column for column in columns if (rule.name, column.column) in self._decisive]
        self._leaves = {variable_of(column.expression) for column in leaves} - {""}
        scope = Scope(dict.fromkeys(self._functions, _EVERY_COLUMN), variables([*parts, rule.head]))
        done = self._parts(parts, At(Trail(Segment([])), number, scope, frozenset(), {}))
        if done is None:
            self._miss(rule, At(Trail(Segment([])), number, scope, frozenset(), {}))
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
            is_leaf = column in leaves and not isinstance(value, Variable)
            self._value(value, at, is_leaf=is_leaf)
        name = rule.head.column("robot_name") if tells_robot or leaves else None
        who = substitute(name.expression, at.given) if name and name.expression else None
        self._emit(at.trail, gives=number, who=who, is_robot=tells_robot)

    def _parts(self, parts: Sequence[Proposition], at: At) -> At | None:
        lifted = [(*before, part) for part, before in map(without_equations, parts)]
        ordered, left = in_order(chain.from_iterable(lifted), at.scope, at.known)
        for part, known in ordered:
            at = self._part(part, at, known)
        return None if left else at

    def _part(self, part: Proposition, at: At, known: frozenset[str]) -> At:
        kind, bound = part_kind(part, self._own), _binding(part, at.known)
        is_test = kind in ("condition", "denial") or (kind == "value" and bound is None)
        is_test = is_test and not isinstance(part, Disjunction)
        if is_test and not self._relations(part) and variables(part) <= at.known:
            column = self._truth(
                _as_expression(part), at, "denial" if kind == "denial" else "condition"
            )
            if column < 0:
                return self._next(at, -1, substitute(part, at.given))
            at.trail.filters = (*at.trail.filters, column)
            return replace(at.when(column, holds=True), known=known)
        if bound is not None and not self._relations(bound[1]):
            name, value = bound
            self._value(value, at, is_leaf=name in self._leaves)
            if self._is_memory(value, at):
                self._memories.add(self._called(name, at))
            at.trail.segment.body.append(substitute(part, at.given))
            return replace(at, known=known)
        name = part.name if isinstance(part, Atom) else ""
        if isinstance(part, Atom) and (inner := self._condition_of(part, at)) is not None:
            rule, within = inner
            done = self._parts(conjuncts(rule.body), within)
            if done is not None:
                return replace(at, guard=done.guard, known=known)
            self._miss(part, at)
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
        values = operands(part.arguments) if isinstance(part, Atom) else equation_sides(part) or ()
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

    def _relations(self, node: Tree) -> list[Call | Atom]:
        """Return the calls in a tree of predicates that may have no row, outside aggregates."""
        calls = (each for each in walk(node, is_aggregate) if isinstance(each, Call | Atom))
        return [each for each in calls if each.name in self._own.keys() - self._functions]


def _as_expression(part: Proposition) -> Expression:
    pair = equation_sides(part)
    if pair is not None:
        return call("==", left=pair[0], right=pair[1])
    assert isinstance(part, Atom)
    return Call(part.name, part.arguments, span=part.span)


def _binding(part: Proposition, known: Container[str]) -> tuple[str, Expression] | None:
    """Return the variable that an equation binds, with its value, or None."""
    sides = equation_sides(part)
    for pattern, value in (sides, sides[::-1]) if sides else ():
        name = variable_of(pattern)
        if name and name not in known and all(each in known for each in variables(value)):
            return name, value
    return None
