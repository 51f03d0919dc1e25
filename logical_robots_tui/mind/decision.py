"""A program's decision for one robot in one tick."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from logical_robots_tui.mind.asking import FailureError, MindDatabases
from logical_robots_tui.mind.limits import MAX_CHARACTER_WEIGHT, Limits, weight_of
from logical_robots_tui.mind.sqlite.budget import QueryBudget
from logical_robots_tui.mind.sqlite.inputs import Inputs, View
from logical_robots_tui.mind.sqlite.stored import size_of, to_json
from logical_robots_tui.schema import DESIRE
from logical_robots_tui.values import Desire, Value
from logical_robots_tui.wording import clip

NoticeKind: TypeAlias = Literal[
    "no row",
    "several rows",
    "bad engine",
    "no memory",
    "null name",
    "unknown robot",
    "failed",
    "late",
    "no room",
    "recursion",
]

UNRELIABLE: frozenset[NoticeKind] = frozenset({"late", "no room"})
"""Kinds of notices that another run may not have."""


@dataclass(frozen=True, slots=True)
class Notice:
    """Something unusual about a decision, in one plain sentence; it never stops the game."""

    kind: NoticeKind
    message: str


@dataclass(frozen=True, slots=True)
class Decision:
    """One robot's desire and new memory, or why there is none.

    Attributes:
        robot_name: The robot.
        desire: The engine power; None stops the robot for this tick.
        memory: What the robot remembers from now on.
        notices: Notices, in order.
        weight: A lower bound for the bytes of the memory's objects; 0 if unknown.
    """

    robot_name: str
    desire: Desire | None
    memory: Value
    notices: tuple[Notice, ...] = ()
    weight: int = field(default=0, compare=False, repr=False)

    @property
    def is_reliable(self) -> bool:
        """Whether it is the same on any machine: no time limit or lack of memory affected it."""
        return not any(notice.kind in UNRELIABLE for notice in self.notices)


def note_stranger(name: Value, notices: list[Notice]) -> None:
    """Note, once, a row of `Robot` for a robot that is not in the level."""
    if any(n.kind in ("null name", "unknown robot") for n in notices):
        return
    if name is None:
        notices.append(Notice("null name", "Robot has a row whose robot_name is null."))
    else:
        message = f"Robot has a row for {name!r}, which this program does not control."
        notices.append(Notice("unknown robot", message))


def decide(
    name: str,
    rows: Sequence[Mapping[str, Value]],
    memory: Value,
    prior_notices: Sequence[Notice],
    limits: Limits,
    max_weight: int,
) -> Decision:
    """Return the decision from the rows of `Robot` for one robot; the last of several counts."""
    notices = [*prior_notices]
    if not rows:
        if not any(n.kind in ("failed", "late") for n in notices):
            notices.append(Notice("no row", f"Robot has no row for {name}: engines stop."))
        return Decision(name, None, memory, tuple(notices))
    if len(rows) > 1:
        difference = _difference(*rows[-2:])
        message = f"Robot has {len(rows)} rows for {name}{difference}: the last one counts."
        notices.append(Notice("several rows", message))
    row = rows[-1]
    next_memory, weight = memory, 0
    if "memory" not in row:
        notices.append(Notice("no memory", "Robot has no memory column: the memory is unchanged."))
    else:
        new_memory, excess = row["memory"], ""
        size = size_of(new_memory)
        upper_bound = size if isinstance(new_memory, str) else size * MAX_CHARACTER_WEIGHT
        if size > limits.memory_bytes:
            excess = f"has {size:,} bytes, more than {limits.memory_bytes:,}"
        elif (
            upper_bound > max_weight
            and (upper_bound := weight_of(new_memory, max_weight)) > max_weight
        ):
            excess = f"takes more than the {max_weight:,} bytes available to each robot, "
            excess += "counting its records and lists"
        if excess:
            message = f"The new memory {excess}: the memory is unchanged."
            notices.append(Notice("no memory", message))
        else:
            next_memory, weight = new_memory, upper_bound
    return Decision(name, _desire(row.get("desire"), notices), next_memory, tuple(notices), weight)


def _difference(first_row: Mapping[str, Value], second_row: Mapping[str, Value]) -> str:
    """Return in which columns two rows differ, or that they are equal."""
    columns = [column for column in second_row if first_row.get(column) != second_row[column]]
    return f", which differ in {' and '.join(columns)}" if columns else ", which are equal"


def _advice(fault: str) -> str:
    return " An aggregation over nothing is null; Coalesce replaces it." if fault == "null" else ""


def _desire(value: Value, notices: list[Notice]) -> Desire | None:
    if not isinstance(value, dict):
        fault = "null" if value is None else "not a record"
        message = f"The desire is {fault}: engines stop.{_advice(fault)}"
        notices.append(Notice("bad engine", message))
        return None
    left, right = value.get("left_engine"), value.get("right_engine")
    if left.__class__ is float and right.__class__ is float and math.isfinite(left + right):
        return Desire(left, right)
    engines = {}
    for engine in DESIRE.names:
        power = _power(value.get(engine))
        if power is None:
            engine_value = value.get(engine)
            fault = "null" if engine_value is None else clip(to_json(engine_value), 40)
            if isinstance(engine_value, float) and math.isinf(engine_value):
                fault = "infinite"
            fault = fault if engine in value else "missing"
            notices.append(Notice("bad engine", f"{engine} is {fault}: it stops.{_advice(fault)}"))
        engines[engine] = power or 0.0
    return Desire(**engines)


_NUMERAL = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", re.ASCII)


def _power(value: Value) -> float | None:
    """Return a power as a finite number, or None; numeric text counts, as in JavaScript."""
    if not isinstance(value, (int, float)) and not (
        isinstance(value, str) and _NUMERAL.fullmatch(value)
    ):
        return None
    with suppress(OverflowError):
        return power if math.isfinite(power := float(value)) else None
    return None


def blame(
    failure: FailureError,
    databases: MindDatabases,
    predicates: Iterable[str],
    inputs: Inputs,
    view: View,
    budget: QueryBudget,
) -> Notice:
    """Return a notice that names the predicate that failed first."""
    program = databases.program
    whose = " and ".join(view.viewers[:3])
    if len(view.viewers) > 3:
        whose += " and others"
    if failure.is_slow:
        kind: NoticeKind = "late" if failure.is_late else "failed"
        reason = failure.reason(program, predicates)
        return Notice(kind, f"The thought about {whose} failed: {reason}.")

    def failure_of(predicate: str, checked_view: View) -> FailureError | None:
        try:
            databases.rows(databases.query_for(predicate), inputs, checked_view, budget)
        except FailureError as predicate_failure:
            return predicate_failure
        return None

    culprit, reason = "Robot", str(failure)
    for predicate in predicates:
        if predicate_failure := failure_of(predicate, view):
            if not predicate_failure.is_slow:
                culprit = predicate
                reason = predicate_failure.reason(program, [predicate])
            break
    names = [part.viewers[0] for part in inputs.single_views(view) if failure_of(culprit, part)]
    if 0 < len(names) <= 3:
        whose = " and ".join(names)
    return Notice("failed", f"{culprit} failed on the rows of {whose}: {reason}.")


def cut_offs(
    databases: MindDatabases, inputs: Inputs, view: View, budget: QueryBudget
) -> Iterator[Notice]:
    """Yield a notice for each recursion that still changed at its last step."""
    for predicate, steps in databases.unfinished_recursions(inputs, view, budget):
        definition = databases.program.predicate(predicate)
        place = f"Line {definition.line}: " if definition and definition.line else ""
        yield Notice(
            "recursion",
            f"{place}The recursion of {predicate} was still growing after "
            f"{steps} steps; later rows are missing. Add a condition that ends it, or allow more "
            f"steps with @Recursive({predicate}, N).",
        )
