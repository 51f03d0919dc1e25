"""Parts of bodies, heads and calls in the syntax tree. In the compile process."""

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
    """What is known about the predicates that rules may call.

    Args:
        functions: For each predicate that needs arguments, the columns that must be given.
        tables: For each other predicate, the table with its rows.
        origins: For each copy, its original and the predicate that it belongs to.
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
        """Return whether the program defines a predicate."""
        return name in self.functions or name in self.tables

    def call(self, name: str, arguments: Mapping[str, str]) -> Call:
        """Return a call of a predicate."""
        return Call(*self.origins.get(name, (name, "")), arguments)


def head_of(rule: Rule) -> tuple[dict[str, Rule], dict[str, Rule]]:
    """Return the expressions of a head's plain columns, and the aggregations of the others."""
    fields = rule["head"]["record"]["field_value"]
    plain = {column_name(f["field"]): value_of(f) for f in fields if f["field"] != "*"}
    others = {column_name(f["field"]): f["value"].get("aggregation") for f in fields}
    return (
        {column: value for column, value in plain.items() if value is not None},
        {column: value for column, value in others.items() if value is not None},
    )


def alternatives(body: Iterable[Rule]) -> list[tuple[list[Rule], list[Rule]]]:
    """Yield each choice of alternatives: the parts of the body, and what was chosen.

    Raises:
        TooManyError: There are too many to show.
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
    """A body has too many choices of alternatives."""


def values_in(call: Rule, column: str) -> Iterator[Rule]:
    """Return the expression that a call has for a column, or None."""
    for argument in call.get("record", {}).get("field_value", ()):
        if column_name(argument["field"]) == column and "expression" in argument["value"]:
            yield argument["value"]["expression"]


def is_denial(combine: Rule) -> bool:
    """Return whether this is the package's form of a negation."""
    (column,) = combine["head"]["record"]["field_value"]
    argument = column["value"].get("aggregation", {}).get("argument", {})
    literal = argument.get("literal", {}).get("the_number", {}).get("number")
    return literal == "1" and not hasattr(literal, "heritage")


def plain_text(tree: Any) -> str:
    """Return a text that is equal for equal expressions, wherever they are."""
    if isinstance(tree, dict):
        inner = (f"{k}:{plain_text(v)}" for k, v in tree.items() if k not in _HERITAGE)
        return f"{{{','.join(inner)}}}"
    if isinstance(tree, list):
        return f"[{','.join(map(plain_text, tree))}]"
    return repr(str(tree))


_HERITAGE = ("expression_heritage", "full_text")
