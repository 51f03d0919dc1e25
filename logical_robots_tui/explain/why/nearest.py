"""The nearest miss: single changes that would have given a rule a row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from operator import itemgetter
from typing import TYPE_CHECKING

from logical_robots_tui.explain.why.deriving import value_of
from logical_robots_tui.explain.why.probing import ORDERING, Call, Probing, RuleParts, Span, Term
from logical_robots_tui.explain.why.refuting import Refuting, Stop
from logical_robots_tui.language.diagnostics import ProgramError, QueryError, closest, distance
from logical_robots_tui.mind.failures import FailureError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.relations import Way
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.derivations import Derivations
    from logical_robots_tui.mind.program import Program

MOST = 5
"""The most suggestions for a rule."""

_MOST_TRIED = 16
_MOST_CALLS = 100  # calls of a function that are followed
_MOST_VALUES = 60
_DEEPEST = 8  # functions that call functions
_ASKED = "NearestMiss"
_ARGUMENT = re.compile(r"\s*(?P<name>[a-z_]\w*)\s*:(?P<value>.*)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A tested change of a span, "" to remove it, after which a rule would have had a row."""

    text: str
    span: Span
    change: str


class Nearest:
    def __init__(
        self, program: Program, derivations: Derivations, given: Mapping[str, Value], limits: Limits
    ) -> None:
        self._program, self._derivations, self._given = program, derivations, given
        self._limits = limits
        self._relations = derivations.relations

    def of(self, probing: Probing, rule: RuleParts) -> Iterator[Suggestion]:
        """Yield single changes that give a rule a row, smallest first; raise Stopped."""
        self._relations.renew()
        stop = self._stop(probing, rule, self._given)
        candidates = sorted(self._of_stop(stop, 0), key=itemgetter(0)) if stop else ()
        distinct: dict[tuple[int, str], Suggestion] = {}
        for _, each in candidates:
            distinct.setdefault((each.span.start, each.change), each)
        tried = list(distinct.values())[:_MOST_TRIED]
        working = (each for each in tried if self._works(probing.predicate, rule.span, each))
        yield from islice(working, MOST)

    # -- what failed ---------------------------------------------------------------------------

    def _stop(
        self, probing: Probing, rule: RuleParts, arguments: Mapping[str, Value]
    ) -> Stop | None:
        wanted = {c: v for c, v in arguments.items() if c not in probing.given}
        given = probing.arguments(arguments)
        try:
            self._derivations.prepare(probing)
            return Refuting(self._relations, probing.queries, given, wanted).stop(rule)
        except FailureError:
            return None

    def _of_stop(self, stop: Stop, depth: int) -> Iterator[tuple[float, Suggestion]]:
        step = stop.step
        span, call = step.span, step.call
        yield from self._of_fields(stop)
        if step.kind == "denial" and span.text.startswith("~"):
            sign = Span(span.start, span.start + 1, span.line, "~")
            said = f"`{span.text[1:].strip()}` has rows; without ~ the rule holds."
            yield 5.0, Suggestion(said, sign, "")
        elif call is not None:
            known = self._program.predicate(call.predicate)
            if known is not None and known.is_function and depth < _DEEPEST:
                yield from self._of_function(call, stop.ways, depth)
            yield from self._of_call(call.predicate, span)
        elif step.kind in ("condition", "value"):
            yield from self._of_condition(span, step.terms, stop.ways)

    def _of_function(
        self, call: Call, ways: Sequence[Way], depth: int
    ) -> Iterator[tuple[float, Suggestion]]:
        try:
            function = self._derivations.decompose(call.predicate, call.within)
        except QueryError:
            return
        places = {c: p for c, p in call.arguments.items() if c in function.given}
        calls = [{c: value_of(way, p) for c, p in places.items()} for way in ways]
        different = list({repr(each): each for each in calls}.values())[:_MOST_CALLS]
        stops: dict[str, Stop] = {}  # by the step's query, with the ways of all calls
        for rule in function.rules:
            for arguments in different:
                stop = self._stop(function, rule, arguments)
                if stop is not None:
                    before = stops.get(stop.step.query)
                    found = [*before.ways, *stop.ways] if before else stop.ways
                    stops[stop.step.query] = replace(stop, ways=found)
        for stop in stops.values():
            yield from self._of_stop(stop, depth + 1)

    def _of_condition(
        self, span: Span, terms: Sequence[Term], ways: Sequence[Way]
    ) -> Iterator[tuple[float, Suggestion]]:
        for term in terms:
            if term.kind == "truth":
                yield from self._of_condition(term.span, term.parts, ways)
        if len(terms) == 2:
            left, right = terms
            between = self._program.text[left.span.stop : right.span.start]
            operator = between.strip("() \n")
            if operator == "==":
                yield from self._of_equation(left, right, ways)
            elif operator in ORDERING:
                yield from self._of_threshold(span, operator, left, right, ways)
        yield 50.0, Suggestion(f"Without `{span.text}` the rule holds.", span, "true")

    # -- candidates ----------------------------------------------------------------------------

    @staticmethod
    def _of_equation(
        left: Term, right: Term, ways: Sequence[Way]
    ) -> Iterator[tuple[float, Suggestion]]:
        if left.kind == "literal":
            left, right = right, left
        for value in _examples(left, ways):
            new = spell(value)
            for other in _examples(right, ways):
                was = spell(other)
                size = _unlikeness(other, value)
                if not isinstance(other, str) or right.kind != "literal":
                    said = f"{left.span.text} is {new}, and {right.span.text} is {was}."
                    yield size + 1, Suggestion(said, right.span, new)
                    continue
                said = f"{left.span.text} is {new}, not {was}."
                yield size, Suggestion(said, right.span, new)
                if other.lower() in ("true", "false") and value in (0, 1):
                    yield 0.0, Suggestion(said, right.span, other.lower())

    @staticmethod
    def _of_threshold(
        span: Span, operator: str, left: Term, right: Term, ways: Sequence[Way]
    ) -> Iterator[tuple[float, Suggestion]]:
        pairs = [(value_of(way, left.column), value_of(way, right.column)) for way in ways]
        lacks = [
            one - other
            for one, other in pairs
            if isinstance(one, int | float) and isinstance(other, int | float)
        ]
        if not lacks:
            return
        is_less = operator[0] == "<"
        lack = abs(min(lacks) if is_less else max(lacks))
        limit = right.span.text
        sign, what = ("+", "too much") if is_less else ("-", "too little")
        more = lack * 1.001 + 0.001
        try:
            number = float(limit)
            new = f"{number + more if is_less else number - more:.6g}"
            size = lack / (abs(number) or 1)
        except ValueError:
            new, size = f"({limit}) {sign} {more:.6g}", 1.0
        how = f"{lack:.4g} {what}" if lack else "exactly the limit"
        said = f"`{span.text}` fails: {left.span.text} is {how}."
        yield min(size, 10.0), Suggestion(said, right.span, new)

    def _of_fields(self, stop: Stop) -> Iterator[tuple[float, Suggestion]]:
        within = stop.step.span
        for step in stop.clause.steps:
            if step.call is None or step.call.predicate != "Memory" or not stop.ways:
                continue
            memory = value_of(stop.ways[0], step.call.arguments.get("memory", ""))
            there = list(map(str, memory)) if isinstance(memory, dict) else []
            for read in step.reads:
                name = read.names[0] if read.names else ""
                if not name or name in there:
                    continue
                close = closest(name, there, 0.6)
                pattern = re.compile(rf"\.\s*({re.escape(name)})\b")
                for found in pattern.finditer(self._program.text, within.start, within.stop):
                    span = self._span(*found.span(1))
                    for other in there:
                        said = f"memory has no field {name}; it has {other}."
                        size = 0.5 if other == close else 3.0
                        yield size, Suggestion(said, span, other)

    def _of_call(self, predicate: str, span: Span) -> Iterator[tuple[float, Suggestion]]:
        for start, stop in _arguments(self._program.text, span):
            named = _ARGUMENT.fullmatch(self._program.text[start:stop])
            if named is None:
                continue
            name, value = named["name"], named["value"].strip()
            argument = self._span(start, stop)
            there = self._known(predicate, name)
            if value.startswith('"') and value.endswith('"'):
                for other in there:
                    new = spell(other)
                    said = f"{predicate} has {name} {new}, not {value}."
                    size = _unlikeness(value[1:-1], other)
                    yield size, Suggestion(said, argument, f"{name}: {new}")
            listed = ", ".join(map(spell, there[:3]))
            has = f" It has {listed}." if listed else ""
            said = f"`{span.text}` fails in the column {name} alone.{has}"
            yield 4.0, Suggestion(said, argument, "")
        said = f"`{span.text}` has no rows; with ~ before it the rule holds."
        yield 6.0, Suggestion(said, replace(span, stop=span.start), "~")
        yield 50.0, Suggestion(f"Without `{span.text}` the rule holds.", span, "")

    def _known(self, predicate: str, column: str) -> list[Value]:
        try:
            rows = self._relations.rows(predicate)
        except FailureError:
            return []
        return list({str(row[column]): row[column] for row in rows if column in row}.values())

    # -- testing a change ---------------------------------------------------------------------

    def _works(self, predicate: str, rule: Span, suggestion: Suggestion) -> bool:
        span, change = suggestion.span, suggestion.change
        text = self._program.text
        if not change and text[span.start : span.stop] != "~":
            span = _with_comma(text, span)
        changed = text[: span.start] + change + text[span.stop :]
        moved = len(changed) - len(text)
        start = rule.start + (moved if span.start < rule.start else 0)
        stop = rule.stop + (moved if span.start < rule.stop else 0)
        written = changed[start:stop].replace(predicate, _ASKED, 1)
        try:
            program = replace(self._program, text=changed)
            rows = self._relations.answer(program, f"{written};", self._limits)
        except (ProgramError, FailureError):
            return False
        wanted = self._given.items()
        row = next((row for row in rows if all(row.get(c) == value for c, value in wanted)), {})
        return any(value is not None for value in row.values())

    def _span(self, start: int, stop: int) -> Span:
        text = self._program.text
        return Span(start, stop, text.count("\n", 0, start) + 1, text[start:stop].strip())


