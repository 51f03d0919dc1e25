"""Parsing statement by statement, so that every error is found and every node knows its place.

The package's parser gives each node the text that it came from, with its place. Here that place is
an offset in the program's text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from logica.parser_py import parse

from logical_robots_tui.mind.checking import error_messages
from logical_robots_tui.mind.compiling.rules import nodes
from logical_robots_tui.mind.source_text import INNER_QUOTE, statements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic
    from logical_robots_tui.mind.source_text import Prepared

__all__ = ["Parsed", "parse_statements", "rewritten"]

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
