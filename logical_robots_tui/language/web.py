"""What would fail on the web platform, or mean something else there.

The platform evaluates a program as one statement of DuckDB, whose answers are the source of what
is said here (`tests/mind/differential/test_web.py`).
"""

from __future__ import annotations

import operator
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import product

from logica.type_inference.research import infer, reference_algebra

from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.adapter import types_on_duckdb
from logical_robots_tui.language.definitions import calls, definitions, reach, rules_of
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import Prepared, diagnostic_at, diagnostic_for
from logical_robots_tui.schema import VALUE

_remark = partial(diagnostic_for, severity="warning")
_remark_at = partial(diagnostic_at, severity="warning")


def web_remarks(program: Sequence[tree.Statement], source: Prepared) -> list[Diagnostic]:
    """Return what the web platform would refuse or understand otherwise, in text order."""
    text = source.original
    message = "The web platform has no @Visible: there all robots see everything"
    found = [
        *(
            _remark(text, each.name, message, "Leave it out there.")
            for each in program
            if isinstance(each, tree.Annotation) and each.name == "@Visible"
        ),
        *_recursions(program, text),
        *_field_names(program, text),
        *_formats(program, text),
        *_Wholes(program, text).overflows(),
        *_lists(program, source),
        *_ties(program, text),
    ]
    unique = {(each.line, each.column, each.message): each for each in found}
    return sorted(unique.values(), key=lambda each: (each.line, each.column))


# -- recursion ------------------------------------------------------------------------------------

_EXACT = (4, 5)  # depths that a predicate which calls itself has there too


