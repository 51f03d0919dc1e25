"""Parsing statement by statement, so that every error is found and every node knows its place.

The package's parser gives each node the text that it came from, with its place. Here that place is
an offset in the program's text.

Constants of a program, `Near() = 40;`, can be given other values in its parsed rules.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.checking import error_messages
from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.compiling.rules import fields, heads, nodes, value_of
from logical_robots_tui.mind.diagnostics import Diagnostic, ProgramError
from logical_robots_tui.mind.program import VALUE
from logical_robots_tui.mind.source_text import INNER_QUOTE, prepare, statements

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.source_text import Prepared

_NAME = re.compile(r"[A-Z]\w*")


@dataclass(frozen=True, slots=True)
class Parsed:
    """The parsed part of a program.

    Attributes:
        rules: Syntax trees as written, in the order of the text.
        problems: Errors in the statements that could not be parsed.
        doubtful: Names in those statements, about which nothing is known.
    """

    rules: list[Rule]
    problems: list[Diagnostic]
    doubtful: frozenset[str]


def parse_statements(source: Prepared) -> Parsed:
    """Parse every statement that can be parsed."""
    parse.TOO_MUCH = "too much"  # a program could switch the package's syntax permanently
    parse.EnactIncantations(source.text)
    rules: list[Rule] = []
    problems = list(source.problems)
    doubtful: set[str] = set()
    for start, end in statements(source):
        skip = any(start <= place < end for place in source.broken)
        if not skip:
            try:
                rules += _with_quotes(_parse_statement(source.text, start, end))
                continue
            except error_messages.COMPLAINTS as error:
                problems.append(error_messages.explain(error, source, (start, end)))
        doubtful.update(_NAME.findall(source.skeleton[start:end]))
    return Parsed(rules, problems, frozenset(doubtful))


def rewritten(rules: list[Rule]) -> list[Rule]:
    """Return the rules in the form that the package compiles, without disjunctions."""
    for rewriting in (
        parse.DisjunctiveNormalForm,
        parse.MultiBodyAggregation,
        parse.AggergationsAsExpressions,
    ):
        rules = rewriting.Rewrite(rules)
    return rules


def _with_quotes(rules: Iterator[Rule]) -> list[Rule]:
    """Return the rules with the double quotes inside single-quoted texts restored."""
    found = list(rules)
    for node in nodes(found):
        text = (
            node["the_string"].get("the_string")
            if isinstance(node.get("the_string"), dict)
            else None
        )
        if isinstance(text, str) and INNER_QUOTE in text:
            node["the_string"]["the_string"] = text.replace(INNER_QUOTE, '"')
    return found


def _parse_statement(text: str, start: int, end: int) -> Iterator[Rule]:
    statement = parse.HeritageAwareString(text[start:end])
    statement.start, statement.stop, statement.heritage = start, end, text
    function: list[Rule] | None = parse.ParseFunctionRule(statement)
    if function:
        yield from function
        return
    rule: dict[str, Any] = parse.ParseFunctorRule(statement) or parse.ParseRule(statement)
    yield rule


def with_constants(text: str, values: Mapping[str, str]) -> str:
    """Return the text of a program in whose parsed rules some constants have other values.

    The rest of the text stays as it is, and so do the numbers of its lines.

    Args:
        text: The program.
        values: Expressions on one line by the constants' names.

    Raises:
        ProgramError: The program has errors, or a name is not that of a constant.
    """
    rules = _parsed(text)
    found = heads(rules)
    wanted = deep_copy(rules)
    spans = []
    for name, value in values.items():
        new, *others = _parsed(f"{name}() = {value};")
        old, *more = found.get(name, [{}])
        if others or more or not _is_constant(old):
            hint = f"A constant is one rule without a body: {name}() = {value};"
            raise _refused(f"{name} is not a constant of the program", hint)
        heritage: Any = (value_of(old["head"]["record"]["field_value"][0]) or {})[_HERITAGE]
        spans.append((heritage.start, heritage.stop, value))
        wanted[rules.index(old)]["head"] = new["head"]
    for start, stop, value in sorted(spans, reverse=True):
        lines = text.count("\n", start, stop)
        text = text[:start] + value + "\n" * lines + text[stop:]
    if _without_places(_parsed(text)) != _without_places(wanted):
        raise _refused("the constants can't be written into the program", "Try simpler values.")
    return text


_HERITAGE = "expression_heritage"


def _parsed(text: str) -> list[Rule]:
    parsed = parse_statements(prepare(text))
    if parsed.problems:
        raise ProgramError(tuple(parsed.problems))
    return parsed.rules


def _is_constant(rule: Rule) -> bool:
    """Return whether a rule gives a predicate without arguments one value under no condition."""
    if not rule or rule.keys() - {"head", "full_text"}:
        return False
    record = rule["head"]["record"]
    return fields(record) == [VALUE] and value_of(record["field_value"][0]) is not None


def _refused(message: str, hint: str) -> ProgramError:
    return ProgramError((Diagnostic(1, 1, message, hint),))


def _without_places(tree: Any) -> Any:
    """Return a syntax tree without the pieces of text that its nodes came from."""
    if isinstance(tree, dict):
        return {
            key: _without_places(value)
            for key, value in tree.items()
            if key not in (_HERITAGE, "full_text")
        }
    return [_without_places(each) for each in tree] if isinstance(tree, list) else tree