def _examples(term: Term, ways: Sequence[Way]) -> list[Value]:
    values = [value_of(way, term.column) for way in ways]
    found: dict[str, Value] = {repr(v): v for v in values if isinstance(v, str | int | float)}
    return list(found.values())[:_MOST_VALUES]


def _unlikeness(text: Value, other: Value) -> float:
    """Return the dissimilarity of two values: 0 if only case or type differs."""
    one, two = str(text), str(other)
    if one.lower() == two.lower():
        return 0.0
    return distance(one.lower(), two.lower()) / max(1, min(len(one), len(two))) * 4


def _arguments(text: str, call: Span) -> Iterator[tuple[int, int]]:
    start = text.find("(", call.start, call.stop) + 1
    depth, begin, is_quoted = 0, start, False
    for at in range(start, call.stop):
        character = text[at]
        if character == '"':
            is_quoted = not is_quoted
        elif is_quoted:
            continue
        elif character in "([{":
            depth += 1
        elif (character == ")" and not depth) or (character == "," and not depth):
            if text[begin:at].strip():
                yield begin, at
            begin = at + 1
            if character == ")":
                return
        elif character in ")]}":
            depth -= 1


def _with_comma(text: str, span: Span) -> Span:
    stop = span.stop
    while stop < len(text) and text[stop].isspace():
        stop += 1
    if text[stop : stop + 1] == ",":
        return replace(span, stop=stop + 1)
    start = span.start
    while start and text[start - 1].isspace():
        start -= 1
    return replace(span, start=start - 1) if text[start - 1 : start] == "," else span
