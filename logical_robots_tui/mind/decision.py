"""A program's decision for one robot in one tick."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from logical_robots_tui.mind.asking import Asking, FailureError
from logical_robots_tui.mind.limits import HEAVIEST_CHARACTER, Limits, weight_of
from logical_robots_tui.mind.sqlite.budget import EvaluationBudget
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
        said = f"Robot has a row for {name!r}, which this program does not control."
        notices.append(Notice("unknown robot", said))


def decide(
    name: str,
    rows: Sequence[Mapping[str, Value]],
    memory: Value,
    known: Sequence[Notice],
    limits: Limits,
    heaviest: int,
) -> Decision:
    """Return the decision from the rows of `Robot` for one robot; the last of several counts."""
    notices = [*known]
    if not rows:
        if not any(n.kind in ("failed", "late") for n in notices):
            notices.append(Notice("no row", f"Robot has no row for {name}: engines stop."))
        return Decision(name, None, memory, tuple(notices))
    if len(rows) > 1:
        notices.append(
            Notice(
                "several rows",
                f"Robot has {len(rows)} rows for {name}{_unlike(*rows[-2:])}: the last one counts.",
            )
        )
    row = rows[-1]
    kept, weight = memory, 0
    if "memory" not in row:
        notices.append(Notice("no memory", "Robot has no memory column: the memory is unchanged."))
    else:
        new, too_much = row["memory"], ""
        size = size_of(new)
        heavy = size if isinstance(new, str) else size * HEAVIEST_CHARACTER
        if size > limits.memory_bytes:
            too_much = f"has {size:,} bytes, more than {limits.memory_bytes:,}"
        elif heavy > heaviest and (heavy := weight_of(new, heaviest)) > heaviest:
            too_much = f"takes more than the {heaviest:,} bytes available to each robot, "
            too_much += "counting its records and lists"
        if too_much:
            said = f"The new memory {too_much}: the memory is unchanged."
            notices.append(Notice("no memory", said))
        else:
            kept, weight = new, heavy
    return Decision(name, _desire(row.get("desire"), notices), kept, tuple(notices), weight)


def _unlike(one: Mapping[str, Value], other: Mapping[str, Value]) -> str:
    """Return in which columns two rows differ, or that they are equal."""
    columns = [column for column in other if one.get(column) != other[column]]
    return f", which differ in {' and '.join(columns)}" if columns else ", which are equal"


def _advice(what: str) -> str:
    return " An aggregation over nothing is null; Coalesce replaces it." if what == "null" else ""


def _desire(value: Value, notices: list[Notice]) -> Desire | None:
    if not isinstance(value, dict):
        what = "null" if value is None else "not a record"
        notices.append(Notice("bad engine", f"The desire is {what}: engines stop.{_advice(what)}"))
        return None
    left, right = value.get("left_engine"), value.get("right_engine")
    if left.__class__ is float and right.__class__ is float and math.isfinite(left + right):
        return Desire(left, right)
    engines = {}
    for engine in DESIRE.names:
        power = _power(value.get(engine))
        if power is None:
            given = value.get(engine)
            what = "null" if given is None else clip(to_json(given), 40)
            if isinstance(given, float) and math.isinf(given):
                what = "infinite"
            what = what if engine in value else "missing"
            notices.append(Notice("bad engine", f"{engine} is {what}: it stops.{_advice(what)}"))
        engines[engine] = power or 0.0
    return Desire(**engines)


_SPELLED = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", re.ASCII)


def _power(value: Value) -> float | None:
    """Return a power as a finite number, or None; numeric text counts, as in JavaScript."""
    if not isinstance(value, (int, float)) and not (
        isinstance(value, str) and _SPELLED.fullmatch(value)
    ):
        return None
    with suppress(OverflowError):
        return power if math.isfinite(power := float(value)) else None
    return None


def blame(
    failure: FailureError,
    asking: Asking,
    needed: Iterable[str],
    moment: Inputs,
    view: View,
    within: EvaluationBudget,
) -> Notice:
    """Find the predicate that failed first, and say so in a notice."""
    whose = " and ".join(view.viewers[:3])
    if len(view.viewers) > 3:
        whose += " and others"
    if failure.slow:
        kind: NoticeKind = "late" if failure.late else "failed"
        return Notice(kind, f"The thought about {whose} failed: {failure}.")

    def failure_of(predicate: str, seen: View) -> FailureError | None:
        try:
            asking.rows(asking.asked(predicate), moment, seen, within)
        except FailureError as found:
            return found
        return None

    culprit, reason = "Robot", str(failure)
    for predicate in needed:
        if found := failure_of(predicate, view):
            if not found.slow:
                culprit, reason = predicate, str(found)
            break
    alone = [one.viewers[0] for one in moment.single_views(view) if failure_of(culprit, one)]
    if 0 < len(alone) <= 3:
        whose = " and ".join(alone)
    return Notice("failed", f"{culprit} failed on the rows of {whose}: {reason}.")


def cut_offs(
    asking: Asking, moment: Inputs, view: View, within: EvaluationBudget
) -> Iterator[Notice]:
    """Yield a notice for each recursion that still changed at its last step."""
    for predicate, steps in asking.still_grew(moment, view, within):
        known = asking.program.predicate(predicate)
        place = f"Line {known.line}: " if known and known.line else ""
        yield Notice(
            "recursion",
            f"{place}The recursion of {predicate} was still growing after "
            f"{steps} steps; later rows are missing. Add a condition that ends it, or allow more "
            f"steps with @Recursive({predicate}, N).",
        )
