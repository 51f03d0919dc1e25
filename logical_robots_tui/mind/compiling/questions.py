"""Questions about a program: a call, an expression, conditions, or rules.

A question becomes a rule on lines after the program, so that diagnostics refer to its text.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.adapter import is_rule, parse, parse_expression, parse_proposition
from logical_robots_tui.language.checks import NO_VALUE, check
from logical_robots_tui.language.definitions import column_labels, definitions
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import Prepared, diagnostic_for, prepare
from logical_robots_tui.mind.compiling.compiler import (
    compile_statements,
    explain,
    read_program,
    without_visibility,
)
from logical_robots_tui.mind.compiling.dialect import runs
from logical_robots_tui.mind.program import CompiledQuery
from logical_robots_tui.schema import INPUTS, VALUE

Own: TypeAlias = Mapping[str, Sequence[tree.Rule | tree.Functor]]
Gives: TypeAlias = Literal["rows", "value", "truth"]


def compile_question(text: str, query: str) -> CompiledQuery:
    """Compile a question; a ProgramError refers to the query's lines and columns."""
    source = prepare(query)
    if source.problems:
        raise ProgramError(source.problems)
    bare = source.text.strip()
    if not bare:
        hint = "Type a predicate, such as Robot, or an expression."
        raise ProgramError((Diagnostic(1, 1, "The query is empty", hint),))
    own = definitions(read_program(text)[1])
    before, after = "", ""
    gives: Gives = "rows"
    if source.ends or is_rule(source):
        asked = _define(source, own)
    elif bare in own:
        asked, query = bare, ""
    else:
        names = itertools.chain(["Asked"], (f"Asked{number}" for number in itertools.count(2)))
        asked = next(name for name in names if name not in own)
        if bare in INPUTS:
            query = f"{bare}({', '.join(f'{column}:' for column in INPUTS[bare])})"
            source = prepare(query)
        before, after, gives = _frame(asked, source, own)
    begin = f"{text}\n;\n{before}\n"
    whole = f"{begin}{query}\n{after};"
    first = begin.count("\n") + 1
    try:
        compiled = _compile(whole, asked, first, is_bare=not query)
        return replace(compiled, text=query or bare, gives=gives)
    except ProgramError as error:
        raise ProgramError(tuple(_place(d, first, query) for d in error.diagnostics)) from None


def _compile(whole: str, asked: str, first: int, *, is_bare: bool) -> CompiledQuery:
    """Return the question for a predicate's rows, which is in line `first`."""
    source = prepare(whole)
    parsed = parse(source)
    found = tuple(
        d
        for d in check(parsed, whole, runs).problems
        if d.severity == "error" or (d.line >= first and d.message.endswith(NO_VALUE))
    )
    if found:
        raise ProgramError(found)
    try:
        rest = without_visibility(parsed.statements, whole)
        compiled = compile_statements(rest, source)
        sql = compiled.FormattedPredicateSql(asked)
    except error_messages.COMPLAINTS as error:
        if is_bare and error_messages.is_function(error):
            hint = f"Call it with values, such as {asked}(1)."
            message = error_messages.FUNCTION.format(asked)
            raise ProgramError((Diagnostic(1, 1, message, hint),)) from None
        raise ProgramError((explain(error, source, parsed.statements),)) from None
    return CompiledQuery(
        "", sql, "rows", compiled.truths(asked), column_labels(asked, definitions(rest))
    )


def _place(diagnostic: Diagnostic, first: int, query: str) -> Diagnostic:
    """Move a diagnostic of the whole text into the query: if outside, to the name it is about."""
    line = diagnostic.line - first + 1
    if 1 <= line <= query.count("\n") + 1:
        return replace(diagnostic, line=line)
    name = re.search(rf"(?<![\w.]){re.escape(diagnostic.excerpt)}(?!\w)", query)
    if not diagnostic.excerpt or name is None:
        return replace(diagnostic, line=1, column=1, excerpt="")
    before = query[: name.start()].split("\n")
    return replace(diagnostic, line=len(before), column=len(before[-1]) + 1)


