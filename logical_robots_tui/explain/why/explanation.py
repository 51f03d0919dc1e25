"""What is asked for and what is answered: questions, trees that say why, sources of values."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

from logical_robots_tui.explain.why.probing import Called, ReadCall
from logical_robots_tui.language.diagnostics import QueryError
from logical_robots_tui.mind.compilation import check_text, compile_task
from logical_robots_tui.schema import VALUE, ray_angle
from logical_robots_tui.values import Value, read_value, spell

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

    @property
    def key(self) -> str:
        return json.dumps([self.predicate, self.within, self.given], sort_keys=True)


@dataclass(frozen=True, slots=True)
class Node:
    """One statement of an explanation.

    Attributes:
        kind: ``column`` of the rule's row, ``contributor`` to an aggregate, ``read`` from a
            sensor or a memory, ``instance`` of a call with other arguments; the others by name.
        text: The subject, often a piece of the program in one line.
        said: The remark on it, or "".
        holds: Whether it gave something; None if that is not a question.
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

    def __str__(self) -> str:
        marks = {True: "+", False: "-", None: " "}
        return "\n".join(
            f"{'  ' * depth}{marks[node.holds]} {node.text}"
            + (f" = {' or '.join(map(spell, node.values))}" if node.values else "")
            + (f"  ({node.said})" if node.said else "")
            for rule in self.nodes
            for depth, node in rule.walk()
        )


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
            here = ".".join(map(str, path[:place])) or "This value"
            raise QueryError(f"{here} has no part {name}{_parts_of(value)}.")
    return value


def _parts_of(value: Value) -> str:
    if isinstance(value, Mapping):
        return f"; it has {', '.join(value)}" if value else "; it is empty"
    if isinstance(value, list):
        return f"; it is a list of {len(value)}"
    return f"; it is {spell(value)}"


def spell_call(asked: Ask) -> str:
    """Return a question as a call: ``Speed(200)``, ``Kind(object: "wall")``, ``F(1) == 2``."""
    given = dict(asked.given)
    result = f" == {spell(given.pop(VALUE))}" if VALUE in given else ""
    arguments = []
    for place, (column, value) in enumerate(given.items()):
        is_in_place = column == f"col{place}"
        name = column.removeprefix("col") if column[3:].isdigit() else column
        arguments.append(spell(value) if is_in_place else f"{name}: {spell(value)}")
    return f"{asked.predicate}({', '.join(arguments)}){result}"


def unlike_types(one: Value, other: Value) -> str:
    """Return that two values differ in nothing but that one is a text, or ""."""
    if isinstance(one, str) == isinstance(other, str):
        return ""
    text, value = (one, other) if isinstance(one, str) else (other, one)
    with suppress(ValueError):
        if read_value(str(text)) == value:
            return f"string {spell(text)} is not {_kind(value)}{spell(value)}"
    return ""


def _kind(value: Value) -> str:
    if value is None or isinstance(value, bool):
        return ""
    if isinstance(value, int | float):
        return "the number "
    return "the record " if isinstance(value, Mapping) else "the list "


def read_call(text: str, within: str = "") -> Ask:
    """Return the question that a predicate with values is. Blocks.

    Raises:
        ProgramError: It is something else.
    """
    check_text(text, None)
    called = compile_task(ReadCall(text), Called)
    return Ask(called.predicate, called.given, within)
