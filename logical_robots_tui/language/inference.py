"""Fields that certainly do not exist, found by tracing kinds through the rules.

A variable's kind is known if it comes from `Sensor`, a record literal, or a column or
argument that has the same kind everywhere.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import definitions, functor_names, rules_of
from logical_robots_tui.language.diagnostics import closest
from logical_robots_tui.language.source_text import diagnostic_at, diagnostic_for
from logical_robots_tui.language.tree import REST, Name
from logical_robots_tui.language.types import (
    SENSOR,
    Kind,
    ListOf,
    Plain,
    RecordOf,
    common,
    is_nested,
)
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.language.tree import Argument, Expression, Proposition, Rule, Statement


_ROUNDS = 6  # how far a kind is traced from predicate to predicate
_MOST_STEPS = 100_000  # nested aggregates are visited repeatedly
_LIST = "A list is needed here, such as sensor.radar, [1, 2] or Range(10)."
_CHOOSING = frozenset({"ArgMin", "ArgMax"})
_COLLECTING = frozenset({"List"})
_SAME = frozenset({"Sort", "Unique"})

Scope: TypeAlias = "dict[str, Kind]"
Column: TypeAlias = tuple[str, "int | str"]


class _TooManyStepsError(Exception):
    """The program is too complex to trace."""


class Inference:
    def __init__(self, program: Sequence[Statement], text: str, doubtful: frozenset[str]) -> None:
        self._text = text
        self._definitions = definitions(program)
        self._rules = rules_of(program)
        self._unknown = doubtful | functor_names(program)
        self._columns: dict[Column, Kind] = {("Sensor", "sensor"): SENSOR}
        self._arguments: dict[Column, Kind] = {}
        self._given: dict[Column, list[Kind]] = {}
        self._problems: dict[int, Diagnostic] = {}
        self._steps = 0
        if not self._settle():
            self._problems.clear()
            self._columns.clear()
            self._arguments.clear()

    @property
    def problems(self) -> list[Diagnostic]:
        """Diagnostics for fields that certainly do not exist."""
        return list(self._problems.values())

    def column(self, predicate: str, name: str) -> list[Kind]:
        found: list[Kind] = []
        for rule in rules_of(self._definitions.get(predicate, ())):
            for column in rule.head.columns:
                if column.field == name and column.expression is not None:
                    scope = self._scope(rule.body, {})
                    found += self._alternatives(column.expression, scope)
        return found

    # -- through all rules ---------------------------------------------------------------------

    def _settle(self) -> bool:
        """Visit the rules until nothing new is learnt; return False if that takes too long."""
        for _ in range(_ROUNDS):
            before = (dict(self._columns), dict(self._arguments))
            self._problems.clear()
            self._given.clear()
            try:
                self._go_through_rules()
            except _TooManyStepsError:
                return False
            if before == (self._columns, self._arguments):
                return True
        return False

    def _go_through_rules(self) -> None:
        columns: dict[Column, list[Kind]] = {}
        for rule in self._rules:
            scope = self._scope(rule.body, self._parameters(rule))
            for column in rule.head.columns:
                kind = self._value(column, scope)
                columns.setdefault((rule.name, column.field), []).append(kind)
        for place, kinds in columns.items():
            if place[0] not in self._unknown:
                self._columns[place] = common(kinds)
        unknown = self._unknown | {name for name, field in self._given if field == REST}
        self._arguments = {
            place: common(kinds) for place, kinds in self._given.items() if place[0] not in unknown
        }

    def _parameters(self, rule: Rule) -> Scope:
        scope: Scope = {}
        for column in rule.head.columns:
            if isinstance(column.value, tree.Variable):
                kind = self._arguments.get((rule.name, column.field))
                if kind is not None and kind is not Plain.ANY:
                    scope[column.value.name] = kind
        return scope

    def _scope(self, body: Proposition | None, outer: Mapping[str, Kind]) -> Scope:
        scope = dict(outer)
        before: Scope | None = None
        while body is not None and scope != before:
            before = dict(scope)
            self._proposition(body, scope)
        return scope

    def _proposition(self, node: Proposition, scope: Scope) -> None:
        self._steps += 1
        if self._steps > _MOST_STEPS:
            raise _TooManyStepsError
        match node:
            case tree.Conjunction():
                for member in node.members:
                    self._proposition(member, scope)
            case tree.Disjunction():
                for alternative in node.alternatives:
                    self._scope(alternative, scope)
            case tree.Equation():
                self._equal(node.left, node.right, scope)
            case tree.Membership():
                self._element(node, scope)
            case tree.Atom():
                self._condition(node, scope)

    def _condition(self, atom: tree.Atom, scope: Scope) -> None:
        if atom.name in ("=", "==") and len(atom.arguments) == 2:
            left, right = tree.operands(atom.arguments)
            self._equal(left, right, scope)
            return
        for argument in atom.arguments:
            if argument.expression is not None:
                kind = self._columns.get((atom.name, argument.field), Plain.ANY)
                self._bind(argument.expression, kind, scope)
                self._give(atom.name, argument.field, self._kind(argument.expression, scope))

    def _equal(self, left: Expression, right: Expression, scope: Scope) -> None:
        self._bind(left, self._kind(right, scope), scope)
        self._bind(right, self._kind(left, scope), scope)

    def _element(self, node: tree.Membership, scope: Scope) -> None:
        kind = self._kind(node.collection, scope)
        if isinstance(kind, ListOf):
            self._bind(node.element, kind.element, scope)
        elif isinstance(node.collection, tree.Number | tree.Text):
            self._not_a_list(node.collection, f"{self._source(node.collection)} is not a list")
        elif isinstance(kind, RecordOf):
            self._not_a_list(node.collection, f"{kind.title} is a record, not a list")
        elif _is_scalar(kind):
            name = self._source(node.collection)
            self._not_a_list(node.collection, f"{name} is a plain value, not a list")
        self._kind(node.element, scope)

    def _bind(self, pattern: Expression, kind: Kind, scope: Scope) -> None:
        if kind is Plain.ANY:
            return
        if isinstance(pattern, tree.Variable):
            if pattern.name not in scope:
                scope[pattern.name] = kind
            elif scope[pattern.name] != kind:
                scope[pattern.name] = Plain.ANY
        elif isinstance(pattern, tree.Record) and isinstance(kind, RecordOf):
            for each in pattern.arguments:
                self._check_field(each.field, kind)
                if each.expression:
                    self._bind(each.expression, kind.field(str(each.field)), scope)

    # -- expressions ---------------------------------------------------------------------------

    def _kind(self, node: Expression, scope: Scope) -> Kind:
        match node:
            case tree.Variable():
                return scope.get(node.name, Plain.ANY)
            case tree.Record():
                parts = {each.field: self._value(each, scope) for each in node.arguments}
                if REST in parts:
                    return Plain.ANY
                names = {name: kind for name, kind in parts.items() if isinstance(name, str)}
                return RecordOf(tuple(names.items()), names=tuple(names))
            case tree.FieldAccess():
                return self._field(node, scope)
            case tree.Call():
                return self._call(node, scope)
            case tree.Aggregate():
                return self._aggregate(node, scope)
            case tree.Choice():
                return common(self._alternatives(node, scope))
            case tree.List():
                return ListOf(common([self._kind(each, scope) for each in node.elements]))
        return Plain.ANY

    def _value(self, argument: Argument, scope: Scope) -> Kind:
        """Return the kind of a column or argument; unknown if it is aggregated."""
        if isinstance(argument.value, tree.Aggregation):
            self._kind(argument.value.argument, scope)
            return Plain.ANY
        return self._kind(argument.value, scope)

    def _alternatives(self, node: Expression, scope: Scope) -> list[Kind]:
        if not isinstance(node, tree.Choice):
            return [self._kind(node, scope)]
        kinds = []
        for branch in node.branches:
            self._kind(branch.condition, scope)
            kinds.append(self._kind(branch.value, scope))
        return [*kinds, self._kind(node.otherwise, scope)]

    def _field(self, node: tree.FieldAccess, scope: Scope) -> Kind:
        kind = self._kind(node.record, scope)
        name = node.field
        if isinstance(kind, RecordOf):
            self._check_field(name, kind)
            return kind.field(name)
        if isinstance(kind, ListOf):
            hint = f"Take its elements one by one: x in {self._source(node.record)}, x.{name}."
            self._report(name, f"{kind.title} is a list; it has no field {name}", hint)
        elif _is_scalar(kind):
            hint = "It is a plain value; only records have fields."
            self._report(name, f"{self._source(node.record)} has no field {name}", hint)
        return Plain.ANY

    def _call(self, node: tree.Call, scope: Scope) -> Kind:
        given = []
        for argument in node.arguments:
            kind = self._value(argument, scope)
            given.append(kind)
            self._give(node.name, argument.field, kind)
        if node.name not in self._definitions:
            if node.name == "Element" and given and isinstance(given[0], ListOf):
                return given[0].element
            if node.name in _SAME and given:
                return given[0]
        return self._columns.get((node.name, VALUE), Plain.ANY)

    def _aggregate(self, node: tree.Aggregate, scope: Scope) -> Kind:
        inner = self._scope(node.body, scope)
        kind = self._kind(node.argument, inner)
        self._give(node.operator, 0, Plain.ANY)
        if node.operator in self._definitions:
            return Plain.ANY
        if node.operator in _COLLECTING:
            return ListOf(kind)
        pair = node.argument
        if node.operator in _CHOOSING and isinstance(pair, tree.Call) and pair.name == "->":
            return self._value(pair.arguments[0], inner)
        return Plain.ANY

    def _give(self, name: str, argument: int | str, kind: Kind) -> None:
        if isinstance(argument, str) and (found := re.fullmatch(r"col(\d+)", argument)):
            argument = int(found.group(1))
        self._given.setdefault((name, argument), []).append(kind)

    # -- reports -------------------------------------------------------------------------------

    def _check_field(self, name: int | str, kind: RecordOf) -> None:
        known = [each for each, _ in kind.fields]
        if not isinstance(name, str) or name in known:
            return
        close = closest(name, known, 0.6)
        hint = f"Did you mean {close}?" if close else f"It has {', '.join(known)}."
        if len(hint) > 120:
            hint = "Compare with its definition."
        self._report(name, f"{kind.title} has no field {name}", hint)

    def _report(self, name: str, message: str, hint: str) -> None:
        if isinstance(name, Name) and name.start >= 0 and len(hint) <= 120:
            self._problems[name.start] = diagnostic_for(self._text, name, message, hint)

    def _not_a_list(self, node: Expression, message: str) -> None:
        if node.span:
            start, stop = node.span
            problem = diagnostic_at(self._text, start, stop - start, message, _LIST)
            self._problems[start] = problem

    def _source(self, node: Expression) -> str:
        """Return the text of an expression, if it is short."""
        text = " ".join(self._text[slice(*node.span)].split()) if node.span else "list"
        return text if len(text) <= 40 else "the list"


def _is_scalar(kind: Kind) -> bool:
    return not is_nested(kind) and kind not in (Plain.ANY, Plain.NULL)
