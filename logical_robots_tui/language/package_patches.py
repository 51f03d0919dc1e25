"""Replacements for functions of the `logica` package; most halve the compile time.

They visit shared subtrees once and don't copy texts. They also quote or rename columns and
predicates named like an SQL keyword, such as ``from`` or ``Index``, on which SQLite fails.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from logica.compiler import dialects, expr_translate, functors, rule_translate, universe
from logica.parser_py import parse

from logical_robots_tui.language.tree import Name

_NEVER_CHANGE = {parse.HeritageAwareString, Name, str, int, float, bool, type(None)}


def replace_variable(old_var: Any, new_expr: Any, s: dict[str, Any] | list[Any]) -> None:
    """Replace a variable in a syntax tree, in place, without copying the new expression."""
    assert isinstance(s, dict | list)
    stack: list[Any] = [s]
    visited = set()
    while stack:
        node = stack.pop()
        if id(node) in visited:
            continue
        visited.add(id(node))
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            if isinstance(value, dict):
                if "variable" in value and value["variable"]["var_name"] == old_var:
                    node[key] = value = new_expr
                if isinstance(value, dict | list):
                    stack.append(value)
            elif isinstance(value, list):
                stack.append(value)


def mentioned_variables(
    x: Any, dive_in_combines: bool = False, this_is_select: bool = False
) -> set[Any]:
    """Return the variables' names; in a select, ``variable`` may also be a column."""
    names = set()
    stack = [x]
    visited = set()
    while stack:
        node = stack.pop()
        if id(node) in visited:
            continue
        visited.add(id(node))
        if isinstance(node, dict):
            if "variable" in node and not (this_is_select and node is x):
                names.add(node["variable"]["var_name"])
            for key, value in node.items():
                if isinstance(value, dict | list) and (dive_in_combines or key != "combine"):
                    stack.append(value)
        elif isinstance(node, list):
            stack += [value for value in node if isinstance(value, dict | list)]
    return names


def deep_copy(node: Any, copies: dict[int, Any] | None = None) -> Any:
    """Copy a syntax tree; texts are shared with the original, and shared subtrees stay shared."""
    kind = type(node)
    if kind in _NEVER_CHANGE:
        return node
    copies = {} if copies is None else copies
    if kind is not dict and kind is not list:
        return copy.deepcopy(node, copies)
    duplicate: Any = copies.get(id(node))
    if duplicate is None:
        duplicate = copies[id(node)] = kind()
        if kind is dict:
            for key, value in node.items():
                duplicate[key] = deep_copy(value, copies)
        else:
            for value in node:
                duplicate.append(deep_copy(value, copies))
    return duplicate


def _slice(self: parse.HeritageAwareString, start: int, stop: int) -> parse.HeritageAwareString:
    size = len(self)
    part = parse.HeritageAwareString.__new__(
        parse.HeritageAwareString, str.__getitem__(self, slice(start, stop))
    )
    part.start = self.start + start
    part.stop = self.start + (size if stop > size else stop if stop >= 0 else size + stop)
    part.heritage = self.heritage
    return part


def _item(self: parse.HeritageAwareString, place: int | slice) -> str:
    if isinstance(place, slice):
        stop = place.stop
        part: str = _slice(self, place.start or 0, len(self) if stop is None else stop)
        return part
    character: str = str.__getitem__(self, place)
    return character


_traverse = parse.Traverse


def _traverse_plain(text: str) -> Iterator[tuple[int, str | None, str]]:
    """Yield each position with the brackets open there, as the package does."""
    positions: Iterator[tuple[int, str | None, str]] = _traverse(str(text))
    return positions


def split(text: parse.HeritageAwareString, separator: str) -> list[parse.HeritageAwareString]:
    """Split at separators outside brackets, as `SplitRaw` does.

    Raises:
        ParsingException: A bracket matches nothing.
        RecursionError: An expression has too many operators in a row.
    """
    plain = str(text)
    if separator not in plain and _is_balanced(plain):
        return [text]
    parts = []
    begin = 0
    places = _traverse(plain)
    for place, state, status in places:
        if status != "OK":
            raise parse.ParsingException("Parenthesis matches nothing.", text[place : place + 1])
        end = place + len(separator)
        if (
            not state
            and plain.startswith(separator, place)
            and plain[end : end + 1] != "|"
            and (place == 0 or plain[place - 1] != "|")
        ):
            parts.append(text[begin:place])
            for _ in separator[1:]:
                end = next(places)[0] + 1
            begin = end
    parts.append(text[begin:])
    most = _MOST_OPERANDS * (1 + (separator == "="))  # == has two
    if len(parts) > most and separator in _OPERATORS:
        raise RecursionError
    return parts


