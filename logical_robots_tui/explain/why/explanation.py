"""Questions and answers: which rows to explain, trees that say why, sources of values."""

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
    from logical_robots_tui.explain.why.probing import SourceSpan


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
class ProofNode:
    """One statement of an explanation.

    Attributes:
        kind: ``column`` of the rule's row, ``contributor`` to an aggregate, ``read`` from a
            sensor or a memory, ``instance`` of a call with other arguments, another ``derivation``
            of the row; the others by name.
        text: The subject, often a piece of the program in one line.
        holds: Whether it holds or has rows; None where neither applies.
        values: Its value; several are examples from several derivations.
        excess: How many more values there are.
        query: The question one step deeper.
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
        "derivation",
        "alternative",
        "if",
        "coalesce",
        "aggregate",
        "contributor",
        "read",
        "note",
    ]
    text: str
    remark: str = ""
    holds: bool | None = None
    values: tuple[Value, ...] = ()
    excess: int = 0
    span: SourceSpan | None = None
    robot: str = ""
    query: Ask | None = None
    children: tuple[ProofNode, ...] = ()

    @property
    def is_rule(self) -> bool:
        """Whether it is a rule, or a further derivation by it or by another one."""
        return self.kind in ("rule", "derivation")

    @property
    def ray(self) -> float | None:
        """The angle of the ray that is its first value, or None."""
        return ray_angle(self.values[0]) if self.values else None

    def walk(self, depth: int = 0) -> Iterator[tuple[int, ProofNode]]:
        stack = [(depth, self)]
        while stack:
            node_depth, node = stack.pop()
            yield node_depth, node
            stack.extend((node_depth + 1, child) for child in reversed(node.children))


@dataclass(frozen=True, slots=True)
class RuleOutcome:
    """The outcome of a rule: its number of rows up to a limit, None if unknown.

    Attributes:
        row: The first of the rows, if this rule gives it or contributes to its aggregates.
        stopped_by: The part that no derivation got past, if it gives no row.
    """

    span: SourceSpan
    rows: int | None
    row: Mapping[str, Value] | None
    stopped_by: ProofNode | None
    node: ProofNode


@dataclass(frozen=True, slots=True)
class Explanation:
    """Explains a predicate's rows, or their absence, for one robot.

    Attributes:
        made_from: The predicate whose rules these are, or "".
        rows: How many rows have the given values, up to a limit; `row` is the first.
    """

    query: Ask
    robot: str
    made_from: str
    rows: int
    row: Mapping[str, Value] | None
    rules: tuple[RuleOutcome, ...]

    @property
    def nodes(self) -> tuple[ProofNode, ...]:
        return tuple(rule.node for rule in self.rules)

    def __str__(self) -> str:
        marks = {True: "+", False: "-", None: " "}
        return "\n".join(
            f"{'  ' * depth}{marks[node.holds]} {node.text}"
            + (f" = {' or '.join(map(spell, node.values))}" if node.values else "")
            + (f"  ({node.remark})" if node.remark else "")
            for rule in self.nodes
            for depth, node in rule.walk()
        )


@dataclass(frozen=True, slots=True)
class Proof:
    """A row, or its absence, and the rules that it follows from.

    Attributes:
        alternatives: The rules that it does not follow from.
        is_cut: Whether a larger depth would show more.
    """

    explanation: Explanation
    nodes: tuple[ProofNode, ...]
    alternatives: tuple[ProofNode, ...]
    complete: bool
    is_cut: bool = False


Path: TypeAlias = "tuple[str | int, ...]"
"""The way to a part of a value: names of fields and places in lists."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A value to trace, in the first row that answers a query.

    Attributes:
        column: The column of the row; "" for the only one that is not given.
        span: An expression of the row's rule instead of a column.
        variable: A variable of the row's rule instead of a column.
        value: The value of the expression or variable, which tells elements apart.
    """

    query: Ask = field(default_factory=Ask)
    column: str = "memory"
    path: Path = ()
    span: SourceSpan | None = None
    variable: str = ""
    value: Value = None


@dataclass(frozen=True, slots=True)
class Read:
    """A value read from a robot's sensor or memory; a ray is read as a whole."""

    kind: Literal["sensor", "memory"]
    robot: str
    path: Path
    value: Value


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition that chose a branch."""

    span: SourceSpan
    holds: bool


@dataclass(frozen=True, slots=True)
class ValueSource:
    """A value and what it was made from.

    Attributes:
        name: The value as the program writes it.
        span: The expression that made it; None if it was read.
        read: What was read, if it was only read.
        inputs: Distinct values that it was made from; of a constant in a fact, the keys of the
            join that chose the fact.
        decided_by: What the conditions that chose a constant depend on.
        is_constant: Whether the value is written in the program.
    """

    name: str
    value: Value
    span: SourceSpan | None = None
    rule: SourceSpan | None = None
    read: Read | None = None
    conditions: tuple[Condition, ...] = ()
    inputs: tuple[ValueSource, ...] = ()
    excess: int = 0
    decided_by: tuple[ValueSource, ...] = ()
    is_constant: bool = False


def part_of(value: Value, path: Path) -> Value:
    """Return a part of a value, or raise QueryError."""
    for index, name in enumerate(path):
        if isinstance(value, dict) and name in value:
            value = value[str(name)]
        elif isinstance(value, list) and isinstance(name, int) and -len(value) <= name < len(value):
            value = value[name]
        else:
            parent = ".".join(map(str, path[:index])) or "This value"
            raise QueryError(f"{parent} has no part {name}{_parts_of(value)}.")
    return value


def _parts_of(value: Value) -> str:
    if isinstance(value, Mapping):
        return f"; it has {', '.join(value)}" if value else "; it is empty"
    if isinstance(value, list):
        return f"; it is a list of {len(value)}"
    return f"; it is {spell(value)}"


def spell_call(query: Ask) -> str:
    """Return a question as a call: ``Speed(200)``, ``Kind(object: "wall")``, ``F(1) == 2``."""
    values = dict(query.given)
    result = f" == {spell(values.pop(VALUE))}" if VALUE in values else ""
    arguments = []
    for index, (column, value) in enumerate(values.items()):
        is_in_place = column == f"col{index}"
        name = column.removeprefix("col") if column[3:].isdigit() else column
        arguments.append(spell(value) if is_in_place else f"{name}: {spell(value)}")
    return f"{query.predicate}({', '.join(arguments)}){result}"


def type_difference(left: Value, right: Value) -> str:
    """Return a sentence if two values differ only in that one is a text; else ""."""
    if isinstance(left, str) == isinstance(right, str):
        return ""
    text, value = (left, right) if isinstance(left, str) else (right, left)
    with suppress(ValueError, RecursionError):
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
    """Read a predicate with values as a question. Blocks.

    Raises:
        ProgramError: It is something else.
    """
    check_text(text, None)
    call = compile_task(ReadCall(text), Called)
    return Ask(call.predicate, call.given, within)
