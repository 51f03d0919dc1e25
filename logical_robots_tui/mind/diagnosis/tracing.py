"""Queries for all that a rule does: its parts, its conditions, the functions that it asks.

In the compile process. What a function does depends on what it is given. So its conditions are
looked at where it is asked, with the arguments in the place of its parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from logical_robots_tui.mind.compiling.rules import CONDITIONS, JUNCTIONS, VALUE, value_of
from logical_robots_tui.mind.diagnosis.expressions import (
    ORDERING,
    as_expression,
    as_part,
    compared,
    counted,
    difference,
    equated,
    field_of,
    filled,
    is_null,
    operands,
    parameters,
    text_of,
)
from logical_robots_tui.mind.diagnosis.sites import TESTS, Column, Field, Probe, Site, Span
from logical_robots_tui.mind.diagnosis.sources import Sources
from logical_robots_tui.mind.program import INPUTS
from logical_robots_tui.mind.why import sides, trees
from logical_robots_tui.mind.why.scopes import Scope, flat, in_order, names
from logical_robots_tui.mind.why.spans import span_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.text import Prepared

__all__ = ["PROBE", "Tracer"]

PROBE = "DiagnosisProbe"
"""What the names of the predicates begin with that are made to be asked."""

_MOST_COLUMNS = 90  # of a probe; SQLite allows 100
_DEEPEST = 8  # functions in functions
_NOT_VALUES = frozenset({"TryCast"})  # the second argument is a type

_EXPLAINED = (*TESTS, "leaf")

_LEAVES = ("desire", VALUE)
"""Columns of which is watched where an ``if`` takes their values from."""

Stands = Literal["body", "aggregate", "denied"]

Guard = tuple[tuple[int, bool], ...]


@dataclass
class _Segment:
    """What is asked at once: a body up to a part that gives rows, and what is tested there.

    Attributes:
        body: What all rows fulfil.
        columns: What is tested.
        trees: The same as conditions.
        asked: By column what is asked in the query.
        differences: By column the difference of the two sides that it compares.
        after: Number of the site of the part at its end, or -1.
    """

    body: list[Rule]
    after: int = -1
    columns: list[Column] = field(default_factory=list)
    trees: list[Rule] = field(default_factory=list)
    asked: dict[int, Sequence[Rule]] = field(default_factory=dict)
    differences: dict[int, Rule] = field(default_factory=dict)


@dataclass
class _Trail:
    """How far a body has been gone through; changes on the way.

    Attributes:
        segment: The present one.
        filters: Its columns that must be true.
        probes: Names of those that were made.
    """

    segment: _Segment
    filters: tuple[int, ...] = ()
    probes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _At:
    """Where an expression is computed.

    Attributes:
        trail: The body around it.
        rule: Number of the rule that it is written in.
        scope: Its variables.
        known: Those that have a value.
        given: By variable what it stands for in the query.
        guard: What holds there beside the filters.
        inside: Names of the functions that it is in.
        stands: Whether that is in the body of a rule, an aggregate or something that is denied.
    """

    trail: _Trail
    rule: int
    scope: Scope
    known: frozenset[str]
    given: Mapping[str, Rule]
    guard: Guard = ()
    inside: tuple[str, ...] = ()
    stands: Stands = "body"

    def when(self, column: int, *, holds: bool) -> _At:
        """The same where a column is true, or is not."""
        return replace(self, guard=(*self.guard, (column, holds)))


class Tracer:
    """Collects the sites of rules and the predicates to be compiled for them.

    Args:
        text: The program.
        source: The same, prepared.
        own: The rules of the program's own predicates.
        functions: Names of those that have rows only for given arguments.
        rules: All of these rules; their places here are their numbers.

    Attributes:
        sites: What is watched.
        probes: By name the rule of a predicate to be asked, and what it tells.
        reads: Fields of memory that are read.
        reads_all: Whether a memory is used as a whole.
        left_out: How much there was too much of.
        within: The predicate made with ``:=`` in whose rules is looked, or "".
    """

    def __init__(
        self,
        text: str,
        source: Prepared,
        own: Mapping[str, list[Rule]],
        functions: frozenset[str],
        rules: Sequence[Rule],
    ) -> None:
        self.sites: list[Site] = []
        self.probes: dict[str, tuple[Rule, Probe]] = {}
        self.reads: dict[tuple[str, int], Field] = {}
        self.reads_all = False
        self.left_out = 0
        self.within = ""
        self._text, self._source = text, source
        self._own, self._functions, self._rules = own, functions, rules
        self._numbers = {id(rule): number for number, rule in enumerate(rules)}
        self._sources = Sources(text, source, own)
        self._known_sites: dict[tuple[Any, ...], int] = {}
        self._memories: set[str] = set()
        self._leaves: set[str] = set()
        self._fresh = 0

    def rule(self, rule: Rule, *, tells_robot: bool) -> None:
        """Trace a rule that has rows of its own.

        Args:
            rule: As it was parsed.
            tells_robot: Whether to tell for which robot it gives a row.
        """
        columns = {fv["field"]: fv["value"] for fv in rule["head"]["record"]["field_value"]}
        head = {sides.column_name(f): v.get("expression") for f, v in columns.items()}
        parts = flat(rule.get("body"))
        heads = [v.get("expression", v.get("aggregation")) for v in columns.values()]
        variables = frozenset[str]().union(*map(names, [*parts, *heads]))
        number = self._numbers[id(rule)]
        self._memories = set()
        decided = (columns[name].get("expression") or {} for name in _LEAVES if name in columns)
        self._leaves = {str(each["variable"]["var_name"]) for each in decided if "variable" in each}
        at = _At(_Trail(_Segment([])), number, Scope(self._functions, variables), frozenset(), {})
        at = self._parts(parts, at)
        if at is None:
            return
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

    # -- bodies --------------------------------------------------------------------------------

    def _parts(self, parts: Sequence[Rule], at: _At) -> _At | None:
        """Go through the parts of a body; None if some can never be asked."""
        ordered, left = in_order(parts, at.scope, at.known)
        for part, known in ordered:
            at = self._part(part, at, known)
        return None if left else at

    def _part(self, part: Rule, at: _At, known: frozenset[str]) -> _At:
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
        site = self._site("part", part, at, predicate=name)
        self._in_part(part, at)
        if name == "Memory":
            for fv in call["record"]["field_value"]:
                variable = (value_of(fv) or {}).get("variable", {})
                if fv["field"] in ("memory", 1) and variable:
                    self._memories.add(self._called(str(variable["var_name"]), at))
        return replace(self._next(at, site, filled(part, at.given)), known=known)

    def _in_part(self, part: Rule, at: _At) -> None:
        """What stands within a part that gives rows."""
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

    def _next(self, at: _At, site: int, part: Rule) -> _At:
        """After a part that gives rows."""
        trail = at.trail
        body = [*self._all_of(at), part]
        self._emit(trail, before=site)
        trail.segment = _Segment(body, site)
        trail.filters = ()
        return replace(at, guard=())

    def _aside(
        self,
        parts: Sequence[Rule],
        at: _At,
        scope: Scope,
        given: Mapping[str, Rule],
        values: Sequence[tuple[Rule, bool]],
        **changed: Any,
    ) -> None:
        """Go through a body that stands within an expression or a part, and what is made of it."""
        trail = _Trail(_Segment(self._all_of(at)))
        within = replace(at, trail=trail, scope=scope, given=given, guard=(), **changed)
        done = self._parts(parts, within)
        for value, is_leaf in values if done is not None else ():
            self._value(value, done, is_leaf=is_leaf)
        self._emit(trail)
        telling = (self.probes[name][1] for name in trail.probes)
        if not any(probe.columns or self._tells(probe) for probe in telling):
            for name in trail.probes:
                del self.probes[name]

    def _tells(self, probe: Probe) -> bool:
        return any(
            at >= 0 and self.sites[at].predicate not in ("", *INPUTS)
            for at in (probe.after, probe.before)
        )

    def _all_of(self, at: _At) -> list[Rule]:
        """All that holds at a place, as parts of a body."""
        segment = at.trail.segment
        guard = [as_part(filled(segment.trees[c], {}), holds=holds) for c, holds in at.guard]
        return [*segment.body, *guard]

    # -- expressions ---------------------------------------------------------------------------

    def _value(self, tree: Rule, at: _At, *, is_leaf: bool = False) -> None:
        """What is in an expression that is computed at a place.

        Args:
            tree: The expression.
            at: The place.
            is_leaf: Whether to watch which value it takes where an ``if`` chooses.
        """
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
            self._add(at, self._site("leaf", tree, at), (), "always")
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
        elif "variable" in tree and self._called(str(tree["variable"]["var_name"]), at) in (
            self._memories
        ):
            self.reads_all = True

    def _nulls(self, tree: Rule, at: _At) -> None:
        """Watch whether what a leaf is computed from is null."""
        waiting = [tree]
        while waiting:
            node = waiting.pop(0)
            name = str(node.get("call", {}).get("predicate_name", ""))
            if "combine" in node or (name in self._functions and "call" in node):
                lacks = is_null(filled(node, at.given))
                self._add(at, self._site("value", node, at), (lacks,), "truth", lacks)
            if "record" in node:
                waiting += operands(node)
            elif "call" in node and name not in _NOT_VALUES:
                waiting += operands(node["call"])

    def _truth(self, condition: Rule, at: _At, kind: Any) -> int:
        """Watch a condition; returns its column, or -1 if there are too many."""
        call = condition.get("call", {})
        name = str(call.get("predicate_name", ""))
        found = compared(condition)
        asked: list[Rule] = [filled(condition, at.given)]
        how, literal, other, lacks = "truth", None, "", None
        if found is not None:
            operator, *both = found
            asked_sides = [filled(side, at.given) for side in both]
            texts = [text_of(side) for side in asked_sides]
            other = self._span(both[0]).text
            if operator in ORDERING:
                lacks = difference(*asked_sides)
            elif operator == "==" and texts.count(None) == 1:
                place = 0 if texts[0] is not None else 1
                how, literal, asked = "text", texts[place], [asked_sides[1 - place]]
                other = self._span(both[1 - place]).text
                if text_of(both[place]) is None:
                    given = self._site("text", asked_sides[place], at, literal=literal, other=other)
                    self._add(at, given, asked, "text")
                    how, literal, asked = "truth", None, [filled(condition, at.given)]
            elif operator == "==" and kind == "condition":
                how, asked = "pair", asked_sides
        site = self._site(
            kind, condition, at, literal=literal, other=other, operator=found[0] if found else ""
        )
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

    def _combine(self, combine: Rule, at: _At) -> None:
        """What an aggregate goes over."""
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
        self._aside(inner, at, at.scope.within(inner), given, values, stands=stands)

    def _function(self, name: str, call: Rule, at: _At, *, is_leaf: bool) -> None:
        """What a function does with what it is given."""
        if name in at.inside or len(at.inside) >= _DEEPEST:
            return
        for rule in self._own.get(name, ()):
            found = self._entered(rule, name, call, at)
            value = _head_value(rule)
            if found is None or value is None:
                continue
            body = flat(rule.get("body"))
            if body:
                self._aside(body, found, found.scope, found.given, [(value, is_leaf)])
            else:
                self._value(value, found, is_leaf=is_leaf)

    def _read(self, subscript: Rule, at: _At) -> None:
        """A field that is taken from a record."""
        record = subscript["record"]
        base = filled(record, at.given)
        while str(base.get("call", {}).get("predicate_name", "")) in ("TryCast", "Coalesce"):
            base = operands(base["call"])[0]
        variable = str(base.get("variable", {}).get("var_name", ""))
        if variable in self._memories:
            symbol = subscript["subscript"]["literal"]["the_symbol"]["symbol"]
            span = self._span(subscript)
            self.reads.setdefault((str(symbol), span.start), Field(field_of(subscript), span))
        else:
            self._value(record, at)

    # -- inside --------------------------------------------------------------------------------

    def _asked(self, name: str, call: Rule, at: _At) -> tuple[Rule, _At] | None:
        """The one rule of a function that stands as a condition, and a place in it."""
        rules = self._own.get(name, [])
        if len(rules) != 1 or name in at.inside or _head_value(rules[0]) is not None:
            return None
        found = self._entered(rules[0], name, call, at)
        return None if found is None else (rules[0], found)

    def _entered(self, rule: Rule, name: str, call: Rule, at: _At) -> _At | None:
        """The place at the beginning of a function's rule that is asked at another place."""
        expected = parameters(rule)
        values = {
            sides.column_name(fv["field"]): value_of(fv) for fv in call["record"]["field_value"]
        }
        if expected is None or id(rule) not in self._numbers:
            return None
        given: dict[str, Rule] = {}
        for place, variable in expected:
            value = values.get(sides.column_name(place))
            if value is None:
                return None
            given[variable] = filled(value, at.given)
        inner = [*flat(rule.get("body")), rule["head"]["record"]]
        scope = Scope(self._functions, frozenset[str]().union(*map(names, inner)))
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

    def _is_condition(self, part: Rule, known: frozenset[str]) -> bool:
        pair = equated(part)
        if pair is not None:
            both = names(pair[0]) | names(pair[1])
            return both <= known and not self._relations(part)
        name = str(part.get("predicate", {}).get("predicate_name", ""))
        is_call = name in self._own or name in INPUTS
        return bool(name) and not is_call and not self._relations(part)

    def _bound(self, part: Rule, known: frozenset[str]) -> tuple[str, Rule] | None:
        """The variable that a part gives a value, and the value; or None."""
        pair = equated(part)
        if pair is None:
            return None
        left, right = pair
        for pattern, value in ((left, right), (right, left)):
            name = str(pattern.get("variable", {}).get("var_name", ""))
            if name and name not in known and names(value) <= known:
                return name, value
        return None

    def _remember(self, name: str, value: Rule, at: _At) -> None:
        """Note that a variable holds a memory, if it does."""
        value = filled(value, at.given)
        while str(value.get("call", {}).get("predicate_name", "")) in ("TryCast", "Coalesce"):
            value = operands(value["call"])[0]
        if str(value.get("variable", {}).get("var_name", "")) in self._memories:
            self._memories.add(self._called(name, at))

    def _relations(self, tree: Any) -> list[Rule]:
        """The calls in a tree of predicates that may have no row, outside of aggregates."""
        own = self._own.keys() - self._functions
        return list(sides.outer_calls(tree, own))

    def _called(self, name: str, at: _At) -> str:
        """What a variable is called in the query, if it is a variable there."""
        value = at.given.get(name)
        return name if value is None else str(value.get("variable", {}).get("var_name", ""))

    def _new(self, name: str) -> str:
        self._fresh += 1
        return f"d{self._fresh}_{name}"

    def _span(self, tree: Any) -> Span:
        return span_of(tree, self._text, self._source)

    def _site(self, kind: Any, tree: Any, at: _At, **told: Any) -> int:
        """The number of a site, the same whenever the place is the same."""
        span = self._span(tree)
        key = (kind, span.start, span.stop, self.within)
        if key not in self._known_sites:
            self._known_sites[key] = len(self.sites)
            rule = self._rules[at.rule]
            places = self._sources.of(tree, rule) if kind in _EXPLAINED else ()
            told = {"within": self.within, "places": places, "stands": at.stands, **told}
            self.sites.append(Site(kind, span, at.rule, **told))
        return self._known_sites[key]

    def _add(
        self,
        at: _At,
        site: int,
        asked: Sequence[Rule],
        kind: Any,
        condition: Rule | None = None,
    ) -> int:
        """Add a column to what is asked at a place; -1 if there are too many."""
        segment = at.trail.segment
        number = len(segment.columns)
        if self._width(segment) + 4 > _MOST_COLUMNS:
            self.left_out += 1
            return -1
        segment.columns.append(Column(site, at.guard, kind))
        segment.trees.append(condition or {})
        if asked:
            segment.asked[number] = asked
        return number

    def _width(self, segment: _Segment) -> int:
        """How many columns the query of a segment has."""
        return 2 + 2 * len(segment.differences) + sum(map(len, segment.asked.values()))

    def _emit(
        self, trail: _Trail, before: int = -1, gives: int = -1, who: Rule | None = None
    ) -> None:
        """Make the predicate that asks what is to be known of a segment."""
        segment = trail.segment
        if not segment.body and not segment.columns and gives < 0:
            return
        told = tuple(segment.columns)
        values = {n for n, column in enumerate(told) if self.sites[column.site].kind == "value"}
        for closer in (False, True) if values else (False,):
            name = f"{PROBE}{self._fresh}"
            self._fresh += 1
            left_out = frozenset[int]() if closer else values
            columns = {
                f"{'cd'[place]}{number}": tree
                for number, asked in segment.asked.items()
                for place, tree in enumerate(asked)
                if number not in left_out
            }
            if who is not None:
                columns["who"] = who
            probe = Probe(
                name,
                tuple(replace(c, kind="skip") if n in left_out else c for n, c in enumerate(told)),
                segment.after,
                before,
                trail.filters,
                gives,
                robot=who is not None,
                closeness=("closer" if closer else "wider") if values else "both",
            )
            rule = counted(name, columns, segment.differences, segment.body)
            self.probes[name] = (rule, probe)
            trail.probes.append(name)


def _head_value(rule: Rule) -> Rule | None:
    """The expression for the value of a function, or None."""
    fields: Callable[[Any], bool] = lambda fv: fv["field"] == VALUE  # noqa: E731
    found = [value_of(fv) for fv in rule["head"]["record"]["field_value"] if fields(fv)]
    return found[0] if found else None
