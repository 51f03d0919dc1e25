"""Functions of the `logica` package that are replaced, most so that compiling takes half the time.

The package puts expressions into each other without copying them, so the same part hangs in many
places, and walks through it once for every place. Here it is walked through once. And for every
character that its parser looks at, it makes texts that know where they stand; but nobody asks that
of what is only looked at. And it copies whole programs again and again, with every text in them,
though texts never change.

Besides, columns and predicates that are called like a word of SQL, such as ``from`` and ``Index``,
are quoted or renamed: the package writes their names as they are, and SQLite stumbles over some.
"""

from __future__ import annotations

import copy
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from logica.compiler import dialects, expr_translate, functors, rule_translate, universe
from logica.parser_py import parse

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "deep_copy",
    "install",
    "mentioned_variables",
    "replace_variable",
    "split",
    "sql_field",
    "table_name",
]

_NEVER_CHANGE = {parse.HeritageAwareString, str, int, float, bool, type(None)}


def replace_variable(old_var: Any, new_expr: Any, s: dict[str, Any] | list[Any]) -> None:
    """Replace a variable in a syntax tree of the package.

    Args:
        old_var: Name of the variable.
        new_expr: The tree that takes its place everywhere; not copied.
        s: The tree; changed in place.
    """
    assert isinstance(s, dict | list)
    waiting: list[Any] = [s]
    seen = set()
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            if isinstance(value, dict):
                if "variable" in value and value["variable"]["var_name"] == old_var:
                    node[key] = value = new_expr
                if isinstance(value, dict | list):
                    waiting.append(value)
            elif isinstance(value, list):
                waiting.append(value)


def mentioned_variables(
    x: Any, dive_in_combines: bool = False, this_is_select: bool = False
) -> set[Any]:
    """Names of the variables in a syntax tree of the package.

    Args:
        x: The tree.
        dive_in_combines: Whether to look into aggregating expressions.
        this_is_select: Whether the tree is a record of columns, one of which may be called
            ``variable``.
    """
    found = set()
    waiting = [x]
    seen = set()
    while waiting:
        node = waiting.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, dict):
            if "variable" in node and not (this_is_select and node is x):
                found.add(node["variable"]["var_name"])
            for key, value in node.items():
                if isinstance(value, dict | list) and (dive_in_combines or key != "combine"):
                    waiting.append(value)
        elif isinstance(node, list):
            waiting += [value for value in node if isinstance(value, dict | list)]
    return found


def deep_copy(tree: Any) -> Any:
    """A copy of a syntax tree of the package, which shares its texts with it.

    What hangs in several places of the tree is one thing in the copy, too.
    """
    return _copied(tree, {})


def _copied(node: Any, done: dict[int, Any]) -> Any:
    kind = type(node)
    if kind in _NEVER_CHANGE:
        return node
    if kind is not dict and kind is not list:
        return copy.deepcopy(node, done)
    found = done.get(id(node))
    if found is None:
        if kind is dict:
            found = done[id(node)] = {}
            for key, value in node.items():
                found[key] = _copied(value, done)
        else:
            found = done[id(node)] = []
            for value in node:
                found.append(_copied(value, done))
    return found


def _slice(self: parse.HeritageAwareString, start: int, stop: int) -> parse.HeritageAwareString:
    """A part of a text that knows where it stands."""
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
    """As the package's: the places of a text, with the brackets that are open there."""
    found: Iterator[tuple[int, str | None, str]] = _traverse(str(text))
    return found


def split(text: parse.HeritageAwareString, separator: str) -> list[parse.HeritageAwareString]:
    """As the package's `SplitRaw`: the parts of a text between separators outside of brackets.

    Raises:
        parse.ParsingException: Brackets or quotes don't match.
    """
    plain = str(text)
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
    return parts


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
"""What a table can't be called in a query."""

_as_it_is = rule_translate.LogicaFieldToSqlField


def sql_field(field: Any) -> Any:
    """The name of a column in SQL.

    Args:
        field: Its name in Logica, or its number.
    """
    name = _as_it_is(field)
    return f'"{name}"' if isinstance(name, str) and name.lower() in _RESERVED else name


_allocate = rule_translate.NamesAllocator.AllocateTable


def table_name(self: Any, hint_for_user: Any = None) -> Any:
    """A name for a table of a query.

    Args:
        self: The package's allocator of names.
        hint_for_user: The name of the predicate whose rows it has.
    """
    if isinstance(hint_for_user, str) and hint_for_user.lower() in _NO_ALIASES:
        self.allocated_tables.add(hint_for_user)
    return _allocate(self, hint_for_user)


def install() -> None:
    """Let the package use them."""
    parse.HeritageAwareString.GetSlice = _slice
    parse.HeritageAwareString.__getitem__ = _item
    parse.Traverse = _traverse_plain
    parse.SplitRaw = split
    rule_translate.ReplaceVariable = replace_variable
    rule_translate.AllMentionedVariables = mentioned_variables
    for module in (dialects, expr_translate, functors, parse, rule_translate, universe):
        module.copy = SimpleNamespace(deepcopy=deep_copy)
    rule_translate.LogicaFieldToSqlField = sql_field
    rule_translate.NamesAllocator.AllocateTable = table_name
