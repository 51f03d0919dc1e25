"""Fields that certainly do not exist, found by tracing shapes through the rules.

A variable's shape is known if it comes from `Sensor`, a record literal, or a column or
argument that has the same shape everywhere.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui import schema
from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import definitions, made_from_functors, rules_of
from logical_robots_tui.language.similar_names import closest
from logical_robots_tui.language.source_text import diagnostic_at, diagnostic_for
from logical_robots_tui.language.tree import REST, Name
from logical_robots_tui.schema import VALUE

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.language.tree import Argument, Expression, Proposition, Rule, Statement


@dataclass(frozen=True, slots=True)
class Scalar:
    """A number, text or boolean of the sensor."""

    title: str


@dataclass(frozen=True, slots=True)
class ListOf:
    element: Shape | None
    title: str = field(default="this list", compare=False)


@dataclass(frozen=True, slots=True)
class Record:
    """A record whose fields are all known; a shape of None is unknown."""

    fields: Mapping[str, Shape | None]
    title: str = field(default="this record", compare=False)
    names: tuple[str, ...] = field(default=(), compare=False)


Shape: TypeAlias = Scalar | ListOf | Record


def _shape_of(name: str, field: schema.FieldType) -> Shape:
    if isinstance(field, schema.Type):
        return Scalar(name)
    if isinstance(field, schema.ListOf):
        return ListOf(_shape_of("", field.element), field.title)
    return Record(
        {each.name: _shape_of(each.name, each.type) for each in field.fields}, field.title
    )


SENSOR = _shape_of("sensor", schema.SENSOR)
"""What a robot perceives in a tick."""

_ROUNDS = 6  # how far a shape is traced from predicate to predicate
_MOST_STEPS = 100_000  # nested aggregates are visited repeatedly
_LIST = "A list is needed here, such as sensor.radar, [1, 2] or Range(10)."
_CHOOSING = frozenset({"ArgMin", "ArgMax"})
_COLLECTING = frozenset({"List"})
_SAME = frozenset({"Sort", "Unique"})

Scope: TypeAlias = dict[str, Shape | None]
Column: TypeAlias = tuple[str, "int | str"]


class _TooManyStepsError(Exception):
    """The program is too complex to trace."""


class Inference:
    def __init__(self, program: Sequence[Statement], text: str, doubtful: frozenset[str]) -> None:
        self._text = text
        self._definitions = definitions(program)
        self._rules = rules_of(program)
        self._unknown = doubtful | made_from_functors(program)
        self._columns: dict[Column, Shape | None] = {("Sensor", "sensor"): SENSOR}
        self._arguments: dict[Column, Shape | None] = {}
        self._given: dict[Column, list[Shape | None]] = {}
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

    def column(self, predicate: str, name: str) -> list[Shape | None]:
        found: list[Shape | None] = []
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
        columns: dict[Column, list[Shape | None]] = {}
        for rule in self._rules:
            scope = self._scope(rule.body, self._parameters(rule))
            for column in rule.head.columns:
                shape = self._value(column, scope)
                columns.setdefault((rule.name, column.field), []).append(shape)
        for place, shapes in columns.items():
            if place[0] not in self._unknown:
                self._columns[place] = _common(shapes)
        unknown = self._unknown | {name for name, field in self._given if field == REST}
        self._arguments = {
            place: _common(shapes)
            for place, shapes in self._given.items()
            if place[0] not in unknown
        }

    def _parameters(self, rule: Rule) -> Scope:
        scope: Scope = {}
        for column in rule.head.columns:
            if isinstance(column.value, tree.Variable):
                shape = self._arguments.get((rule.name, column.field))
                if shape is not None:
                    scope[column.value.name] = shape
        return scope

    def _scope(self, body: Proposition | None, outer: Mapping[str, Shape | None]) -> Scope:
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
                shape = self._columns.get((atom.name, argument.field))
                self._bind(argument.expression, shape, scope)
                self._give(atom.name, argument.field, self._shape(argument.expression, scope))

    def _equal(self, left: Expression, right: Expression, scope: Scope) -> None:
        self._bind(left, self._shape(right, scope), scope)
        self._bind(right, self._shape(left, scope), scope)

    def _element(self, node: tree.Membership, scope: Scope) -> None:
        shape = self._shape(node.collection, scope)
        if isinstance(shape, ListOf):
            self._bind(node.element, shape.element, scope)
        elif isinstance(node.collection, tree.Number | tree.Text):
            self._not_a_list(node.collection, f"{self._source(node.collection)} is not a list")
        elif shape is not None:
            kind = "a record" if isinstance(shape, Record) else "a plain value"
            self._not_a_list(node.collection, f"{shape.title} is {kind}, not a list")
        self._shape(node.element, scope)

    def _bind(self, pattern: Expression, shape: Shape | None, scope: Scope) -> None:
        if shape is None:
            return
        if isinstance(pattern, tree.Variable):
            if pattern.name not in scope:
                scope[pattern.name] = shape
            elif scope[pattern.name] is not None and scope[pattern.name] != shape:
                scope[pattern.name] = None
        elif isinstance(pattern, tree.Record) and isinstance(shape, Record):
            for each in pattern.arguments:
                self._check_field(each.field, shape)
                if each.expression:
                    self._bind(each.expression, shape.fields.get(str(each.field)), scope)

    # -- expressions ---------------------------------------------------------------------------

    def _shape(self, node: Expression, scope: Scope) -> Shape | None:
        match node:
            case tree.Variable():
                return scope.get(node.name)
            case tree.Record():
                parts = {each.field: self._value(each, scope) for each in node.arguments}
                names = {name: shape for name, shape in parts.items() if isinstance(name, str)}
                return None if REST in parts else Record(names, names=tuple(names))
            case tree.FieldAccess():
                return self._field(node, scope)
            case tree.Call():
                return self._call(node, scope)
            case tree.Aggregate():
                return self._aggregate(node, scope)
            case tree.Choice():
                return _common(self._alternatives(node, scope))
            case tree.List():
                return ListOf(_common([self._shape(each, scope) for each in node.elements]))
        return None

    def _value(self, argument: Argument, scope: Scope) -> Shape | None:
        """Return the shape of a column or argument; unknown if it is aggregated."""
        if isinstance(argument.value, tree.Aggregation):
            self._shape(argument.value.argument, scope)
            return None
        return self._shape(argument.value, scope)

    def _alternatives(self, node: Expression, scope: Scope) -> list[Shape | None]:
        if not isinstance(node, tree.Choice):
            return [self._shape(node, scope)]
        shapes = []
        for branch in node.branches:
            self._shape(branch.condition, scope)
            shapes.append(self._shape(branch.value, scope))
        return [*shapes, self._shape(node.otherwise, scope)]

    def _field(self, node: tree.FieldAccess, scope: Scope) -> Shape | None:
        shape = self._shape(node.record, scope)
        name = node.field
        if isinstance(shape, Record):
            self._check_field(name, shape)
            return shape.fields.get(name)
        if isinstance(shape, ListOf):
            hint = f"Take its elements one by one: x in {self._source(node.record)}, x.{name}."
            self._report(name, f"{shape.title} is a list; it has no field {name}", hint)
        elif isinstance(shape, Scalar):
            hint = "It is a plain value; only records have fields."
            self._report(name, f"{shape.title} has no field {name}", hint)
        return None

    def _call(self, node: tree.Call, scope: Scope) -> Shape | None:
        given = []
        for argument in node.arguments:
            shape = self._value(argument, scope)
            given.append(shape)
            self._give(node.name, argument.field, shape)
        if node.name not in self._definitions:
            if node.name == "Element" and given and isinstance(given[0], ListOf):
                return given[0].element
            if node.name in _SAME and given:
                return given[0]
        return self._columns.get((node.name, VALUE))

    def _aggregate(self, node: tree.Aggregate, scope: Scope) -> Shape | None:
        inner = self._scope(node.body, scope)
        shape = self._shape(node.argument, inner)
        self._give(node.operator, 0, None)
        if node.operator in self._definitions:
            return None
        if node.operator in _COLLECTING:
            return ListOf(shape)
        pair = node.argument
        if node.operator in _CHOOSING and isinstance(pair, tree.Call) and pair.name == "->":
            return self._value(pair.arguments[0], inner)
        return None

    def _give(self, name: str, argument: int | str, shape: Shape | None) -> None:
        if isinstance(argument, str) and (found := re.fullmatch(r"col(\d+)", argument)):
            argument = int(found.group(1))
        self._given.setdefault((name, argument), []).append(shape)

    # -- reports -------------------------------------------------------------------------------

    def _check_field(self, name: int | str, shape: Record) -> None:
        if not isinstance(name, str) or name in shape.fields:
            return
        close = closest(name, shape.fields, 0.6)
        hint = f"Did you mean {close}?" if close else f"It has {', '.join(shape.fields)}."
        if len(hint) > 120:
            hint = "Compare with its definition."
        self._report(name, f"{shape.title} has no field {name}", hint)

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


def _common(shapes: list[Shape | None]) -> Shape | None:
    first = shapes[0] if shapes else None
    return first if all(shape == first for shape in shapes) else None
