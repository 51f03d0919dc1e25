"""Questions about a program: a call, an expression, conditions, or rules.

A question becomes a rule on lines after the program, so that diagnostics refer to its text.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal, TypeAlias

from logical_robots_tui.language import error_messages, tree
from logical_robots_tui.language.adapter import is_rule, parse, parse_expression, parse_proposition
from logical_robots_tui.language.checks import NO_VALUE, check
from logical_robots_tui.language.definitions import Definitions, Model, column_labels
from logical_robots_tui.language.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.language.source_text import Prepared, prepare
from logical_robots_tui.mind.compiling.compiler import (
    compile_statements,
    explain,
    read_program,
    without_visibility,
)
from logical_robots_tui.mind.compiling.dialect import runs
from logical_robots_tui.mind.program import CompiledQuery
from logical_robots_tui.schema import INPUTS, VALUE

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
    rules = read_program(text).definitions
    prefix, suffix = "", ""
    gives: Gives = "rows"
    if source.ends or is_rule(source):
        predicate = _last_definition(source, rules)
    elif bare in rules:
        predicate, query = bare, ""
    else:
        names = itertools.chain(["Asked"], (f"Asked{number}" for number in itertools.count(2)))
        predicate = next(name for name in names if name not in rules)
        if bare in INPUTS:
            query = f"{bare}({', '.join(f'{column}:' for column in INPUTS[bare])})"
            source = prepare(query)
        prefix, suffix, gives = _frame(predicate, source, rules)
    preamble = f"{text}\n;\n{prefix}\n"
    full_text = f"{preamble}{query}\n{suffix};"
    first_line = preamble.count("\n") + 1
    try:
        compiled = _compile(full_text, predicate, first_line, is_bare=not query)
        return replace(compiled, text=query or bare, gives=gives)
    except ProgramError as error:
        raise ProgramError(
            tuple(_place_in_query(d, first_line, query) for d in error.diagnostics)
        ) from None


def _compile(text: str, predicate: str, first_line: int, *, is_bare: bool) -> CompiledQuery:
    """Return the question for a predicate's rows, which is in line `first`."""
    parsed = parse(prepare(text))
    model = Model(parsed.statements, parsed.source, parsed.doubtful)
    problems = tuple(
        d
        for d in check(model, parsed.problems, runs).problems
        if d.severity == "error" or (d.line >= first_line and d.message.endswith(NO_VALUE))
    )
    if problems:
        raise ProgramError(problems)
    try:
        compiled = compile_statements(without_visibility(model).statements, model.source)
        sql = compiled.FormattedPredicateSql(predicate)
    except error_messages.COMPLAINTS as error:
        if is_bare and error_messages.is_function(error):
            hint = f"Call it with values, such as {predicate}(1)."
            message = error_messages.FUNCTION.format(predicate)
            raise ProgramError((Diagnostic(1, 1, message, hint),)) from None
        raise ProgramError((explain(error, model),)) from None
    return CompiledQuery(
        "",
        sql,
        "rows",
        compiled.truths(predicate),
        column_labels(predicate, model.definitions),
    )


def _place_in_query(diagnostic: Diagnostic, first_line: int, query: str) -> Diagnostic:
    """Move a diagnostic of the whole text into the query, to the name it is about if outside."""
    diagnostic = replace(diagnostic, fix=None)  # whose offsets are those of the whole text
    line = diagnostic.line - first_line + 1
    if 1 <= line <= query.count("\n") + 1:
        return replace(diagnostic, line=line)
    name = re.search(rf"(?<![\w.]){re.escape(diagnostic.excerpt)}(?!\w)", query)
    if not diagnostic.excerpt or name is None:
        return replace(diagnostic, line=1, column=1, excerpt="")
    preceding_lines = query[: name.start()].split("\n")
    return replace(diagnostic, line=len(preceding_lines), column=len(preceding_lines[-1]) + 1)