def _define(source: Prepared, own: Own) -> str:
    """Return the last predicate that a query defines; it may not redefine the program's."""
    parsed = parse(source)
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    defined = [*definitions(parsed.statements)]
    for name in defined:
        if name in own or name in INPUTS:
            message = f"The program already defines {name}"
            problem = diagnostic_for(source.original, name, message, "Use another name.")
            raise ProgramError((problem,))
    if not defined:
        raise ProgramError((Diagnostic(1, 1, "This defines no predicate"),))
    return str(defined[-1])


def _frame(name: str, source: Prepared, own: Own) -> tuple[str, str, Gives]:
    """Return the text that makes a query a rule, before and after it, and its result kind."""
    try:
        body = parse_proposition(source)
    except error_messages.COMPLAINTS as error:
        try:
            expression = parse_expression(source)
        except error_messages.COMPLAINTS:
            raise ProgramError((error_messages.explain(error, source),)) from None
        return _value_frame(name, _open_inputs(expression))
    found, left_open = tree.variables(body), _open_inputs(body)
    columns = [each for each in _in_text(body) if each in found and each not in left_open]
    if not columns and _is_value(body, own):
        return _value_frame(name, left_open)
    if left_open:
        columns += {"robot_name"} - {*columns}
        return f"{name}({_columns(columns)}) :- {_supply(left_open)},", "", "rows"
    if not columns:
        if isinstance(body, tree.Disjunction):  # the package can't negate it in place
            both = f'; {name}(holds: "true") :- {name}Ways(one:); '
            denied = f'{both}{name}(holds: "false") :- ~{name}Ways(one:)'
            return f"{name}Ways(one: 1) distinct :-", denied, "truth"
        denied = f'; {name}(holds: "false") :- ~({source.original}\n)'
        return f'{name}(holds: "true") :-', denied, "truth"
    return f"{name}({_columns(columns)}) :-", "", "rows"


def _value_frame(name: str, left_open: Sequence[str]) -> tuple[str, str, Gives]:
    if not left_open:
        return f"{name}(value:", ")", "value"
    return f"{name}(value:", f", robot_name:) :- {_supply(left_open)}", "value"


def _columns(names: Iterable[str]) -> str:
    return ", ".join(f"{each}:" for each in names)


def _open_inputs(asked: tree.Expression | tree.Proposition) -> list[str]:
    """Return the input columns that a question uses as unbound variables."""
    given = set()
    for node in tree.walk(asked):
        if isinstance(node, tree.Membership):
            given.add(tree.variable_of(node.element))
        elif isinstance(node, tree.Atom) and node.name not in tree.CONDITIONS:
            given |= {tree.variable_of(value) for value in tree.operands(node.arguments)}
    columns = {column for inputs in INPUTS.values() for column in inputs}
    return [name for name in _in_text(asked) if name in columns and name not in given]


def _supply(left_open: Sequence[str]) -> str:
    calls = [
        f"{name}({_columns(columns)})"
        for name, columns in INPUTS.items()
        if {*left_open} & {*columns} - {"robot_name"}
    ]
    return ", ".join(calls) or f"Sensor({_columns(INPUTS['Sensor'])})"


def _is_value(body: tree.Proposition, own: Own) -> bool:
    """Return whether a possible condition is meant as a value: a function or calculation."""
    name = body.name if isinstance(body, tree.Atom) else ""
    if name in own:
        return any(isinstance(each, tree.Rule) and each.head.column(VALUE) for each in own[name])
    return bool(name) and name not in INPUTS and name not in tree.CONDITIONS


def _in_text(asked: tree.Node) -> Iterator[str]:
    """Yield the names of the variables in text order, once each."""
    found = [node for node in tree.walk(asked) if isinstance(node, tree.Variable)]
    found.sort(key=lambda node: node.span or (0, 0))
    yield from dict.fromkeys(str(node.name) for node in found)
