"""Values whose source is asked for, and the answer: what each was made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.explain.why.explanation import Ask
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.probing import Span

Path: TypeAlias = "tuple[str | int, ...]"
"""The way to a part of a value: names of fields and places in lists."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A value whose source is asked for, in a predicate's first such row.

    Attributes:
        column: The column of the row; "" for the only one that is not given.
        span: An expression of the row's rule instead of a column.
        variable: A variable of the row's rule instead of a column.
        value: The value of the expression or variable, which tells elements apart.
    """

    asked: Ask = field(default_factory=Ask)
    column: str = "memory"
    path: Path = ()
    span: Span | None = None
    variable: str = ""
    value: Value = None


@dataclass(frozen=True, slots=True)
class Read:
    """Something that was read from a robot's sensor or memory; of a ray, all of it."""

    what: Literal["sensor", "memory"]
    robot: str
    path: Path
    value: Value


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition that chose a branch."""

    span: Span
    holds: bool


@dataclass(frozen=True, slots=True)
class Source:
    """A value and what it was made from.

    Attributes:
        name: The value as the program writes it.
        span: The expression that made it; None if it was read.
        rule: The rule that this expression is in.
        read: What was read, if it was only read.
        inputs: Distinct values that it was made from; of a constant in a fact, the keys of the
            join that chose the fact.
        more: How many more there are.
        decided_by: What the conditions that chose a constant depend on.
        is_constant: Whether the program says the value itself.
    """

    name: str
    value: Value
    span: Span | None = None
    rule: Span | None = None
    read: Read | None = None
    conditions: tuple[Condition, ...] = ()
    inputs: tuple[Source, ...] = ()
    more: int = 0
    decided_by: tuple[Source, ...] = ()
    is_constant: bool = False


def part_of(value: Value, path: Path) -> Value:
    """Return a part of a value, or raise QueryError."""
    for place, name in enumerate(path):
        if isinstance(value, dict) and name in value:
            value = value[str(name)]
        elif isinstance(value, list) and isinstance(name, int) and -len(value) <= name < len(value):
            value = value[name]
        else:
            here = ".".join(map(str, path[:place])) or "this value"
            raise QueryError(f"{here} has no part {name}{_parts_of(value)}.")
    return value


def _parts_of(value: Value) -> str:
    if isinstance(value, Mapping):
        return f"; it has {', '.join(value)}" if value else "; it is empty"
    if isinstance(value, list):
        return f"; it is a list of {len(value)}"
    return f"; it is {spell(value)}"