_OPERATORS = {
    *("||", "&&", "->", "==", "<=", ">=", "<", ">", "!=", "=", " in ", " is not ", " is "),
    *("++?", "++", "+", "-", "*", "/", "%", "^", "!", ".", "=>"),
}
_MOST_OPERANDS = 340
"""Operands in a row. The package parses each one level deeper, at least three frames of Python's
thousand, and takes minutes to get there with many."""


@lru_cache(maxsize=8)  # of one text the package looks for each operator
def _is_balanced(text: str) -> bool:
    return all(status == "OK" for _, _, status in _traverse(text))


_infix = parse.ParseInfix


def infix(
    text: parse.HeritageAwareString, operators: Any = None, disallow_operators: Any = None
) -> Any:
    """Parse an expression with an operator; ``a => b`` may be one, as in a body."""
    if "=>" in text and operators is None and disallow_operators:  # so it is an expression
        implication = parse.ParsePropositionalImplication(text)
        if implication:
            return implication["predicate"]
    return _infix(text, operators, disallow_operators)


_NEWLINE = {"SqLite": "char(10)", "DuckDB": "chr(10)"}


_text_literal = expr_translate.QL.StrLiteral


def text_literal(self: Any, literal: Any) -> Any:
    """Return a text in SQL; the package indents lines, also those of texts."""
    newline = _NEWLINE.get(self.dialect.Name())
    if newline is None or "\n" not in literal["the_string"]:
        return _text_literal(self, literal)
    quoted = _text_literal(self, literal).replace("\n", f"' || {newline} || '")
    return f"({quoted})"


_WORDS = """
    add all alter and as autoincrement between case cast check collate commit constraint create
    current_date current_time current_timestamp default deferrable delete distinct drop else escape
    except exists foreign from group having in index insert intersect into is isnull join limit not
    nothing notnull null on or order primary raise references returning select set table then to
    transaction union unique update using values when where
"""

_RESERVED = frozenset(_WORDS.split())

_MORE_WORDS = """
    abort action after always analyze anti any array asc asof attach before begin both by cascade
    collate column conflict cross current database desc describe detach do each end except exclude
    exclusive explain fail false filter first following for full generated glob groups ignore
    immediate indexed initially inner instead interval key lateral last leading left like map match
    materialized natural no nulls of offset only others outer over partition pivot plan positional
    pragma preceding qualify query range recursive regexp reindex release rename replace restrict
    right rollback row rows savepoint semi show some struct summarize temp temporary ties trailing
    trigger true unbounded unpivot vacuum view virtual window with within without
"""

_NO_ALIASES = _RESERVED | frozenset(_MORE_WORDS.split())
"""Names that a table can't have in a query."""

_to_sql_field = rule_translate.LogicaFieldToSqlField


def sql_field(field: Any) -> Any:
    name = _to_sql_field(field)
    return f'"{name}"' if isinstance(name, str) and name.lower() in _RESERVED else name


_allocate = rule_translate.NamesAllocator.AllocateTable


def table_name(self: Any, hint_for_user: Any = None) -> Any:
    if isinstance(hint_for_user, str) and hint_for_user.lower() in _NO_ALIASES:
        self.allocated_tables.add(hint_for_user)
    return _allocate(self, hint_for_user)


def install() -> None:
    """Patch the package's functions, for the whole process."""
    parse.HeritageAwareString.GetSlice = _slice
    parse.HeritageAwareString.__getitem__ = _item
    parse.Traverse = _traverse_plain
    parse.SplitRaw = split
    parse.ParseInfix = infix
    rule_translate.ReplaceVariable = replace_variable
    rule_translate.AllMentionedVariables = mentioned_variables
    for module in (dialects, expr_translate, functors, parse, rule_translate, universe):
        module.copy = SimpleNamespace(deepcopy=deep_copy)
    rule_translate.LogicaFieldToSqlField = sql_field
    expr_translate.QL.StrLiteral = text_literal
    rule_translate.NamesAllocator.AllocateTable = table_name