def _last_definition(source: Prepared, rules: Definitions) -> str:
    """Return the last predicate that a query defines; it may not redefine the program's."""
    parsed = parse(source)
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    model = Model(parsed.statements, source)
    for name in model.definitions:
        if name in rules or name in INPUTS:
            message = f"The program already defines {name}"
            raise ProgramError((model.diagnostic(name, message, "Use another name."),))
    if not model.definitions:
        raise ProgramError((Diagnostic(1, 1, "This defines no predicate"),))
    return str([*model.definitions][-1])


def _frame(name: str, source: Prepared, rules_by_name: Definitions) -> tuple[str, str, Gives]:
    """Return the prefix and suffix that make a query a rule, and its result kind."""
    try:
        body = parse_proposition(source)
    except error_messages.COMPLAINTS as error:
        try:
            expression = parse_expression(source)
        except error_messages.COMPLAINTS:
            raise ProgramError((error_messages.explain(error, source),)) from None
        return _value_frame(name, _open_inputs(expression))
    variables, open_inputs = tree.variables(body), _open_inputs(body)
    columns = [v for v in _variables_in_order(body) if v in variables and v not in open_inputs]
    if not columns and _is_value(body, rules_by_name):
        return _value_frame(name, open_inputs)
    if open_inputs:
        columns += {"robot_name"} - {*columns}
        return f"{name}({_columns(columns)}) :- {_supply(open_inputs)},", "", "rows"
    if not columns:
        if isinstance(body, tree.Disjunction):  # the package can't negate it in place
            rules = f'; {name}(holds: "true") :- {name}Ways(one:); '
            suffix = f'{rules}{name}(holds: "false") :- ~{name}Ways(one:)'
            return f"{name}Ways(one: 1) distinct :-", suffix, "truth"
        suffix = f'; {name}(holds: "false") :- ~({source.original}\n)'
        return f'{name}(holds: "true") :-', suffix, "truth"
    return f"{name}({_columns(columns)}) :-", "", "rows"


def _value_frame(name: str, open_inputs: Sequence[str]) -> tuple[str, str, Gives]:
    if not open_inputs:
        return f"{name}(value:", ")", "value"
    return f"{name}(value:", f", robot_name:) :- {_supply(open_inputs)}", "value"


def _columns(names: Iterable[str]) -> str:
    return ", ".join(f"{name}:" for name in names)


def _open_inputs(expression: tree.Expression | tree.Proposition) -> list[str]:
    """Return the input columns that a question uses as unbound variables."""
    bound_names = set()
    for node in tree.walk(expression):
        if isinstance(node, tree.Membership):
            bound_names.add(tree.variable_of(node.element))
        elif isinstance(node, tree.Atom) and node.name not in tree.CONDITIONS:
            bound_names |= {tree.variable_of(value) for value in tree.operands(node.arguments)}
    columns = {column for inputs in INPUTS.values() for column in inputs}
    return [
        name
        for name in _variables_in_order(expression)
        if name in columns and name not in bound_names
    ]


def _supply(open_inputs: Sequence[str]) -> str:
    calls = [
        f"{name}({_columns(columns)})"
        for name, columns in INPUTS.items()
        if {*open_inputs} & {*columns} - {"robot_name"}
    ]
    return ", ".join(calls) or f"Sensor({_columns(INPUTS['Sensor'])})"


def _is_value(body: tree.Proposition, rules: Definitions) -> bool:
    """Return whether a possible condition is meant as a value: a function or calculation."""
    name = body.name if isinstance(body, tree.Atom) else ""
    if name in rules:
        return any(isinstance(rule, tree.Rule) and rule.head.column(VALUE) for rule in rules[name])
    return bool(name) and name not in INPUTS and name not in tree.CONDITIONS


def _variables_in_order(expression: tree.Node) -> Iterator[str]:
    """Yield the names of the variables in text order, once each."""
    variables = [node for node in tree.walk(expression) if isinstance(node, tree.Variable)]
    variables.sort(key=lambda node: node.span or (0, 0))
    yield from dict.fromkeys(str(node.name) for node in variables)
