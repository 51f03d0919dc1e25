"""The compile process of the game: compiles programs, decomposes them, and reads questions."""

from __future__ import annotations

import json
from contextlib import closing
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from logical_robots_tui.explain.decomposition import decompose
from logical_robots_tui.explain.diagnosis.checkup import check_up
from logical_robots_tui.explain.why.probing import Called
from logical_robots_tui.language import error_messages
from logical_robots_tui.language.adapter import parse_expression, parse_proposition
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import Prepared, diagnostic_at, prepare
from logical_robots_tui.language.tree import (
    Argument,
    Atom,
    Boolean,
    Call,
    Expression,
    List,
    Null,
    Number,
    PredicateName,
    Record,
    Text,
    Variable,
    equation_sides,
)
from logical_robots_tui.mind.compiling.worker import is_prepared_soon, keep_preparable, serve
from logical_robots_tui.mind.sqlite.database import Database
from logical_robots_tui.mind.tuning import tune_all
from logical_robots_tui.schema import VALUE
from logical_robots_tui.values import Value


def main() -> None:
    serve(JOBS)


def _decompose(request: dict[str, Any]) -> dict[str, object]:
    """Decompose a predicate's rules, or return more of its queries."""
    found = decompose(*(request[field] for field in ("text", "predicate", "within", "kinds")))
    with closing(Database()) as database:
        queries = found.queries(database, request.get("queries", ()))
    if "queries" in request:
        return {"compiled": {"queries": queries}}
    return {"probing": asdict(replace(found.probing, queries=queries))}


def _check_up(request: dict[str, Any]) -> dict[str, object]:
    functions = frozenset(request["checkup"])
    with closing(Database()) as database:
        found = check_up(request["text"], functions, partial(is_prepared_soon, database))
    for_all = {probe.name for probe in found.probes if probe.closeness != "closer"}
    tuned = keep_preparable(tune_all(found.program.statements, for_all=for_all))
    return {"checkup": asdict(replace(found, program=replace(found.program, tuned=tuned)))}


_HINT = 'Ask for a predicate with values, such as Next(robot_name: "Crow") or Speed(200).'


def read_call(text: str) -> Called:
    """Read a predicate with values; arguments that are variables have none.

    Raises:
        ProgramError: It is something else.
    """
    source = prepare(text)
    if source.problems:
        raise ProgramError(source.problems)
    called, result = _sides(source)
    if not isinstance(called, Atom | Call | PredicateName) or not called.name[:1].isalpha():
        raise _refusal(source, called, "This is not a predicate with values")
    given = _fields(() if isinstance(called, PredicateName) else called.arguments, source)
    if result is not None:
        given[VALUE] = _value(result, source)
    return Called(str(called.name), json.dumps(given))


def _sides(source: Prepared) -> tuple[Expression | Atom, Expression | None]:
    """Return the call, and what it is said to be, if anything."""
    if not source.text.strip():
        raise ProgramError((Diagnostic(1, 1, "The query is empty", _HINT),))
    try:
        body = parse_proposition(source)
    except error_messages.COMPLAINTS:
        try:
            return parse_expression(source), None
        except error_messages.COMPLAINTS as error:
            raise ProgramError((error_messages.explain(error, source),)) from None
    if (sides := equation_sides(body)) is not None:
        return sides
    if isinstance(body, Atom):
        return body, None
    raise _refusal(source, None, "These are several conditions")


def _fields(arguments: tuple[Argument, ...], source: Prepared) -> dict[str, Value]:
    return {
        each.column: _value(each.expression, source)
        for each in arguments
        if each.expression is not None and not isinstance(each.expression, Variable)
    }


def _value(node: Expression, source: Prepared) -> Value:
    """Return the value of a literal; raise ProgramError for anything else."""
    match node:
        case Number():
            is_whole = node.value.lstrip("-").isdigit()
            return int(node.value) if is_whole else float(node.value)
        case Boolean():
            return node.value == "true"
        case Null():
            return None
        case Text():
            return node.value
        case List():
            return [_value(each, source) for each in node.elements]
        case Record():
            return {
                str(each.field): _value(each.expression, source)
                for each in node.arguments
                if each.expression is not None
            }
    hint = 'Values are numbers, "strings", true, false, null, [lists] and {of: records}.'
    raise _refusal(source, node, "This is not a value", hint)


def _refusal(
    source: Prepared, node: Expression | Atom | None, message: str, hint: str = _HINT
) -> ProgramError:
    start, stop = (node.span if node is not None else None) or (0, len(source.original))
    found = diagnostic_at(source.original, start, stop - start, message, hint)
    return ProgramError((found,))


def _read(request: dict[str, Any]) -> dict[str, object]:
    return {"called": asdict(read_call(request["called"]))}


JOBS = {"predicate": _decompose, "checkup": _check_up, "called": _read}
