"""Remarks on code that fails on the web platform, or means something else there.

The platform evaluates a program as one statement of DuckDB; the remarks are tested against
DuckDB (`tests/mind/differential/test_web.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import Model, reach, rules_of
from logical_robots_tui.language.diagnostics import Diagnostic


def web_remarks(model: Model) -> list[Diagnostic]:
    """Return remarks on what the web platform refuses or understands otherwise, in text order."""
    message = "The web platform has no @Visible: there all robots see everything"
    remarks = [
        *(
            model.diagnostic(annotation.name, message, "Leave it out there.", "warning")
            for annotation in model.annotations
            if annotation.name == "@Visible"
        ),
        *_recursions(model),
        *_field_names(model),
        *_formats(model),
    ]
    unique = {(remark.line, remark.column, remark.message): remark for remark in remarks}
    return sorted(unique.values(), key=lambda remark: (remark.line, remark.column))


# -- recursion ------------------------------------------------------------------------------------

_EXACT = (4, 5)  # depths that a predicate which calls itself has there too


def _recursions(model: Model) -> Iterator[Diagnostic]:
    predicates = {name: rules_of(statements) for name, statements in model.definitions.items()}
    reachable = {name: reach(rules, predicates) for name, rules in predicates.items()}
    annotations = [a for a in model.annotations if a.name == "@Recursive"]
    visited: set[str] = set()
    for name in predicates:
        if name in visited or name not in reachable[name]:
            continue
        circle = {callee for callee in reachable[name] if name in reachable.get(callee, ())}
        visited |= circle
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
            place = annotation.name if annotation else name
            yield model.diagnostic(place, message, hint, "warning")


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


def _field_names(model: Model) -> Iterator[Diagnostic]:
    reported = set()
    for node in tree.walk(model.statements):
        if isinstance(node, tree.Record):
            names = [
                argument.field for argument in node.arguments if isinstance(argument.field, str)
            ]
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
            if name not in reported:  # once is enough
                reported.add(name)
                yield model.diagnostic(name, message, "Choose another name.", "warning")


def _formats(model: Model) -> Iterator[Diagnostic]:
    if "Format" in model.definitions:
        return
    for call in model.calls:
        if call.name == "Format" and len(call.arguments) > 1 + _MOST_VALUES:
            message = f"Format takes at most {_MOST_VALUES} values on the web platform"
            hint = "Use it twice, and join the strings with ++."
            yield model.diagnostic(call.name, message, hint, "warning")
