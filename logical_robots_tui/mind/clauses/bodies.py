"""Pieces of bodies, heads and calls in the syntax tree. In the compile process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses.scopes import column_name, flat
from logical_robots_tui.mind.compiling.rules import value_of
from logical_robots_tui.mind.why.probing import Call

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule

__all__ = [
    "Names",
    "TooManyError",
    "alternatives",
    "head_of",
    "is_denial",
    "plain_text",
    "values_in",
]

MOST_CLAUSES = 32


class Names:
    """What is known of the predicates that rules may call.

    Args:
        functions: By name of one that has rows only for given arguments the columns to give.
        tables: By name of any other the table with its rows.
        origins: By name of a copy what it is a copy of, and in which predicate.
    """

    def __init__(
        self,
        functions: Mapping[str, Collection[str]],
        tables: Mapping[str, str],
        origins: Mapping[str, tuple[str, str]],
    ) -> None:
        self.functions = functions
        self.tables = tables
        self.origins = origins

    def is_own(self, name: str) -> bool:
        """Whether the program has rules for a predicate."""
        return name in self.functions or name in self.tables

    def call(self, name: str, arguments: Mapping[str, str]) -> Call:
        """A call of a predicate."""
        return Call(*self.origins.get(name, (name, "")), arguments)


def head_of(rule: Rule) -> tuple[dict[str, Rule], dict[str, Rule]]:
    """The expressions of the columns of a head, and the aggregations of the others."""
    fields = rule["head"]["record"]["field_value"]
    plain = {column_name(f["field"]): value_of(f) for f in fields if f["field"] != "*"}
    others = {column_name(f["field"]): f["value"].get("aggregation") for f in fields}
    return (
        {column: value for column, value in plain.items() if value is not None},
        {column: value for column, value in others.items() if value is not None},
    )


def alternatives(body: Iterable[Rule]) -> list[tuple[list[Rule], list[Rule]]]:
    """Each choice of alternatives: the parts of the body then, and what was chosen.

    Raises:
        TooManyError: There are more than can be told.
    """
    found: list[tuple[list[Rule], list[Rule]]] = [([], [])]
    for part in body:
        options: list[tuple[list[Rule], list[Rule]]] = [([part], [])]
        if "disjunction" in part:
            options = [
                (parts, [branch, *taken])
                for branch in part["disjunction"]["disjunct"]
                for parts, taken in alternatives(flat(branch))
            ]
        if len(found) * len(options) > MOST_CLAUSES:
            raise TooManyError
        found = [
            ([*parts, *more], [*taken, *chosen])
            for parts, taken in found
            for more, chosen in options
        ]
    return found


class TooManyError(Exception):
    """A body has more choices of alternatives than can be told one by one."""


def values_in(call: Rule, column: str) -> Iterator[Rule]:
    """The expression that a call has for a column, if it has one."""
    for argument in call.get("record", {}).get("field_value", ()):
        if column_name(argument["field"]) == column and "expression" in argument["value"]:
            yield argument["value"]["expression"]


def is_denial(combine: Rule) -> bool:
    """Whether this is how the package writes that something has no rows."""
    (column,) = combine["head"]["record"]["field_value"]
    argument = column["value"].get("aggregation", {}).get("argument", {})
    literal = argument.get("literal", {}).get("the_number", {}).get("number")
    return literal == "1" and not hasattr(literal, "heritage")


def plain_text(tree: Any) -> str:
    """A text that is the same for the same expressions, wherever they stand."""
    if isinstance(tree, dict):
        inner = (f"{k}:{plain_text(v)}" for k, v in tree.items() if k not in _HERITAGE)
        return f"{{{','.join(inner)}}}"
    if isinstance(tree, list):
        return f"[{','.join(map(plain_text, tree))}]"
    return repr(str(tree))


_HERITAGE = ("expression_heritage", "full_text")
