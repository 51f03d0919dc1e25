"""Fields that certainly do not exist, found by tracing shapes through the rules.

The shape of a variable is known if it comes from `Sensor`, from a record in the text, or from a
column or argument that has the same shape wherever it is defined or passed. All other shapes are
unknown, and nothing is reported about them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, TypeAlias

from logical_robots_tui.mind.checking.shapes import SENSOR, ListOf, Record, Scalar, Shape
from logical_robots_tui.mind.compiling.rules import head_name, heads, mentioned_by_make, value_of
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.similar_names import closest
from logical_robots_tui.mind.source_text import diagnostic_for

if TYPE_CHECKING:
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic

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
    """The known shapes of a program's values."""

    def __init__(self, rules: list[Rule], text: str, doubtful: frozenset[str]) -> None:
        self._text = text
        self._heads = heads(rules)
        self._rules = [rule for rule in rules if not head_name(rule).startswith("@")]
        made = {n for rule in rules if head_name(rule) == "@Make" for n in mentioned_by_make(rule)}
        self._unknown = doubtful | made
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
        """Return diagnostics for fields that certainly do not exist."""
        return list(self._problems.values())

    def column(self, predicate: str, name: str) -> list[Shape | None]:
        """Return the shapes of a column in each rule of a predicate."""
        found = []
        for rule in self._heads.get(predicate, []):
            for fv in rule["head"]["record"]["field_value"]:
                if fv["field"] == name and (expression := value_of(fv)) is not None:
                    found += self._alternatives(expression, self._scope(rule, {}))
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
            name = head_name(rule)
            scope = self._scope(rule, self._parameters(rule))
            for fv in rule["head"]["record"]["field_value"]:
                shape = self._shape(value_of(fv) or fv["value"]["aggregation"]["argument"], scope)
                aggregated = value_of(fv) is None
                columns.setdefault((name, fv["field"]), []).append(None if aggregated else shape)
        for column, shapes in columns.items():
            if column[0] not in self._unknown:
                self._columns[column] = _common(shapes)
        unknown = self._unknown | {name for name, field in self._given if field == "*"}
        self._arguments = {
            column: _common(shapes)
            for column, shapes in self._given.items()
            if column[0] not in unknown
        }

    def _parameters(self, rule: Rule) -> Scope:
        """Return the known shapes of a function's arguments, from all its calls."""
        scope: Scope = {}
        for fv in rule["head"]["record"]["field_value"]:
            expression = value_of(fv)
            if expression and "variable" in expression:
                shape = self._arguments.get((head_name(rule), fv["field"]))
                if shape is not None:
                    scope[expression["variable"]["var_name"]] = shape
        return scope

    def _scope(self, rule: Rule, outer: Scope) -> Scope:
        """Return the known shapes of the variables of a rule or aggregate."""
        scope = dict(outer)
        if "body" in rule:
            before: Scope | None = None
            while scope != before:
                before = dict(scope)
                self._proposition(rule["body"], scope)
        return scope

    def _proposition(self, node: Rule, scope: Scope) -> None:
        self._steps += 1
        if self._steps > _MOST_STEPS:
            raise _TooManyStepsError
        if "conjunction" in node:
            for conjunct in node["conjunction"]["conjunct"]:
                self._proposition(conjunct, scope)
        elif "disjunction" in node:
            for disjunct in node["disjunction"]["disjunct"]:
                self._scope({"body": disjunct}, scope)
        elif "unification" in node:
            sides = node["unification"]
            self._equal(sides["left_hand_side"], sides["right_hand_side"], scope)
        elif "inclusion" in node:
            self._element(node["inclusion"], scope)
        elif "predicate" in node:
            self._condition(node["predicate"], scope)

    def _condition(self, call: Rule, scope: Scope) -> None:
        name, arguments = call["predicate_name"], call["record"]["field_value"]
        if name in ("=", "==") and len(arguments) == 2:
            self._equal(value_of(arguments[0]), value_of(arguments[1]), scope)
            return
        for fv in arguments:
            expression = value_of(fv)
            if expression is None:
                continue
            self._bind(expression, self._columns.get((name, fv["field"])), scope)
            self._give(name, fv["field"], self._shape(expression, scope))

    def _equal(self, left: Rule | None, right: Rule | None, scope: Scope) -> None:
        if left is not None and right is not None:
            self._bind(left, self._shape(right, scope), scope)
            self._bind(right, self._shape(left, scope), scope)

    def _element(self, inclusion: Rule, scope: Scope) -> None:
        shape = self._shape(inclusion["list"], scope)
        literal = inclusion["list"].get("literal", {})
        if isinstance(shape, ListOf):
            self._bind(inclusion["element"], shape.element, scope)
        elif "the_number" in literal or "the_string" in literal:
            heritage = inclusion["list"]["expression_heritage"]
            self._report(heritage, f"{_source(inclusion['list'])} is not a list", _LIST)
        elif shape is not None:
            heritage = inclusion["list"]["expression_heritage"]
            message = f"{shape.title} is {_kind(shape)}, not a list"
            self._report(heritage, message, _LIST)
        self._shape(inclusion["element"], scope)

    def _bind(self, pattern: Rule, shape: Shape | None, scope: Scope) -> None:
        """Record the shape of a variable, or of a record of variables."""
        if shape is None:
            return
        if "variable" in pattern:
            name = pattern["variable"]["var_name"]
            if name not in scope:
                scope[name] = shape
            elif scope[name] is not None and scope[name] != shape:
                scope[name] = None
        elif "record" in pattern and isinstance(shape, Record):
            for fv in pattern["record"]["field_value"]:
                self._check_field(fv["field"], shape)
                if expression := value_of(fv):
                    self._bind(expression, shape.fields.get(fv["field"]), scope)

    # -- expressions ---------------------------------------------------------------------------

    def _shape(self, node: Rule, scope: Scope) -> Shape | None:
        """Return the shape of an expression, or None if uncertain; visits all its parts."""
        if "variable" in node:
            return scope.get(node["variable"]["var_name"])
        if "record" in node:
            parts = {fv["field"]: self._value(fv, scope) for fv in node["record"]["field_value"]}
            names = tuple(name for name in parts if isinstance(name, str))
            return None if "*" in parts else Record(parts, names=names)
        if "subscript" in node:
            return self._subscript(node["subscript"], scope)
        if "call" in node:
            return self._call(node["call"], scope)
        if "combine" in node:
            return self._combine(node["combine"], scope)
        if "implication" in node:
            return _common(self._branches(node["implication"], scope))
        if "the_list" in node.get("literal", {}):
            elements = [self._shape(e, scope) for e in node["literal"]["the_list"]["element"]]
            return ListOf(_common(elements))
        return None

    def _value(self, fv: Rule, scope: Scope) -> Shape | None:
        expression = value_of(fv)
        return None if expression is None else self._shape(expression, scope)

    def _branches(self, implication: Rule, scope: Scope) -> list[Shape | None]:
        shapes = []
        for branch in implication["if_then"]:
            self._shape(branch["condition"], scope)
            shapes.append(self._shape(branch["consequence"], scope))
        return [*shapes, self._shape(implication["otherwise"], scope)]

    def _alternatives(self, node: Rule, scope: Scope) -> list[Shape | None]:
        if "implication" in node:
            return self._branches(node["implication"], scope)
        return [self._shape(node, scope)]

    def _subscript(self, subscript: Rule, scope: Scope) -> Shape | None:
        shape = self._shape(subscript["record"], scope)
        name = subscript["subscript"]["literal"]["the_symbol"]["symbol"]
        if isinstance(shape, Record):
            self._check_field(name, shape)
            return shape.fields.get(name)
        if isinstance(shape, ListOf):
            hint = f"Take its elements one by one: x in {_source(subscript['record'])}, x.{name}."
            self._report(name, f"{shape.title} is a list; it has no field {name}", hint)
        elif isinstance(shape, Scalar):
            hint = "It is a plain value; only records have fields."
            self._report(name, f"{shape.title} has no field {name}", hint)
        return None

    def _call(self, call: Rule, scope: Scope) -> Shape | None:
        name, arguments = call["predicate_name"], call["record"]["field_value"]
        given = []
        for fv in arguments:
            shape = self._value(fv, scope)
            given.append(shape)
            self._give(name, fv["field"], shape)
        if name not in self._heads:
            if name == "Element" and given and isinstance(given[0], ListOf):
                return given[0].element
            if name in _SAME and given:
                return given[0]
        return self._columns.get((name, VALUE))

    def _combine(self, combine: Rule, scope: Scope) -> Shape | None:
        inner = self._scope(combine, scope)
        aggregation = combine["head"]["record"]["field_value"][0]["value"]["aggregation"]
        name, argument = aggregation["operator"], aggregation["argument"]
        shape = self._shape(argument, inner)
        self._give(name, 0, None)
        if name in self._heads:
            return None
        if name in _COLLECTING:
            return ListOf(shape)
        if name in _CHOOSING and argument.get("call", {}).get("predicate_name") == "->":
            chosen = value_of(argument["call"]["record"]["field_value"][0])
            return None if chosen is None else self._shape(chosen, inner)
        return None

    def _give(self, name: str, argument: int | str, shape: Shape | None) -> None:
        """Record the shape of an argument in a call."""
        if isinstance(argument, str) and (found := re.fullmatch(r"col(\d+)", argument)):
            argument = int(found.group(1))
        self._given.setdefault((name, argument), []).append(shape)

    # -- reports -------------------------------------------------------------------------------

    def _check_field(self, name: Any, shape: Record) -> None:
        if not isinstance(name, str) or name in shape.fields:
            return
        known = [n for n in shape.fields if isinstance(n, str)]
        close = closest(name, known, 0.6)
        hint = f"Did you mean {close}?" if close else f"It has {', '.join(known)}."
        if len(hint) > 120:
            hint = "Compare with its definition."
        self._report(name, f"{shape.title} has no field {name}", hint)

    def _report(self, piece: str, message: str, hint: str) -> None:
        start = getattr(piece, "start", None)
        if start is not None and len(hint) <= 120:
            self._problems[start] = diagnostic_for(self._text, piece, message, hint)


def _common(shapes: list[Shape | None]) -> Shape | None:
    """Return the shape that all share, or None."""
    first = shapes[0] if shapes else None
    return first if all(shape == first for shape in shapes) else None


def _kind(shape: Shape) -> str:
    return "a record" if isinstance(shape, Record) else "a plain value"


def _source(record: Rule) -> str:
    text = " ".join(str(record.get("expression_heritage", "list")).split())
    return text if len(text) <= 40 else "the list"
