"""Queries for everything that a rule does: its parts, conditions, and called functions."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from typing import Any

from logical_robots_tui.explain.bodies import (
    Scope,
    order_parts,
    parameters,
    part_kind,
    without_equations,
)
from logical_robots_tui.explain.diagnosis.sites import NamedPlace, SitePosition
from logical_robots_tui.explain.diagnosis.watching import Environment, Segment, Trail, Watching
from logical_robots_tui.explain.why.probing import ORDERING
from logical_robots_tui.language import tree
from logical_robots_tui.language.tree import Atom, Call, Expression, Proposition, Rule, Variable

_DEEPEST = 8  # nesting of functions
_NOT_VALUES = frozenset({"TryCast"})  # the second argument is a type


class _EveryColumn:
    """Contains every column name."""

    def __contains__(self, column: object) -> bool:
        return True


_EVERY_COLUMN = _EveryColumn()
"""The columns of a function whose required columns are unknown."""


class Tracer(Watching):
    def _value(self, node: Expression, env: Environment, *, is_leaf: bool = False) -> None:
        if isinstance(node, tree.Choice):
            for branch in node.branches:
                column = self._truth(branch.condition, env, "branch")
                if column < 0:
                    self._miss(node, env)
                    return
                inner_env = replace(
                    env.when(column, holds=True), choice=(branch.condition, env.rule)
                )
                self._value(branch.value, inner_env, is_leaf=is_leaf)
                env = env.when(column, holds=False)
            self._value(node.otherwise, env, is_leaf=is_leaf)
            return
        name = node.name if isinstance(node, Call) else ""
        if is_leaf and not isinstance(node, tree.Literal | tree.List | tree.PredicateName):
            self._nulls(node, env)
            # A predicate with rows is watched in its own rules.
            has_rows = name in self._predicates and name not in self._functions
            details = {"places": ()} if has_rows else {}
            self._add(env, self._site("leaf", node, env, **details), (), "always")
        if name in tree.CONDITIONS:
            self._truth(node, env, "operand")
            return
        match node:
            case Call():
                arguments = tree.operands(node.arguments)
                for value in arguments[:1] if name in _NOT_VALUES else arguments:
                    self._value(value, env)
                for value, default in pairwise(arguments) if name == "Coalesce" else ():
                    if not isinstance(default, tree.Literal) and not self._relations(value):
                        null_test = tree.call("IsNull", tree.substitute(value, env.bindings))
                        site = self._site(
                            "fallback", value, env, counterpart=self._span(default).text
                        )
                        self._add(env, site, (null_test,), "truth", null_test)
                if name in self._functions:
                    self._function(node, env, is_leaf=is_leaf)
            case tree.Aggregate():
                self._aggregate(node, env)
            case tree.FieldAccess():
                if self._is_memory(node.record, env):
                    name, span = str(node.field), self._span(node)
                    self.reads.setdefault((name, span.start), NamedPlace(name, span))
                else:
                    self._value(node.record, env)
            case tree.Record():
                for value in tree.operands(node.arguments):
                    self._value(value, env)
            case tree.List():
                for value in node.elements:
                    self._value(value, env)
            case Variable() if self._query_variable(node.name, env) in self._memories:
                self.reads_all = True

    def _nulls(self, node: Expression, env: Environment) -> None:
        queue = [node]
        while queue:
            node = queue.pop(0)
            is_function = isinstance(node, Call) and node.name in self._functions
            if isinstance(node, tree.Aggregate) or is_function:
                null_test = tree.call("IsNull", tree.substitute(node, env.bindings))
                self._add(env, self._site("value", node, env), (null_test,), "truth", null_test)
            if isinstance(node, tree.Record) or (
                isinstance(node, Call) and node.name not in _NOT_VALUES
            ):
                queue += tree.operands(node.arguments)

    def _truth(self, condition: Expression, env: Environment, kind: Any) -> int:
        """Watch a condition; return its column, or -1 if there are too many."""
        name = condition.name if isinstance(condition, Call) else ""
        arguments = tree.operands(condition.arguments) if isinstance(condition, Call) else ()
        comparison = (
            (name, *arguments) if name in tree.COMPARISONS and len(arguments) == 2 else None
        )
        whole = tree.substitute(condition, env.bindings)
        expressions: list[Expression] = [whole]
        mode, literal, counterpart, difference = "truth", None, "", None
        if comparison is not None:
            sign, *both = comparison
            sides = [tree.substitute(side, env.bindings) for side in both]
            texts = [tree.text_of(side) for side in sides]
            counterpart = self._span(both[0]).text
            if sign in ORDERING:
                difference = tree.call("-", left=sides[0], right=sides[1])
            elif sign == "==" and texts.count(None) == 1:
                index = 0 if texts[0] is not None else 1
                mode, literal, expressions = "text", texts[index], [sides[1 - index]]
                counterpart = self._span(both[1 - index]).text
                if tree.text_of(both[index]) is None:
                    details = {"literal": literal, "counterpart": counterpart}
                    site = self._site("text", sides[index], env, **details)
                    self._add(env, site, expressions, "text")
                    mode, literal, expressions = "truth", None, [whole]
            elif sign == "==" and kind == "condition":
                mode, expressions = "pair", sides
        operator = comparison[0] if comparison else name if name in (*tree.JUNCTIONS, "!") else ""
        details = {"literal": literal, "counterpart": counterpart, "operator": operator}
        site = self._site(kind, condition, env, **details)
        column = self._add(env, site, expressions, mode, whole)
        if column < 0:
            self._miss(condition, env)
            return column
        if difference is not None:
            env.trail.segment.differences[column] = difference
        if name in tree.JUNCTIONS:
            first = self._truth(arguments[0], env, "operand")
            if first >= 0:
                self._truth(arguments[1], env.when(first, holds=name == "&&"), "operand")
        elif name == "!":
            self._truth(arguments[0], env, "operand")
        elif isinstance(condition, Call):
            inner_env = replace(env, position="denied") if kind == "denial" else env
            for value in arguments:
                self._value(value, inner_env)
            if name in self._functions:
                self._function(condition, env, is_leaf=False)
        else:
            self._value(condition, env)
        return column

    def _aggregate(self, node: tree.Aggregate, env: Environment) -> None:
        inner = tree.conjuncts(node.body)
        if not inner:
            self._value(node.argument, env)
            return
        local = tree.variables([node.argument, *inner], inside=True) - env.scope.variables
        bindings = {**env.bindings, **{name: Variable(self._fresh_name(name)) for name in local}}
        position: SitePosition = "denied" if env.position == "denied" else "aggregate"
        scope = Scope(env.scope.functions, env.scope.variables | tree.variables(inner))
        self._trace_body(inner, env, scope, bindings, [(node.argument, False)], position=position)

    def _function(self, node: Call, env: Environment, *, is_leaf: bool) -> None:
        if node.name in env.call_stack or len(env.call_stack) >= _DEEPEST:
            self._miss(node, env)
            return
        for rule in self._predicates.get(node.name, ()):
            inner_env = self._function_env(rule, node, env)
            if inner_env is None or rule.value is None:
                self._miss(node, env)
                continue
            body = tree.conjuncts(rule.body)
            if body:
                self._trace_body(
                    body, inner_env, inner_env.scope, inner_env.bindings, [(rule.value, is_leaf)]
                )
            else:
                self._value(rule.value, inner_env, is_leaf=is_leaf)

    def _is_memory(self, value: Expression, env: Environment) -> bool:
        """Return whether an expression is a memory, perhaps cast or with a default."""
        value = tree.substitute(value, env.bindings)
        while isinstance(value, Call) and value.name in ("TryCast", "Coalesce"):
            value = tree.operands(value.arguments)[0]
        return tree.variable_of(value) in self._memories

    def _function_env(
        self, rule: Rule, caller: Call | Atom, env: Environment
    ) -> Environment | None:
        parameter_pairs = parameters(rule)
        values = {argument.column: argument.expression for argument in caller.arguments}
        if parameter_pairs is None or id(rule) not in self._numbers:
            return None
        bindings: dict[str, Expression] = {}
        for column, variable in parameter_pairs:
            value = values.get(column)
            if value is None:
                return None
            bindings[variable] = tree.substitute(value, env.bindings)
        inner = [*tree.conjuncts(rule.body), *rule.head.columns]
        scope = Scope(dict.fromkeys(self._functions, _EVERY_COLUMN), tree.variables(inner))
        bound = frozenset(bindings)
        for local in tree.variables(inner, inside=True) - bound:
            bindings[local] = Variable(self._fresh_name(local))
        return replace(
            env,
            rule=self._numbers[id(rule)],
            scope=scope,
            bound=bound,
            bindings=bindings,
            call_stack=(*env.call_stack, str(caller.name)),
        )

    def _trace_body(
        self,
        parts: Sequence[Proposition],
        env: Environment,
        scope: Scope,
        bindings: Mapping[str, Expression],
        values: Sequence[tuple[Expression, bool]],
        **changes: Any,
    ) -> None:
        trail = Trail(Segment(self._guarded_body(env)))
        inner_env = replace(env, trail=trail, scope=scope, bindings=bindings, guard=(), **changes)
        end_env = self._trace_parts(parts, inner_env)
        if end_env is None:
            self._miss([*parts, *(value for value, _ in values)], env)
        else:
            for value, is_leaf in values:
                self._value(value, end_env, is_leaf=is_leaf)
        self._emit(trail)
        probes = (self.probes[name][1] for name in trail.probes)
        if not any(probe.columns or self._covers_predicate(probe) for probe in probes):
            for name in trail.probes:
                del self.probes[name]

    def copy(self, name: str) -> None:
        _, self._within = self.copies[name]
        for rule in self._predicates[name]:
            self.rule(rule, tells_robot=False)
        self._within = ""

    def rule(self, rule: Rule, *, tells_robot: bool) -> None:
        columns = rule.head.columns
        parts = tree.conjuncts(rule.body)
        number = self._numbers[id(rule)]
        self._memories = set()
        self._owner = rule.name
        leaves = [column for column in columns if (rule.name, column.column) in self._decisive]
        self._leaves = {tree.variable_of(column.expression) for column in leaves} - {""}
        scope = Scope(
            dict.fromkeys(self._functions, _EVERY_COLUMN), tree.variables([*parts, rule.head])
        )
        start = Environment(Trail(Segment([])), number, scope, frozenset(), {})
        end_env = self._trace_parts(parts, start)
        if end_env is None:
            self._miss(rule, start)
            return
        env = end_env
        for column in columns:
            value = column.value
            if isinstance(value, tree.Aggregation):
                self._value(value.argument, env)
                continue
            if self._relations(value):
                local = Variable(self._fresh_name("head"))
                site = self._site("part", value, env)
                env = self._next_segment(
                    env, site, tree.Equation(local, tree.substitute(value, env.bindings))
                )
            is_leaf = column in leaves and not isinstance(value, Variable)
            self._value(value, env, is_leaf=is_leaf)
        name = rule.head.column("robot_name") if tells_robot or leaves else None
        robot = tree.substitute(name.expression, env.bindings) if name and name.expression else None
        self._emit(env.trail, rule=number, robot=robot, is_robot=tells_robot)

    def _trace_parts(self, parts: Sequence[Proposition], env: Environment) -> Environment | None:
        lifted = [(*equations, part) for part, equations in map(without_equations, parts)]
        ordered, unordered = order_parts(chain.from_iterable(lifted), env.scope, env.bound)
        for part, bound in ordered:
            env = self._part(part, env, bound)
        return None if unordered else env

    def _part(self, part: Proposition, env: Environment, bound: frozenset[str]) -> Environment:
        kind, binding = part_kind(part, self._predicates), _binding(part, env.bound)
        is_test = kind in ("condition", "denial") or (kind == "value" and binding is None)
        is_test = is_test and not isinstance(part, tree.Disjunction)
        if is_test and not self._relations(part) and tree.variables(part) <= env.bound:
            column = self._truth(
                _as_expression(part), env, "denial" if kind == "denial" else "condition"
            )
            if column < 0:
                return self._next_segment(env, -1, tree.substitute(part, env.bindings))
            env.trail.filters = (*env.trail.filters, column)
            return replace(env.when(column, holds=True), bound=bound)
        if binding is not None and not self._relations(binding[1]):
            name, value = binding
            self._value(value, env, is_leaf=name in self._leaves)
            if self._is_memory(value, env):
                self._memories.add(self._query_variable(name, env))
            env.trail.segment.body.append(tree.substitute(part, env.bindings))
            return replace(env, bound=bound)
        name = part.name if isinstance(part, Atom) else ""
        if isinstance(part, Atom) and (inner := self._condition_of(part, env)) is not None:
            rule, inner_env = inner
            end_env = self._trace_parts(tree.conjuncts(rule.body), inner_env)
            if end_env is not None:
                return replace(env, guard=end_env.guard, bound=bound)
            self._miss(part, env)
        predicate = str(self.copies.get(name, (name, ""))[0])
        site = self._site("part", part, env, predicate=predicate)
        self._in_part(part, env)
        if isinstance(part, Atom) and name == "Memory":
            for argument in part.arguments:
                variable = tree.variable_of(argument.expression)
                if argument.field in ("memory", 1, tree.REST) and variable:
                    self._memories.add(self._query_variable(variable, env))
                elif argument.field in ("memory", 1, tree.REST):
                    self.reads_all = True
        return replace(
            self._next_segment(env, site, tree.substitute(part, env.bindings)), bound=bound
        )

    def _in_part(self, part: Proposition, env: Environment) -> None:
        if isinstance(part, tree.Disjunction):
            for branch in part.alternatives:
                self._trace_body(tree.conjuncts(branch), env, env.scope, env.bindings, ())
            return
        if isinstance(part, tree.Membership):
            self._value(part.collection, env)
            return
        values = (
            tree.operands(part.arguments)
            if isinstance(part, Atom)
            else tree.equation_sides(part) or ()
        )
        for value in values:
            if env.scope.variables_in(value) <= env.bound:
                self._value(value, env)

    def _next_segment(self, env: Environment, site: int, part: Proposition) -> Environment:
        trail = env.trail
        body = [*self._guarded_body(env), part]
        self._emit(trail, reached_site=site)
        trail.segment = Segment(body, site)
        trail.filters = ()
        return replace(env, guard=())

    def _condition_of(self, atom: Atom, env: Environment) -> tuple[Rule, Environment] | None:
        """Return the only rule of a function that is used as a condition, and a place in it."""
        rules = self._predicates.get(atom.name, []) if atom.name in self._functions else []
        if len(rules) != 1 or atom.name in env.call_stack or rules[0].value is not None:
            return None
        inner_env = self._function_env(rules[0], atom, env)
        return None if inner_env is None else (rules[0], inner_env)

    def _relations(self, node: tree.Tree) -> list[Call | Atom]:
        """Return the calls in a tree of predicates that may have no row, outside aggregates."""
        calls = (
            inner for inner in tree.walk(node, tree.is_aggregate) if isinstance(inner, Call | Atom)
        )
        return [inner for inner in calls if inner.name in self._predicates.keys() - self._functions]


def _as_expression(part: Proposition) -> Expression:
    pair = tree.equation_sides(part)
    if pair is not None:
        return tree.call("==", left=pair[0], right=pair[1])
    assert isinstance(part, Atom)
    return Call(part.name, part.arguments, span=part.span)


def _binding(part: Proposition, bound: Container[str]) -> tuple[str, Expression] | None:
    """Return the variable that an equation binds, with its value, or None."""
    sides = tree.equation_sides(part)
    for pattern, value in (sides, sides[::-1]) if sides else ():
        name = tree.variable_of(pattern)
        if name and name not in bound and all(inner in bound for inner in tree.variables(value)):
            return name, value
    return None
