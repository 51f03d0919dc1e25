"""An explanation as lines: what a screen and the command line show, without their colours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.mind.why.explaining import MOST_WAYS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.mind.why.explanation import (
        Ask,
        Explanation,
        InsideFound,
        PartFound,
        RuleFound,
    )
    from logical_robots_tui.mind.why.probing import Side, Span
    from logical_robots_tui.values import Value

__all__ = ["Line", "tell"]


@dataclass(frozen=True, slots=True)
class Line:
    """One line of an explanation.

    Attributes:
        depth: How far it stands to the right, from 0.
        kind: ``rule``, ``part``, ``within`` (a heading for parts within a part), ``value`` (of
            something, in `values`) or ``note``.
        text: What it is about, often a piece of the program in one line.
        said: What is said about it, or "".
        holds: Whether it gave something; None where that is no question.
        values: Values that belong to it: several examples of one thing, or one.
        is_truth: Whether these are truths, which SQLite writes as 0 and 1.
        span: Its place in the program.
        asked: The question one step deeper.
    """

    depth: int
    kind: Literal["rule", "part", "within", "value", "note"]
    text: str
    said: str = ""
    holds: bool | None = None
    values: tuple[Value, ...] = ()
    is_truth: bool = False
    span: Span | None = None
    asked: Ask | None = None


def tell(explanation: Explanation) -> Iterator[Line]:
    """The lines of an explanation, from the top."""
    if explanation.made_from:
        said = f"is made from {explanation.made_from}, whose rules these are"
        yield Line(0, "note", explanation.predicate, said)
    for rule in explanation.rules:
        yield from _rule(rule)


def _rule(found: RuleFound) -> Iterator[Line]:
    span = found.rule.span
    holds = None if found.fixed else _holds(found.rows)
    yield Line(0, "rule", span.text, _outcome(found), holds, span=span)
    if found.problem:
        yield Line(1, "note", "This could not be asked", found.problem)
    yield from _columns(found.fixed)
    yield from _parts(found.found, 1)
    for row in found.examples[:1]:
        yield from _columns(row)


def _columns(row: Mapping[str, Value]) -> Iterator[Line]:
    for column, value in row.items():
        yield Line(1, "value", "value" if column == "logica_value" else column, values=(value,))


def _outcome(found: RuleFound) -> str:
    if found.fixed:
        return "is about something else"
    if found.rows is None:
        return "could not be asked"
    return f"gave {_count(found.rows, 'row')}" if found.rows else "gave no row"


def _holds(ways: int | None) -> bool | None:
    return None if ways is None else ways > 0


def _parts(found: Sequence[PartFound], depth: int) -> Iterator[Line]:
    for each in found:
        yield from _part(each, depth)


def _part(found: PartFound, depth: int) -> Iterator[Line]:
    span = found.part.span
    asked = found.asked[0] if found.asked else None
    holds = _holds(found.ways)
    yield Line(depth, "part", span.text, _ways(found), holds, span=span, asked=asked)
    if found.problem:
        yield Line(depth + 1, "note", "This could not be asked", found.problem)
    for side, values in found.sides:
        if values and (not found.holds or side.is_truth) and _is_news(side, values):
            yield Line(depth + 1, "value", side.text, values=values, is_truth=side.is_truth)
    for name, value in found.new.items():
        if found.part.kind in ("value", "element", "call") and name not in ("sensor", "memory"):
            yield Line(depth + 1, "value", name, values=(value,))
    for each in found.inside:
        yield from _inside(each, depth + 1)
    for ask in found.asked[1:]:
        yield Line(depth + 1, "note", ask.predicate, "is asked here, too", asked=ask)


def _ways(found: PartFound) -> str:
    if found.ways is None:
        return "could not be asked alone"
    if found.ways == 0 and found.elsewhere:
        return f"not here, but in {_count(found.elsewhere, 'way')} elsewhere"
    return _count(found.ways, "way") if found.ways else "in no way"


_WITHIN = {
    "either": ("this alternative holds", "this alternative does not hold"),
    "denied": ("there is such a thing", "there is no such thing"),
    "collected": ("goes over {}", "goes over nothing"),
}


def _inside(found: InsideFound, depth: int) -> Iterator[Line]:
    some, none = _WITHIN[found.inside.kind]
    ways = found.ways
    said = "" if ways is None else some.format(_count(ways, "row")) if ways else none
    yield Line(depth, "within", found.inside.span.text, said, _holds(ways), span=found.inside.span)
    yield from _parts(found.found, depth + 1)


def _is_news(side: Side, values: Sequence[Value]) -> bool:
    """Whether the value of a side says more than its text."""
    return not (len(values) == 1 and side.text in (str(values[0]), f'"{values[0]}"'))


def _count(number: int, what: str) -> str:
    more = " or more" if number >= MOST_WAYS else ""
    return f"{number:,}{more} {what}{'' if number == 1 else 's'}"