def _recursions(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    own = {name: rules_of(each) for name, each in definitions(program).items()}
    below = {name: reach(rules, own) for name, rules in own.items()}
    annotations = [e for e in program if isinstance(e, tree.Annotation) and e.name == "@Recursive"]
    seen: set[str] = set()
    for name in own:
        if name in seen or name not in below[name]:
            continue
        circle = {other for other in below[name] if name in below.get(other, ())}
        seen |= circle
        annotation = next((e for e in annotations if e.subject in circle), None)
        options = {} if annotation is None else {a.field: a.value for a in annotation.arguments}
        unrolled, depth = options.get("iterative"), options.get(1)
        steps = float(depth.value) if isinstance(depth, tree.Number) else 0
        is_unrolled = isinstance(unrolled, tree.Boolean) and unrolled.value == "false"
        if not is_unrolled and (len(circle) > 1 or steps not in _EXACT):
            message = "The web platform ends this recursion after four to six steps"
            hint = f"@Recursive({name}, 30, iterative: false); makes it take 30 steps there too."
            if annotation is not None:
                message += ", whatever @Recursive says"
                hint = "Add iterative: false to its options, and they count there too."
            yield _remark(text, annotation.name if annotation else name, message, hint)


# -- names and functions --------------------------------------------------------------------------

_SQL_WORDS = """
    all analyse analyze and anti any array as asc asof asymmetric at authorization binary both by
    case cast check collate collation column concurrently constraint create cross default deferrable
    desc describe distinct do else end except false fetch for foreign freeze from full glob group
    having ilike in initially inner intersect into is isnull join lambda lateral leading left like
    limit natural not notnull null offset on only or order outer overlaps pivot pivot_longer
    pivot_wider placing positional primary qualify references returning right select semi show
    similar some summarize symmetric table tablesample then to trailing true union unique unpack
    unpivot using variadic verbose when where window with
    """
"""Words that DuckDB does not read as the name of a field in a record."""

_OF_THE_COMPILER = "variable"  # it takes such a record for one of its own
_MOST_VALUES = 6  # of Format, besides its text


def _field_names(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    seen = set()
    for node in tree.walk(program):
        if isinstance(node, tree.Record):
            names = [each.field for each in node.arguments if isinstance(each.field, str)]
        elif isinstance(node, tree.FieldAccess) and node.field == _OF_THE_COMPILER:
            names = [node.field]
        else:
            continue
        for name in names:
            if name.lower() in _SQL_WORDS.split():
                message = f"{name} is a word of SQL, which the web platform can't read as a field"
            elif name == _OF_THE_COMPILER:
                message = f"The web platform can't have a field named {name}"
            else:
                continue
            if name not in seen:  # once is enough
                seen.add(name)
                yield _remark(text, name, message, "Choose another name.")


def _formats(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    if "Format" in definitions(program):
        return
    for call in calls(program):
        if call.name == "Format" and len(call.arguments) > 1 + _MOST_VALUES:
            message = f"Format takes at most {_MOST_VALUES} values on the web platform"
            hint = "Use it twice, and join the strings with ++."
            yield _remark(text, call.name, message, hint)


# -- whole numbers --------------------------------------------------------------------------------

_MOST = 2**31 - 1
_CALCULATIONS = {"+": operator.add, "-": operator.sub, "*": operator.mul}


class _Wholes:
    """Bounds of whole numbers that are made from the program's own, which have 32 bits there.

    What is sensed, remembered, counted or summed up has 64 bits, and no bounds.
    """

    def __init__(self, program: Sequence[tree.Statement], text: str) -> None:
        self._program, self._text = program, text
        self._columns: dict[tuple[str, int | str], tuple[int, int] | None] = {}
        for name, each in definitions(program).items():
            rules = rules_of(each)
            if len(rules) == len(each) and not any(rule.body for rule in rules):
                columns = [column for rule in rules for column in rule.head.columns]
                for field in {column.field for column in columns}:
                    given = [column.expression for column in columns if column.field == field]
                    bounds = [None if each is None else self._bounds(each, {}) for each in given]
                    self._columns[name, field] = _union(bounds)

    def overflows(self) -> Iterator[Diagnostic]:
        for rule in rules_of(self._program):
            scope = self._scope(rule)
            for node in tree.walk(rule):
                bounds = self._calculated(node, scope) if isinstance(node, tree.Call) else None
                if bounds is not None and not _fits(bounds) and node.span:
                    start, stop = node.span
                    message = "This may exceed 32 bits, where the web platform fails"
                    hint = "Write one of the numbers with a point, such as 1000.0."
                    yield _remark_at(self._text, start, stop - start, message, hint)

    def _scope(self, rule: tree.Rule) -> dict[str, tuple[int, int]]:
        scope: dict[str, tuple[int, int]] = {}
        for node in tree.walk(rule):
            pairs: list[tuple[tree.Expression | None, tuple[int, int] | None]] = []
            if sides := tree.equation_sides(node):
                one, other = sides
                pairs = [(one, self._bounds(other, scope)), (other, self._bounds(one, scope))]
            elif isinstance(node, tree.Atom):
                pairs = [
                    (a.expression, self._columns.get((node.name, a.field))) for a in node.arguments
                ]
            for variable, bounds in pairs:
                if isinstance(variable, tree.Variable) and bounds is not None:
                    scope.setdefault(variable.name, bounds)
        return scope

    def _calculated(
        self, node: tree.Call, scope: Mapping[str, tuple[int, int]]
    ) -> tuple[int, int] | None:
        calculate = _CALCULATIONS.get(node.name)
        given = [self._bounds(each, scope) for each in tree.operands(node.arguments)]
        sides = [each for each in given if each is not None]
        if calculate is None or len(given) != 2 or len(sides) != 2:
            return None
        results = [calculate(left, right) for left, right in product(*sides)]
        return min(results), max(results)

    def _bounds(
        self, node: tree.Expression, scope: Mapping[str, tuple[int, int]]
    ) -> tuple[int, int] | None:
        found: tuple[int, int] | None = None
        match node:
            case tree.Number():
                digits, is_short = node.value, len(node.value) <= len(f"-{_MOST}")
                if is_short and digits.lstrip("-").isdecimal():
                    found = (int(digits), int(digits))
            case tree.Variable():
                found = scope.get(node.name)
            case tree.Choice():
                values = [*(each.value for each in node.branches), node.otherwise]
                found = _union([self._bounds(each, scope) for each in values])
            case tree.Call() if node.name in _CALCULATIONS:
                found = self._calculated(node, scope)
            case tree.Call():
                found = self._columns.get((node.name, VALUE))
        return found if found is not None and _fits(found) else None


def _fits(bounds: tuple[int, int]) -> bool:
    return bounds[0] >= -_MOST - 1 and bounds[1] <= _MOST


def _union(bounds: Sequence[tuple[int, int] | None]) -> tuple[int, int] | None:
    known = [each for each in bounds if each is not None]
    if not known or len(known) < len(bounds):
        return None
    return min(low for low, _ in known), max(high for _, high in known)


# -- lists ----------------------------------------------------------------------------------------

_COLLECTING = frozenset({"Array", "List", "Set"})
_NESTED = "belongs to a list, but is implied to be"


def _lists(program: Sequence[tree.Statement], source: Prepared) -> Iterator[Diagnostic]:
    """Yield a remark for each empty list without a type, and each list of lists.

    The package's own inference, which the platform runs, finds them.
    """
    rules = rules_of(program)
    lists = [node for node in tree.walk(rules) if _is_list(node)]
    empty = {each.span for each in lists if isinstance(each, tree.List) and not each.elements}
    try:
        found = [*types_on_duckdb(rules, source)] if lists else []
    except (infer.TypeErrorCaughtException, *error_messages.COMPLAINTS):
        return  # such as rules of one predicate with different columns
    for span, kind in found:
        if isinstance(kind, reference_algebra.BadType):
            if _NESTED not in str(kind):
                continue
            message = "The web platform has no lists of lists"
            hint = "Put the inner list into a record: [{items: [1]}]."
        elif span in empty and not reference_algebra.IsFullyDefined(kind):
            message = "The web platform can't tell the type of the elements of []"
            hint = "Name the list and say its type: l = [], l ~ [Num]."
        else:
            continue
        length = span.stop - span.start
        yield _remark_at(source.original, span.start, length, message, hint)


def _is_list(node: tree.Node) -> bool:
    if isinstance(node, tree.Aggregate | tree.Aggregation):
        return node.operator in _COLLECTING
    return isinstance(node, tree.List)


# -- ties -----------------------------------------------------------------------------------------

_CHOOSING = frozenset({"ArgMax", "ArgMin"})
_COUNTING = frozenset({"Ceil", "Count", "Floor", "Length", "Round", "Size", "ToInt64"})


def _ties(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    """Yield a remark for the first choice whose values are likely to be equal."""
    for rule in rules_of(program):
        values = {
            tree.variable_of(one): other
            for node in tree.walk(rule)
            if (sides := tree.equation_sides(node))
            for one, other in (sides, sides[::-1])
        }
        for node in tree.walk(rule):
            if (
                not isinstance(node, tree.Aggregate | tree.Aggregation)
                or node.operator not in _CHOOSING
            ):
                continue
            pair = node.argument
            if isinstance(pair, tree.Call) and pair.name == "->" and len(pair.arguments) == 2:
                value = pair.arguments[1].expression
                if name := tree.variable_of(value):
                    value = values.get(name)
                if _is_coarse(value) and pair.span:
                    message = (
                        f"If values tie, {node.operator} may choose another one on the web platform"
                    )
                    hint = "Here it is the first one. Let the value tell them apart."
                    length = pair.span.stop - pair.span.start
                    yield _remark_at(text, pair.span.start, length, message, hint)
                    return


def _is_coarse(value: tree.Node | None) -> bool:
    """Return whether an expression is a constant or a count, so that ties are likely."""
    match value:
        case tree.Number():
            return True
        case tree.FieldAccess():
            return value.field == "clock"
        case tree.Call() | tree.Aggregate():
            name = value.name if isinstance(value, tree.Call) else value.operator
            return name in _COUNTING
        case tree.Choice():
            values = [*(each.value for each in value.branches), value.otherwise]
            return all(map(_is_coarse, values))
    return False
