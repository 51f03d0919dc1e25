"""The answer to "why?": a tree whose nodes say what was there, or what was missing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.explain.why.probing import Span
    from logical_robots_tui.values import Value


@dataclass(frozen=True, slots=True)
class Ask:
    """The question one step deeper.

    Attributes:
        predicate: The predicate that is asked.
        given: Values of its columns.
        within: The predicate made with ``:=`` in whose copy of the rules it is asked, or "".
    """

    predicate: str
    given: Mapping[str, Value] = field(default_factory=dict)
    within: str = ""


@dataclass(frozen=True, slots=True)
class Node:
    """One statement of an explanation.

    Attributes:
        kind: ``rule``, ``column`` (of its row), ``call``, ``condition``, ``value``, ``element``,
            ``denial``, ``alternative``, ``if``, ``coalesce``, ``aggregate``, ``contributor`` (to
            an aggregate), ``read`` (from a sensor or a memory) or ``note``.
        text: What it is about, often a piece of the program in one line.
        said: What is said about it, or "".
        holds: Whether it gave something; None where that is no question.
        values: Its value; several are examples from several ways.
        more: How many more values there are.
        is_truth: Whether these are truths, which SQLite writes as 0 and 1.
        span: Its place in the program.
        robot: The robot that it is about, or "".
        asked: The question one step deeper.
        children: What it follows from.
    """

    kind: Literal[
        "rule",
        "column",
        "call",
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
    is_truth: bool = False
    span: Span | None = None
    robot: str = ""
    asked: Ask | None = None
    children: tuple[Node, ...] = ()

    @property
    def ray(self) -> float | None:
        """The angle of the ray that is its first value, or None."""
        value = self.values[0] if self.values else None
        if isinstance(value, dict) and {"angle", "distance"} <= value.keys():
            angle = value["angle"]
            return float(angle) if isinstance(angle, int | float) else None
        return None

    def walk(self, depth: int = 0) -> Iterator[tuple[int, Node]]:
        """This node and all below it, from the top, each with its depth."""
        waiting = [(depth, self)]
        while waiting:
            at, node = waiting.pop()
            yield at, node
            waiting.extend((at + 1, child) for child in reversed(node.children))


@dataclass(frozen=True, slots=True)
class RuleFound:
    """What a rule gave.

    Attributes:
        span: The rule.
        rows: How many of the rows that are asked for come from it, up to a limit; None if that
            could not be told.
        row: The first of the rows, by the names of the columns, if this rule gives that; where
            columns are aggregated it contributes to it.
        stopped_by: What none of its ways got past, if it gives no row.
        node: All that there is to tell.
    """

    span: Span
    rows: int | None
    row: Mapping[str, Value] | None
    stopped_by: Node | None
    node: Node


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a predicate has the rows that it has for a robot, or none.

    Attributes:
        predicate: Its name.
        robot: In whose reasoning.
        made_from: The predicate whose rules these are, or "".
        within: The predicate made with ``:=`` in whose copy of the rules it was asked, or "".
        given: The values that were asked for, by the names of the columns.
        rows: How many rows have them, up to a limit.
        row: The first of these rows, which is the one that is explained.
        rules: What each rule gave, in the order of the text.
    """

    predicate: str
    robot: str
    made_from: str
    within: str
    given: Mapping[str, Value]
    rows: int
    row: Mapping[str, Value] | None
    rules: tuple[RuleFound, ...]

    @property
    def nodes(self) -> tuple[Node, ...]:
        """The nodes of all rules."""
        return tuple(rule.node for rule in self.rules)


@dataclass(frozen=True, slots=True)
class Proof:
    """A row, or that there is none, with all that it follows from.

    Attributes:
        explanation: Of the row itself.
        nodes: The rules of it, unfolded: those that give the row, or all if there is none.
        complete: Whether everything was unfolded.
    """

    explanation: Explanation
    nodes: tuple[Node, ...]
    complete: bool
