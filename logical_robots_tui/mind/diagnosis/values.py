"""Conditions in expressions and in the functions that they call. In the compile process.

What a function does depends on its arguments. So its conditions are watched at each call, with the
arguments in place of its parameters.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.clauses.scopes import EVERY_COLUMN, Scope, column_name, flat, names
from logical_robots_tui.mind.clauses.trees import (
    compared,
    field_of,
    filled,
    parameters,
)
from logical_robots_tui.mind.compiling.rules import (
    CONDITIONS,
    JUNCTIONS,
    operands,
    text_of,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.diagnosis.sites import Field
from logical_robots_tui.mind.diagnosis.watching import At, Segment, Stands, Trail, Watching
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.why.probing import ORDERING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.mind.compiling.rules import Rule

_DEEPEST = 8  # nesting of functions
_NOT_VALUES = frozenset({"TryCast"})  # the second argument is a type


class ValueTracing(Watching):
    """Watches expressions; subclasses trace bodies."""

    def _value(self, tree: Rule, at: At, *, is_leaf: bool = False) -> None:
        """Trace an expression that is computed at a place."""
        if "implication" in tree:
            for branch in tree["implication"]["if_then"]:
                column = self._truth(branch["condition"], at, "branch")
                if column < 0:
                    return
                self._value(branch["consequence"], at.when(column, holds=True), is_leaf=is_leaf)
                at = at.when(column, holds=False)
            self._value(tree["implication"]["otherwise"], at, is_leaf=is_leaf)
            return
        call = tree.get("call", {})
        name = str(call.get("predicate_name", ""))
        if is_leaf and "literal" not in tree:
            self._nulls(tree, at)
            # A predicate with rows is watched in its own rules.
            told = {"places": ()} if name in self._own and name not in self._functions else {}
            self._add(at, self._site("leaf", tree, at, **told), (), "always")
        if name in CONDITIONS:
            self._truth(tree, at, "operand")
        elif call:
            given = operands(call)
            for value in given[:1] if name in _NOT_VALUES else given:
                self._value(value, at)
            if name in self._functions:
                self._function(name, call, at, is_leaf=is_leaf)
        elif "combine" in tree:
            self._combine(tree["combine"], at)
        elif "subscript" in tree:
            self._read(tree["subscript"], at)
        elif "record" in tree:
            for value in operands(tree):
                self._value(value, at)
        elif "the_list" in tree.get("literal", {}):
            for value in tree["literal"]["the_list"]["element"]:
                self._value(value, at)
        elif "variable" in tree and self._called(variable_of(tree), at) in self._memories:
            self.reads_all = True

    def _nulls(self, tree: Rule, at: At) -> None:
        """Watch whether the values that a leaf is computed from are null."""
        waiting = [tree]
        while waiting:
            node = waiting.pop(0)
            name = str(node.get("call", {}).get("predicate_name", ""))
            if "combine" in node or (name in self._functions and "call" in node):
                lacks = trees.call("IsNull", filled(node, at.given))
                self._add(at, self._site("value", node, at), (lacks,), "truth", lacks)
            if "record" in node:
                waiting += operands(node)
            elif "call" in node and name not in _NOT_VALUES:
                waiting += operands(node["call"])

    def _truth(self, condition: Rule, at: At, kind: Any) -> int:
        """Watch a condition; return its column, or -1 if there are too many."""
        call = condition.get("call", {})
        name = str(call.get("predicate_name", ""))
        found = compared(condition)
        asked: list[Rule] = [filled(condition, at.given)]
        how, literal, other, lacks = "truth", None, "", None
        if found is not None:
            sign, *both = found
            asked_sides = [filled(side, at.given) for side in both]
            texts = [text_of(side) for side in asked_sides]
            other = self._span(both[0]).text
            if sign in ORDERING:
                lacks = trees.call("-", left=asked_sides[0], right=asked_sides[1])
            elif sign == "==" and texts.count(None) == 1:
                place = 0 if texts[0] is not None else 1
                how, literal, asked = "text", texts[place], [asked_sides[1 - place]]
                other = self._span(both[1 - place]).text
                if text_of(both[place]) is None:
                    given = self._site("text", asked_sides[place], at, literal=literal, other=other)
                    self._add(at, given, asked, "text")
                    how, literal, asked = "truth", None, [filled(condition, at.given)]
            elif sign == "==" and kind == "condition":
                how, asked = "pair", asked_sides
        operator = found[0] if found else name if name in JUNCTIONS else ""
        told = {"literal": literal, "other": other, "operator": operator}
        site = self._site(kind, condition, at, **told)
        column = self._add(at, site, asked, how, filled(condition, at.given))
        if column < 0:
            return column
        if lacks is not None:
            at.trail.segment.differences[column] = lacks
        if name in JUNCTIONS:
            left, right = operands(call)
            first = self._truth(left, at, "operand")
            if first >= 0:
                self._truth(right, at.when(first, holds=name == "&&"), "operand")
        elif name == "!":
            self._truth(operands(call)[0], at, "operand")
        elif found is not None or call:
            within = replace(at, stands="denied") if kind == "denial" else at
            for value in operands(call):
                self._value(value, within)
            if name in self._functions:
                self._function(name, call, at, is_leaf=False)
        else:
            self._value(condition, at)
        return column

    def _combine(self, combine: Rule, at: At) -> None:
        inner = flat(combine.get("body"))
        (column,) = combine["head"]["record"]["field_value"]
        argument = column["value"].get("aggregation", {}).get("argument")
        if not inner:
            if argument:
                self._value(argument, at)
            return
        local = names([combine["head"], *inner], inside=True) - at.scope.variables
        given = {**at.given, **{name: trees.variable(self._new(name)) for name in local}}
        values = [(argument, False)] if argument else []
        stands: Stands = "denied" if at.stands == "denied" else "aggregate"
        variables = at.scope.variables.union(*map(names, inner))
        scope = Scope(at.scope.functions, variables)
        self._aside(inner, at, scope, given, values, stands=stands)

    def _function(self, name: str, call: Rule, at: At, *, is_leaf: bool) -> None:
        if name in at.inside or len(at.inside) >= _DEEPEST:
            return
        for rule in self._own.get(name, ()):
            found = self._entered(rule, name, call, at)
            value = head_value(rule)
            if found is None or value is None:
                continue
            body = flat(rule.get("body"))
            if body:
                self._aside(body, found, found.scope, found.given, [(value, is_leaf)])
            else:
                self._value(value, found, is_leaf=is_leaf)

    def _read(self, subscript: Rule, at: At) -> None:
        """Note a field that is read from a record."""
        record = subscript["record"]
        if self._is_memory(record, at):
            name, span = field_of(subscript), self._span(subscript)
            self.reads.setdefault((name, span.start), Field(name, span))
        else:
            self._value(record, at)

    def _is_memory(self, value: Rule, at: At) -> bool:
        """Return whether an expression is a memory, perhaps cast or with a default."""
        value = filled(value, at.given)
        while str(value.get("call", {}).get("predicate_name", "")) in ("TryCast", "Coalesce"):
            value = operands(value["call"])[0]
        return variable_of(value) in self._memories

    def _entered(self, rule: Rule, name: str, call: Rule, at: At) -> At | None:
        """Return the place at the beginning of the rule of a function that is called."""
        expected = parameters(rule)
        values = {column_name(fv["field"]): value_of(fv) for fv in call["record"]["field_value"]}
        if expected is None or id(rule) not in self._numbers:
            return None
        given: dict[str, Rule] = {}
        for place, variable in expected:
            value = values.get(column_name(place))
            if value is None:
                return None
            given[variable] = filled(value, at.given)
        inner = [*flat(rule.get("body")), rule["head"]["record"]]
        scope = Scope(
            dict.fromkeys(self._functions, EVERY_COLUMN), frozenset[str]().union(*map(names, inner))
        )
        known = frozenset(given)
        for local in scope.variables - known:
            given[local] = trees.variable(self._new(local))
        for local in names(inner, inside=True) - scope.variables:
            given[local] = trees.variable(self._new(local))
        return replace(
            at,
            rule=self._numbers[id(rule)],
            scope=scope,
            known=known,
            given=given,
            inside=(*at.inside, name),
        )

    def _aside(
        self,
        parts: Sequence[Rule],
        at: At,
        scope: Scope,
        given: Mapping[str, Rule],
        values: Sequence[tuple[Rule, bool]],
        **changed: Any,
    ) -> None:
        """Trace a body inside an expression or a part."""
        trail = Trail(Segment(self._all_of(at)))
        within = replace(at, trail=trail, scope=scope, given=given, guard=(), **changed)
        done = self._parts(parts, within)
        if done is not None:
            for value, is_leaf in values:
                self._value(value, done, is_leaf=is_leaf)
        self._emit(trail)
        telling = (self.probes[name][1] for name in trail.probes)
        if not any(probe.columns or self._tells(probe) for probe in telling):
            for name in trail.probes:
                del self.probes[name]

    def _parts(self, parts: Sequence[Rule], at: At) -> At | None:
        """Trace the parts of a body; return None if some can never be evaluated."""
        raise NotImplementedError


def head_value(rule: Rule) -> Rule | None:
    """Return the expression for the value of a function, or None."""
    columns = rule["head"]["record"]["field_value"]
    return next((value_of(column) for column in columns if column["field"] == VALUE), None)
