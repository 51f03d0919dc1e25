"""Fields that do not exist and types that do not fit, found by tracing kinds through the rules.

A variable's kind is known if it comes from `Sensor`, a literal, a built-in function, or a column or
argument that has the same kind everywhere. What is read from a memory is not; which fields a memory
may have is known if each rule of `Robot` returns a record, "" or the memory.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import TypeAlias

from logical_robots_tui.language import tree, types
from logical_robots_tui.language.adapter import operator_name
from logical_robots_tui.language.definitions import Model, names_used, rules_of
from logical_robots_tui.language.diagnostics import (
    Diagnostic,
    Mention,
    Proposal,
    Severity,
    closest,
    name_hint,
)
from logical_robots_tui.language.tree import Argument, Expression, Name, Rule
from logical_robots_tui.language.types import Kind, ListOf, Plain, RecordOf, Word, clash, describe
from logical_robots_tui.schema import MAIN, OBJECTS, VALUE

_ROUNDS = 6  # how far a kind is traced from predicate to predicate
_MOST_STEPS = 100_000  # nested aggregates are visited repeatedly
_MOST_COMPARED = 20  # different types of a column
_LIST = "A list is needed here, such as sensor.radar, [1, 2] or Range(10)."
_NEGATED = "Put the condition after ! in parentheses: !(a == b)."
_CHOOSING = frozenset({"ArgMin", "ArgMax"})
_OF_PAIRS = {
    "Array": "order -> value",
    "WeightedAverage": "weight -> value",
    **dict.fromkeys(("ArgMax", "ArgMaxK", "ArgMin", "ArgMinK"), "what -> value"),
}
_LITERALS: Mapping[type[tree.Node], Kind] = {
    tree.Boolean: Plain.TRUTH,
    tree.Null: Plain.NULL,
    tree.Number: Plain.REAL,
    tree.Text: Plain.TEXT,
}

_MEMORY = ("Memory", "memory")

Scope: TypeAlias = "dict[str, Kind]"
Column: TypeAlias = tuple[str, "int | str"]


class _TooManyStepsError(Exception):
    """The program is too complex to trace."""


class Inference:
    def __init__(self, model: Model) -> None:
        self._model, self._text, self._definitions = model, model.text, model.definitions
        # What functors make, copy, substitute or put in is of any kind.
        self._unknown = model.doubtful | model.substituted | {*names_used(model.functors)}
        self._columns: dict[Column, Kind] = {
            ("Sensor", "robot_name"): types.ROBOT_NAME,
            ("Sensor", "sensor"): types.SENSED,
            ("Memory", "robot_name"): types.ROBOT_NAME,
            _MEMORY: types.Remembered(),
        }
        self._arguments: dict[Column, Kind] = {}
        self._argument_kinds: dict[Column, list[Kind]] = {}
        self._problems: dict[int, Diagnostic] = {}
        self._mentions: dict[int, Mention] = {}
        self._steps = 0
        if not self._settle():
            self._problems.clear()
            self._mentions.clear()
            self._columns.clear()
            self._arguments.clear()

    @property
    def problems(self) -> list[Diagnostic]:
        """Diagnostics for fields that certainly do not exist, and for types that do not fit."""
        return list(self._problems.values())

    @property
    def mentions(self) -> tuple[Mention, ...]:
        """The names that labels and robots' names are compared with, in text order."""
        return tuple(self._mentions[start] for start in sorted(self._mentions))

    def column(self, predicate: str, name: str) -> list[Kind]:
        kinds: list[Kind] = []
        for rule in rules_of(self._definitions.get(predicate, ())):
            for column in rule.head.columns:
                if column.field == name and column.expression is not None:
                    scope = self._scope(rule.body, {})
                    kinds += self._alternatives(column.expression, scope)
        return kinds

    # -- through all rules ---------------------------------------------------------------------

    def _settle(self) -> bool:
        """Visit the rules until no type changes; return False if that takes too long."""
        for _ in range(_ROUNDS):
            previous = (dict(self._columns), dict(self._arguments))
            self._problems.clear()
            self._mentions.clear()
            self._argument_kinds.clear()
            try:
                self._go_through_rules()
            except _TooManyStepsError:
                return False
            if previous == (self._columns, self._arguments):
                return True
        return False

    def _go_through_rules(self) -> None:
        columns: dict[Column, dict[Kind, None]] = {}
        memory = self._columns[_MEMORY]
        for rule in self._model.rules:
            scope = self._scope(rule.body, self._parameters(rule))
            for column in rule.head.columns:
                kind = self._value(column, scope)
                earlier = columns.setdefault((rule.name, column.field), {})
                self._check_column(rule, column, kind, earlier)
                earlier[kind] = None
                if (rule.name, column.field) == (MAIN, "memory"):
                    is_empty = tree.text_of(column.expression) == ""
                    values = column.expression and self._alternatives(column.expression, scope)
                    memory = memory if is_empty else types.remember(memory, values or [kind])
        for place, kinds in columns.items():
            if place[0] not in self._unknown:
                self._columns[place] = types.common(kinds)
        is_complete = not self._unknown & {MAIN, "Memory"} and memory != types.Remembered()
        self._columns[_MEMORY] = memory if is_complete else Plain.ANY
        unknown = self._unknown | {
            name for name, field in self._argument_kinds if field == tree.REST
        }
        self._arguments = {
            place: types.common(kinds)
            for place, kinds in self._argument_kinds.items()
            if place[0] not in unknown
        }

    def _parameters(self, rule: Rule) -> Scope:
        scope: Scope = {}
        for column in rule.head.columns:
            if isinstance(column.value, tree.Variable):
                kind = self._arguments.get((rule.name, column.field))
                if kind not in (None, Plain.ANY, Plain.NULL):
                    scope[column.value.name] = kind
        return scope

    def _scope(self, body: tree.Proposition | None, outer: Mapping[str, Kind]) -> Scope:
        scope = dict(outer)
        previous: Scope | None = None
        while body is not None and scope != previous:
            previous = dict(scope)
            self._proposition(body, scope)
        return scope

    def _proposition(self, node: tree.Proposition, scope: Scope) -> None:
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
                kind = self._kind(node.collection, scope)
                if isinstance(kind, ListOf):
                    self._bind(node.element, kind.element, scope)
                    self._mention_elements(node.collection, self._kind(node.element, scope))
                elif message := self._no_list(node.collection, kind):
                    is_literal = isinstance(node.collection, tree.Number | tree.Text)
                    severity = "error" if is_literal else _severity(kind)
                    if node.collection.span:
                        span = node.collection.span
                        problem = self._model.diagnostic(span, message, _LIST, severity)
                        self._problems[span.start] = problem
                self._kind(node.element, scope)
            case tree.Atom():
                self._condition(node, scope)

    def _condition(self, atom: tree.Atom, scope: Scope) -> None:
        if atom.name in ("=", "==") and len(atom.arguments) == 2:
            left, right = tree.operands(atom.arguments)
            self._equal(left, right, scope)
            return
        if atom.name in types.FUNCTIONS and atom.name not in self._definitions:
            self._built_in(atom, scope)
            return
        for argument in atom.arguments:
            if argument.expression is not None:
                kind = self._columns.get((atom.name, argument.field), Plain.ANY)
                self._bind(argument.expression, kind, scope)
                self._give(atom.name, argument.field, self._kind(argument.expression, scope))

    def _equal(self, left: Expression, right: Expression, scope: Scope) -> None:
        first, second = self._kind(left, scope), self._kind(right, scope)
        if clash(first, second):
            self._check_comparison(left, right, first, second)
        else:
            self._bind(left, second, scope)
            self._bind(right, first, scope)

    def _no_list(self, node: Expression, kind: Kind) -> str:
        """Return a message if an expression that has to be a list can't be one; else ""."""
        subject = self._source(node, "The list")
        if isinstance(node, tree.Number | tree.Text):
            return f"{subject} is not a list"
        if isinstance(kind, RecordOf):
            return f"{kind.title} is a record, not a list"
        return f"{subject} is a plain value, not a list" if _is_scalar(kind) else ""

    def _bind(self, pattern: Expression, kind: Kind, scope: Scope) -> None:
        if kind in (Plain.ANY, Plain.NULL):
            return
        if isinstance(pattern, tree.Variable) and pattern.name not in scope:
            scope[pattern.name] = kind
        elif isinstance(pattern, tree.Record) and isinstance(kind, RecordOf):
            for argument in pattern.arguments:
                self._check_field(argument.field, kind)
                if argument.expression:
                    self._bind(argument.expression, kind.field(str(argument.field)), scope)
        else:
            current = self._kind(pattern, scope)
            if clash(current, kind):
                subject = self._source(pattern, "This")
                message = f"{subject} is {describe(current)}; {describe(kind)} is needed here"
                is_negated = isinstance(pattern, tree.Call) and pattern.name == "!"
                self._warn(
                    pattern,
                    message,
                    _NEGATED if is_negated else types.repair(pattern, kind, current),
                )
            self._mention(pattern, kind)
            if isinstance(pattern, tree.Variable):
                scope[pattern.name] = types.meet(current, kind)

    # -- expressions ---------------------------------------------------------------------------

    def _kind(self, node: Expression, scope: Scope) -> Kind:
        match node:
            case tree.Variable():
                return scope.get(node.name, Plain.ANY)
            case tree.Record():
                parts = {
                    argument.field: self._value(argument, scope) for argument in node.arguments
                }
                if tree.REST in parts:
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
                return types.common(self._alternatives(node, scope))
            case tree.List():
                kinds = [self._kind(element, scope) for element in node.elements]
                self._check_alike("This list", node.elements, kinds)
                return ListOf(types.common(kinds))
        return _LITERALS.get(type(node), Plain.ANY)

    def _value(self, argument: Argument, scope: Scope) -> Kind:
        """Return the kind of a column or argument; unknown if it is aggregated."""
        if isinstance(argument.value, tree.Aggregation):
            kind = self._kind(argument.value.argument, scope)
            self._check_sum(operator_name(argument.value.operator), argument.value.argument, kind)
            return Plain.ANY
        return self._kind(argument.value, scope)

    def _alternatives(self, node: Expression, scope: Scope) -> list[Kind]:
        if not isinstance(node, tree.Choice):
            return [self._kind(node, scope)]
        for branch in node.branches:
            self._kind(branch.condition, scope)
        values = [*(branch.value for branch in node.branches), node.otherwise]
        kinds = [self._kind(value, scope) for value in values]
        self._check_alike("This if", values, kinds)
        return kinds

    def _field(self, node: tree.FieldAccess, scope: Scope) -> Kind:
        kind = self._kind(node.record, scope)
        name = node.field
        if isinstance(kind, RecordOf | types.Remembered):
            self._check_field(name, kind)
            return kind.field(name) if isinstance(kind, RecordOf) else Plain.ANY
        if isinstance(kind, ListOf):
            hint = f"Take its elements one by one: x in {self._source(node.record)}, x.{name}."
            self._report(name, f"{kind.title} is a list; it has no field {name}", hint)
        elif _is_scalar(kind):
            hint = "It is a plain value; only records have fields."
            message = f"{self._source(node.record, 'The list')} has no field {name}"
            self._report(name, message, hint, _severity(kind))
        return Plain.ANY

    def _call(self, node: tree.Call, scope: Scope) -> Kind:
        if node.name not in self._definitions and (
            node.name in types.FUNCTIONS or node.name in types.ALIKE
        ):
            return self._built_in(node, scope)
        kinds = [self._value(argument, scope) for argument in node.arguments]
        for argument, kind in zip(node.arguments, kinds, strict=True):
            self._give(node.name, argument.field, kind)
        if node.name not in self._definitions:
            return types.result_of(node.name, kinds)
        return self._columns.get((node.name, VALUE), Plain.ANY)

    def _aggregate(self, node: tree.Aggregate, scope: Scope) -> Kind:
        inner = self._scope(node.body, scope)
        kind = self._kind(node.argument, inner)
        self._give(node.operator, 0, Plain.ANY)
        if node.operator in self._definitions:
            return Plain.ANY
        operator = operator_name(node.operator)
        self._check_sum(operator, node.argument, kind)
        pair = node.argument
        if operator in _CHOOSING and isinstance(pair, tree.Call) and pair.name == "->":
            return self._value(pair.arguments[0], inner)
        return types.result_of(operator, [kind])

    def _give(self, name: str, argument: int | str, kind: Kind) -> None:
        if isinstance(argument, str) and (match := re.fullmatch(r"col(\d+)", argument)):
            argument = int(match.group(1))
        self._argument_kinds.setdefault((name, argument), []).append(kind)

    def _built_in(self, node: tree.Call | tree.Atom, scope: Scope) -> Kind:
        """Return the kind of a built-in function or operator, and check its arguments."""
        operands = tree.operands(node.arguments)
        kinds = [self._kind(operand, scope) for operand in operands]
        if node.name in types.COMPARISONS | {"=="} and len(operands) == 2:
            self._check_comparison(*operands, *kinds)
        elif node.name == "in" and isinstance(list_kind := kinds[-1], ListOf):
            self._check_comparison(operands[0], operands[1], kinds[0], list_kind.element)
            self._mention_elements(operands[1], kinds[0])
        elif node.name in types.ALIKE:
            joined = [
                # Numbers and Booleans that are computed can be joined to a text.
                kind
                if types.is_nested(kind) or types.is_text(kind) or isinstance(operand, tree.Literal)
                else Plain.ANY
                for operand, kind in zip(operands, kinds, strict=True)
            ]
            self._check_alike(node.name, operands, joined if node.name == "++" else kinds)
        elif node.name in types.ARITHMETIC:
            for argument, kind in zip(operands, kinds, strict=True):
                self._check_number(node.name, argument, kind)
        elif node.name in types.FUNCTIONS:
            for index, (argument, kind) in enumerate(zip(operands, kinds, strict=True)):
                if clash(kind, expected := types.FUNCTIONS[node.name].argument(index)):
                    message = f"{describe(kind)}; {node.name} takes {describe(expected)}"
                    message = f"{self._source(argument, 'This')} is {message}"
                    hint = _NEGATED if node.name == "!" else types.repair(argument, expected, kind)
                    self._warn(argument, message, hint)
        return types.result_of(node.name, kinds)

    # -- types that do not fit -----------------------------------------------------------------

    def _check_comparison(
        self, left: Expression, right: Expression, first: Kind, second: Kind
    ) -> None:
        if clash(first, second):
            node = left if isinstance(left, tree.Literal) else right
            message = f"{describe(first).replace('a', 'A', 1)} is compared with {describe(second)}"
            if types.family(first) == types.family(second) == "record":
                message = "These records have fields of different types"
            expected, actual = (second, first) if node is left else (first, second)
            hint = self._operator_hint(left, right) or types.repair(node, expected, actual)
            self._warn(node, message, hint)
        self._mention(left, second)
        self._mention(right, first)

    def _operator_hint(self, left: Expression, right: Expression) -> str:
        """Return how to write ``!a == b`` or ``a < b < c``, or "" for other comparisons."""
        if not isinstance(left, tree.Call):
            return ""
        if left.name == "!":
            return _NEGATED
        if left.name not in types.COMPARISONS or len(left.arguments) < 2:
            return ""
        first, middle = map(self._source, tree.operands(left.arguments))
        return f"Compare twice: {first} with {middle}, and {middle} with {self._source(right)}."

    def _check_alike(self, name: str, nodes: Sequence[Expression], kinds: Sequence[Kind]) -> None:
        for index, (node, kind) in enumerate(zip(nodes, kinds, strict=True)):
            clashing = next((earlier for earlier in kinds[:index] if clash(earlier, kind)), None)
            if clashing is not None:
                message = f"{name} mixes {describe(clashing)} and {describe(kind)}"
                expected, actual = (kind, clashing) if types.is_text(kind) else (clashing, kind)
                self._warn(node, message, types.repair(node, expected, actual))
                return

    def _check_number(self, name: str, node: Expression, kind: Kind) -> None:
        if not clash(kind, Plain.REAL):
            return
        is_word = isinstance(node, tree.Text) and not types.is_numeral(node)
        message = f"{self._source(node, 'This')} is {describe(kind)}; {name} computes with numbers"
        hint = types.repair(node, Plain.REAL, kind)
        if is_word or isinstance(kind, ListOf):
            hint = f"++ joins {types.family(kind)}s."
        self._warn(node, message, hint, "error" if is_word or types.is_nested(kind) else "warning")

    def _check_sum(self, operator: str, node: Expression, kind: Kind) -> None:
        if operator in _OF_PAIRS and operator not in self._definitions:
            is_misread = isinstance(node, tree.Call) and node.name in tree.JUNCTIONS
            if (_is_scalar(kind) or isinstance(kind, ListOf)) and not is_misread:
                message = (
                    f"{operator} takes pairs; {self._source(node, 'this')} is {describe(kind)}"
                )
                self._warn(node, message, f"Write {operator}{{{_OF_PAIRS[operator]} :- ...}}.")
        elif operator in types.ARITHMETIC or operator == "Agg+":
            self._check_number("Sum" if operator == "Agg+" else operator, node, kind)

    def _check_column(
        self, rule: Rule, column: Argument, kind: Kind, earlier: Iterable[Kind]
    ) -> None:
        if (rule.name, column.field) == (MAIN, "memory"):
            return  # what a robot remembers can be of another type at any time
        compared = islice(earlier, _MOST_COMPARED)
        clashing = next((k for k in compared if clash(k, kind)), None)
        if clashing is not None and column.expression is not None:
            place = column.field + 1 if isinstance(column.field, int) else column.field
            name = "The value" if place == VALUE else f"Column {place}"
            message = f"{name} of {rule.name} is {describe(kind)} here"
            message += f", and {describe(clashing)} elsewhere"
            self._warn(column.expression, message, "Give it one type in all rules.")

    def _mention(self, node: Expression, kind: Kind) -> None:
        """Note the name that a sensed text is compared with."""
        if not isinstance(node, tree.Text) or not isinstance(kind, Word) or not node.span:
            return
        if kind != types.OBJECT:
            place = self._model.diagnostic(node.span, "", severity="warning")
            self._mentions[node.span.start] = Mention(node.value, kind.field, place, node.span)
        elif node.value not in OBJECTS:
            self._warn(node, f'A ray hits no "{node.value}"', name_hint(node.value, OBJECTS))

    def _mention_elements(self, collection: Expression, kind: Kind) -> None:
        for element in collection.elements if isinstance(collection, tree.List) else ():
            self._mention(element, kind)

    def _warn(
        self, node: Expression, message: str, hint: str, severity: Severity = "warning"
    ) -> None:
        if span := tree.span_of(node):
            problem = self._model.diagnostic(span, message, hint, severity)
            self._problems.setdefault(span.start, problem)

    # -- reports -------------------------------------------------------------------------------

    def _check_field(self, name: int | str, kind: RecordOf | types.Remembered) -> None:
        if isinstance(kind, types.Remembered):
            names = sorted(kind.fields)
            severity: Severity = "warning"
            message = f"No rule of Robot puts {name} into memory"
        else:
            names = [field for field, _ in kind.fields]
            severity, message = "error", f"{kind.title} has no field {name}"
        if not isinstance(name, str) or name in names:
            return
        close = closest(name, names, 0.6)
        hint = Proposal(close) if close else f"It has {', '.join(names)}."
        if len(hint) > 120:
            hint = "Compare with its definition."
        self._report(name, message, hint, severity)

    def _report(self, name: str, message: str, hint: str, severity: Severity = "error") -> None:
        if isinstance(name, Name) and name.start >= 0 and len(hint) <= 120:
            self._problems[name.start] = self._model.diagnostic(name, message, hint, severity)

    def _source(self, node: Expression, otherwise: str = "the list") -> str:
        """Return the text of an expression, if it is short."""
        text = " ".join(self._text[slice(*node.span)].split()) if node.span else otherwise
        return text if len(text) <= types.LONGEST else otherwise


def _severity(kind: Kind) -> Severity:
    """Return how wrong it is to take a plain value apart; a text may hold a list or a record."""
    return "warning" if kind is Plain.TEXT else "error"


def _is_scalar(kind: Kind) -> bool:
    return not types.is_nested(kind) and kind not in (Plain.ANY, Plain.NULL)
