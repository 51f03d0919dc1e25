"""The model of a program: what it defines and mentions; prelude, built-in functions, constants.

A parameter is a predicate that ``New := Old(Parameter: Given)`` substitutes.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

from logica.compiler import expr_translate

from logical_robots_tui.language import tree
from logical_robots_tui.language.adapter import operator_name, parse, parse_trusted
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError, Severity
from logical_robots_tui.language.source_text import Prepared, diagnostic_at, prepare
from logical_robots_tui.schema import VALUE

_PRELUDE = """
->(left:, right:) = {arg: left, value: right};
`=`(left:, right:) = right :- left == right;
Arrow(left, right) = arrow :- left == arrow.arg, right == arrow.value;

WeightedAverage(pair) = Sum(pair.arg * pair.value) / Sum(pair.arg);

ArgMin(pair) = SqlExpr("arg_min({a}, {v})", {a: pair.arg, v: pair.value});
ArgMax(pair) = SqlExpr("arg_max({a}, {v})", {a: pair.arg, v: pair.value});
ArgMinK(pair, k) = SqlExpr("arg_min_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
ArgMaxK(pair, k) = SqlExpr("arg_max_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
Array(pair) = SqlExpr("array_by({a}, {v})", {a: pair.arg, v: pair.value});

NaturalHash(x) = SqlExpr("natural_hash({x})", {x:});
Fingerprint(x) = SqlExpr("natural_hash({x})", {x:});
TryCast(value, example) = SqlExpr("try_cast_like({v}, {e})", {v: value, e: example});
TruthToString(truth) = SqlExpr("truth_to_text({t})", {t: truth});
RecordAsJson(record) = SqlExpr("record_as_json({r})", {r: record});
AssembleRecord(pairs) = SqlExpr("assemble_record({p})", {p: pairs});
DisassembleRecord(record) = SqlExpr("disassemble_record({r})", {r: record});
Chr(code) = SqlExpr("character(to_whole({c}))", {c: code});
Ord(text) = SqlExpr("unicode_of({t})", {t: text});
Num(x) = x;
Str(x) = x;
UniqueNumber() = SqlExpr("unique_number()", {});
"""
"""Common predicates that every program may use.

A program can define its own instead, so none of them may use another.
Aggregates take ``argument -> value`` pairs, which the compiler sees as ``{arg:, value:}``.
"""

_AUXILIARY = "_MultBodyAggAux"  # the package's suffix of predicates that it makes itself


Definitions: TypeAlias = dict[str, list[tree.Rule | tree.Functor]]
"""The statements that define each predicate, in text order."""


class Model:
    """A program as checks and the compiler ask about it; each answer is computed once.

    Attributes:
        statements: In text order.
        source: The text that diagnostics refer to.
        doubtful: Names in statements that could not be parsed.
    """

    def __init__(
        self,
        statements: Iterable[tree.Statement],
        source: Prepared | None = None,
        doubtful: frozenset[str] = frozenset(),
    ) -> None:
        self.statements = tuple(statements)
        self.source = source or prepare("")
        self.text = self.source.original
        self.doubtful = doubtful
        self._reach: dict[str, set[str]] = {}

    @cached_property
    def definitions(self) -> Definitions:
        predicates: Definitions = {}
        for statement in self.statements:
            if not isinstance(statement, tree.Annotation) and not statement.name.endswith(
                _AUXILIARY
            ):
                predicates.setdefault(statement.name, []).append(statement)
        return predicates

    @cached_property
    def rules(self) -> list[tree.Rule]:
        return rules_of(self.statements)

    @cached_property
    def annotations(self) -> list[tree.Annotation]:
        return [s for s in self.statements if isinstance(s, tree.Annotation)]

    @cached_property
    def functors(self) -> list[tree.Functor]:
        return [s for s in self.statements if isinstance(s, tree.Functor)]

    @cached_property
    def calls(self) -> list[tree.Call | tree.Atom]:
        return [*calls(self.statements)]

    @cached_property
    def substituted(self) -> frozenset[str]:
        """The names of predicates that functors substitute."""
        return frozenset(name for functor in self.functors for name in functor.parameters)

    @cached_property
    def missing_parameters(self) -> dict[str, str]:
        """For each predicate that can't be computed alone, a parameter that it needs."""
        open_parameters = self.substituted - self.definitions.keys()

        def unbound(name: str, bound: frozenset[str], visited: set[str]) -> Iterator[str]:
            if name in open_parameters:
                if name not in bound:
                    yield name
            elif name in self.definitions and name not in visited:
                visited.add(name)
                for statement in self.definitions[name]:
                    inner_bound = bound
                    if isinstance(statement, tree.Functor):
                        inner_bound = bound.union(statement.parameters)
                    for callee in names_used(statement):
                        yield from unbound(callee, inner_bound, visited)

        firsts = {name: next(unbound(name, frozenset(), set()), "") for name in self.definitions}
        return {name: parameter for name, parameter in firsts.items() if parameter}

    def reach(self, name: str) -> set[str]:
        """Return the names of the predicates that one uses, directly or indirectly."""
        if name not in self._reach:
            self._reach[name] = reach(self.definitions.get(name, ()), self.definitions)
        return self._reach[name]

    def diagnostic(
        self,
        place: str | tree.Span,
        message: str,
        hint: str = "",
        severity: Severity = "error",
    ) -> Diagnostic:
        """Return a diagnostic for a name or a span of the text."""
        start: int = getattr(place, "start", 0)
        length = place.stop - start if isinstance(place, tree.Span) else len(place)
        return diagnostic_at(self.text, start, length, message, hint, severity)


@functools.cache
def prelude() -> Model:
    return Model(parse_trusted(_PRELUDE))


def rules_of(program: Iterable[tree.Statement]) -> list[tree.Rule]:
    return [statement for statement in program if isinstance(statement, tree.Rule)]


def column_labels(
    name: str, predicates: Mapping[str, Sequence[tree.Rule | tree.Functor]]
) -> dict[str, str]:
    """Return the labels of a predicate's columns where SQL has another name for them.

    A positional column has the name of its first parameter, and a result is ``value``.
    """
    heads = [rule.head for rule in predicates.get(name, ()) if isinstance(rule, tree.Rule)]
    columns = [column for head in heads for column in head.columns]
    names = {column.field for column in columns}
    labels: dict[str, str] = {}
    for column in columns:
        is_place = isinstance(column.field, int) and column.column not in labels
        label = tree.variable_of(column.value) if is_place else "value" * (column.field == VALUE)
        if label and label not in {*names, *labels.values()}:
            labels[column.column] = label
    for statement in predicates.get(name, ()):
        if isinstance(statement, tree.Functor) and statement.base != name:
            labels |= column_labels(
                statement.base, {n: statements for n, statements in predicates.items() if n != name}
            )
    return labels


def calls(part: tree.Tree) -> Iterator[tree.Call | tree.Atom]:
    return (node for node in tree.walk(part) if isinstance(node, tree.Call | tree.Atom))


def names_used(part: tree.Tree) -> Iterator[str]:
    """Yield the names of all predicates, functions and aggregates that a tree mentions."""
    for node in tree.walk(part):
        if isinstance(node, tree.Call | tree.Atom | tree.PredicateName):
            yield node.name
        elif isinstance(node, tree.Aggregate | tree.Aggregation):
            yield operator_name(node.operator)
        elif isinstance(node, tree.Functor):
            yield from (node.name, node.base)


def reach(part: tree.Tree, program: Mapping[str, Sequence[tree.Statement]]) -> set[str]:
    """Return the names of the predicates that a tree uses, directly or indirectly."""
    names: set[str] = set()
    queue = [part]
    while queue:
        for name in names_used(queue.pop()):
            if name not in names:
                names.add(name)
                queue.append(program.get(name, ()))
    return names


_QL = expr_translate.QL
_TWO_ARGUMENTS = frozenset(
    {"Concat", "DateAddDay", "DateDiffDay", "Element", "Join", "Like", "MagicalEntangle", "Split"}
)


@functools.cache
def built_in_names() -> frozenset[str]:
    """Return the names of all functions, operators and aggregates that the package has built in."""
    return frozenset(_QL.BasisFunctions())


def is_built_in(name: str) -> bool:
    return name in built_in_names()


@functools.cache
def arity(name: str) -> tuple[int, float]:
    """Return the fewest and most arguments of a built-in function."""
    count = {"If": 3, "Cast": 2}.get(name, 0)
    if name in _QL.ANALYTIC_FUNCTIONS:
        count = 4 if name.startswith("Window") else 3
    elif not count and name in _QL.BUILT_IN_FUNCTIONS:
        count = 2 if name in _TWO_ARGUMENTS else 1
    lower, upper = _QL.BULK_FUNCTIONS_ARITY_RANGE.get(name, (0, math.inf))
    lower = {"Coalesce": 2, "Greatest": 1, "Least": 1}.get(name, lower)  # as SQLite wants
    return (count, count) if count else (lower, upper)


# -- constants -----------------------------------------------------------------------------------


def with_constants(text: str, values: Mapping[str, str]) -> str:
    """Set constants to one-line expressions; all other text and line numbers stay the same.

    Raises:
        ProgramError: The program has errors, or a name is not that of a constant.
    """
    program = _statements_of(text)
    predicates = Model(program).definitions
    expected = list(program)
    places = []
    for name, value in values.items():
        new, *new_rest = _statements_of(f"{name}() = {value};")
        old, *old_rest = predicates.get(name, [None])
        if new_rest or old_rest or not is_constant(old) or not isinstance(new, tree.Rule):
            hint = f"A constant is one rule without a body: {name}() = {value};"
            message = f"{name} is not a constant of the program"
            raise ProgramError((Diagnostic(1, 1, message, hint),))
        assert isinstance(old, tree.Rule)
        assert old.value is not None
        assert old.value.span is not None
        places.append((*old.value.span, value))
        expected[program.index(old)] = new
    for start, stop, value in sorted(places, reverse=True):
        lines = text.count("\n", start, stop)
        text = text[:start] + value + "\n" * lines + text[stop:]
    if _statements_of(text) != expected:
        message = "The constants can't be written into the program"
        raise ProgramError((Diagnostic(1, 1, message, "Try simpler values."),))
    return text


def is_constant(rule: tree.Rule | tree.Functor | None) -> bool:
    """Return whether a rule gives a predicate without arguments one value under no condition."""
    if not isinstance(rule, tree.Rule) or rule.body or rule.is_distinct or rule.modalities:
        return False
    return [column.field for column in rule.head.columns] == [VALUE] and rule.value is not None


def _statements_of(text: str) -> list[tree.Statement]:
    parsed = parse(prepare(text))
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    return parsed.statements
