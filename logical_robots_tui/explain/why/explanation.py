"""The answer to "why?": a tree whose nodes say what was there, or what was missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.schema import ray_angle
from logical_robots_tui.values import Value

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.probing import Span


@dataclass(frozen=True, slots=True)
class Ask:
    """Which rows to explain.

    Attributes:
        given: Values of some columns.
        within: The predicate made with ``:=`` whose copy of the rules to use, or "".
    """

    predicate: str = "Robot"
    given: Mapping[str, Value] = field(default_factory=dict)
    within: str = ""


@dataclass(frozen=True, slots=True)
class Node:
    """One statement of an explanation.

    Attributes:
        kind: ``column`` of the rule's row, ``contributor`` to an aggregate, ``read`` from a
            sensor or a memory, ``instance`` of a call with other arguments; the others by name.
        text: The subject, often a piece of the program in one line.
        said: The remark on it, or "".
        holds: Whether it gave something; None if that is no question.
        values: Its value; several are examples from several ways.
        more: How many more values there are.
        asked: The question one step deeper.
    """

    kind: Literal[
        "rule",
        "column",
        "call",
        "instance",
        "condition",
        "value",
        "element",
        "denial",
        "alternative",
        "if",
        "coalesce",
        "aggregate",
        "contributor",
        "read",
        "note",
    ]
    text: str
    said: str = ""
    holds: bool | None = None
    values: tuple[Value, ...] = ()
    more: int = 0
    span: Span | None = None
    robot: str = ""
    asked: Ask | None = None
    children: tuple[Node, ...] = ()

    @property
    def ray(self) -> float | None:
        """The angle of the ray that is its first value, or None."""
        return ray_angle(self.values[0]) if self.values else None

    def walk(self, depth: int = 0) -> Iterator[tuple[int, Node]]:
        waiting = [(depth, self)]
        while waiting:
            at, node = waiting.pop()
            yield at, node
            waiting.extend((at + 1, child) for child in reversed(node.children))


@dataclass(frozen=True, slots=True)
class RuleFound:
    """What a rule gave: its number of rows up to a limit, None if unknown.

    Attributes:
        row: The first of the rows, if this rule gives it or contributes to its aggregates.
        stopped_by: The part that no way got past, if it gives no row.
    """

    span: Span
    rows: int | None
    row: Mapping[str, Value] | None
    stopped_by: Node | None
    node: Node


@dataclass(frozen=True, slots=True)
class Explanation:
    """Explains a predicate's rows, or their absence, for one robot.

    Attributes:
        made_from: The predicate whose rules these are, or "".
        rows: How many rows have the given values, up to a limit; `row` is the first.
    """

    asked: Ask
    robot: str
    made_from: str
    rows: int
    row: Mapping[str, Value] | None
    rules: tuple[RuleFound, ...]

    @property
    def nodes(self) -> tuple[Node, ...]:
        return tuple(rule.node for rule in self.rules)


@dataclass(frozen=True, slots=True)
class Proof:
    """A row, or its absence, and the rules that it follows from.

    Attributes:
        is_cut: Whether a larger depth would show more.
    """

    explanation: Explanation
    nodes: tuple[Node, ...]
    complete: bool
    is_cut: bool = False
