"""The nearest miss: single changes that would have given a rule a row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.explain.why.deriving import value_of
from logical_robots_tui.explain.why.probing import ORDERING, Call, Probing, RuleParts, Span, Term
from logical_robots_tui.explain.why.refuting import Refuting, Stop
from logical_robots_tui.language.diagnostics import ProgramError, QueryError, closest, distance
from logical_robots_tui.mind.asking import FailureError
from logical_robots_tui.mind.limits import Limits
from logical_robots_tui.mind.relations import Way
from logical_robots_tui.schema import INPUTS, VALUE
from logical_robots_tui.values import Value, spell
from logical_robots_tui.wording import join_names

if TYPE_CHECKING:
    from logical_robots_tui.explain.why.derivations import Derivations
    from logical_robots_tui.mind.program import Program

MOST = 3
"""The most suggestions for a rule."""

_MOST_TRIED = 12
_MOST_CALLS = 100  # calls of a function that are followed
_MOST_VALUES = 60
_DEEPEST = 8  # functions that call functions
_LAST_RESORT = 50.0
_ASKED = "NearestMiss"
_ARGUMENT = re.compile(r"\s*(?:(?P<name>[a-z_]\w*)\s*:)?\s*(?P<value>.*)", re.DOTALL)
_OPPOSITE = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A tested change of a span, "" to remove it, after which a rule would have had a row.

    `advice` says what to change, `reason` why, in words that go on after it.
    """

    advice: str
    reason: str
    span: Span
    change: str

    @property
    def text(self) -> str:
        """One sentence that says what to change and why."""
        return f"{self.advice}: {self.reason}."


_Sized: TypeAlias = "tuple[float, Suggestion]"
"""A suggestion with its size: smaller ones are more likely meant."""


class Nearest:
    def __init__(
        self, program: Program, derivations: Derivations, given: Mapping[str, Value], limits: Limits
    ) -> None:
        self._program, self._derivations, self._given = program, derivations, given
        self._limits = limits
        self._relations = derivations.relations

    def of(self, probing: Probing, rule: RuleParts) -> Iterator[Suggestion]:
        """Yield single changes that give a rule a row, smallest first; raise Stopped.

        That a condition goes is suggested only where nothing else helps.
        """
        self._relations.renew()
        stop = self._stop(probing, rule, self._given)
        candidates = sorted(self._of_stop(rule, stop, 0), key=itemgetter(0)) if stop else ()
        distinct: dict[tuple[int, int, str], _Sized] = {}
        for size, each in candidates:
            distinct.setdefault((each.span.start, each.span.stop, each.change), (size, each))
        found = 0
        for size, each in [*distinct.values()][:_MOST_TRIED]:
            if found == MOST or (found and size >= _LAST_RESORT):
                return
            if self._works(probing.predicate, rule.span, each):
                found += 1
                yield each

    def _stop(
        self, probing: Probing, rule: RuleParts, arguments: Mapping[str, Value]
    ) -> Stop | None:
        wanted = {c: v for c, v in arguments.items() if c not in probing.given}
        given = probing.arguments(arguments)
        try:
            self._derivations.prepare(probing)
            return Refuting(self._derivations, probing, given, wanted).stop(rule)
        except FailureError:
            return None

    def _of_stop(self, rule: RuleParts, stop: Stop, depth: int) -> Iterator[_Sized]:
        step = stop.step
        span, call = step.span, step.call
        is_in_head = ":-" not in self._program.text[rule.span.start : span.start]
        if call is not None and depth < _DEEPEST:
            known = self._program.predicate(call.predicate)
            if known is not None and known.is_function:
                yield from self._of_function(call, stop.ways, depth)
        if is_in_head:
            return
        yield from self._of_fields(stop)
        if step.kind == "denial" and span.text.startswith("~"):
            sign = Span(span.start, span.start + 1, span.line, "~")
            yield 5.0, _removal(sign, f"`{span.text[1:].strip()}` has rows")
        elif step.kind == "call" and call is not None and call.predicate not in INPUTS:
            yield from self._of_call(call, span, stop.ways, binds=bool(step.gives))
        elif step.misread is not None:
            if (meant := step.misread.meant) is not None:
                said = f"Put `{meant.text}` in line {meant.line} in parentheses"
                reason = f"`=` is read before `{step.misread.operator}`"
                written = self._program.text[meant.start : meant.stop]
                yield 0.0, Suggestion(said, reason, meant, f"({written})")
        elif step.kind in ("condition", "value"):
            yield from self._of_condition(span, step.terms, stop.ways)
            if not step.gives:
                yield _LAST_RESORT, _removal(span, "all the rest of the rule holds")

    def _of_function(self, call: Call, ways: Sequence[Way], depth: int) -> Iterator[_Sized]:
        try:
            function = self._derivations.decompose(call.predicate, call.within)
        except QueryError:
            return
        places = {c: p for c, p in call.arguments.items() if c in function.given}
        calls = [{c: value_of(way, p) for c, p in places.items()} for way in ways]
        different = list({repr(each): each for each in calls}.values())[:_MOST_CALLS]
        for rule in function.rules:
            stops: dict[str, Stop] = {}  # by the step's query, with the ways of all calls
            for arguments in different:
                stop = self._stop(function, rule, arguments)
                if stop is not None:
                    before = stops.get(stop.step.query)
                    found = [*before.ways, *stop.ways] if before else stop.ways
                    stops[stop.step.query] = replace(stop, ways=found)
            for stop in stops.values():
                yield from self._of_stop(rule, stop, depth + 1)

    def _of_condition(
        self, span: Span, terms: Sequence[Term], ways: Sequence[Way]
    ) -> Iterator[_Sized]:
        for term in terms:
            if term.kind == "truth":
                yield from self._of_condition(term.span, term.parts, ways)
        if len(terms) == 2:
            left, right = terms
            between = self._program.text[left.span.stop : right.span.start]
            operator = between.strip("() \n")
            if operator in ("==", "="):
                yield from self._of_equation(left, right, ways)
            elif operator in ORDERING:
                at = left.span.stop + between.index(operator)
                sign = self._span(at, at + len(operator))
                yield from self._of_threshold(operator, sign, left, right, ways)
                yield from self._of_threshold(_OPPOSITE[operator], sign, right, left, ways)

    def _of_equation(self, left: Term, right: Term, ways: Sequence[Way]) -> Iterator[_Sized]:
        for term, other in ((left, right), (right, left)):
            if term.kind != "literal":
                for literal in _literals(other):
                    yield from self._of_other_fields(term, _examples(literal, ways), ways)
                    yield from self._of_literal(term, literal, ways)

    @staticmethod
    def _of_literal(term: Term, literal: Term, ways: Sequence[Way]) -> Iterator[_Sized]:
        subject = f"`{term.span.text}` is"
        for value in _examples(term, ways):
            for other in _examples(literal, ways):
                size = _unlikeness(other, value)
                if isinstance(other, str) and other.lower() in ("true", "false"):
                    if value in (0, 1) and not isinstance(value, str):
                        reason = f"{subject} a Boolean, not a string"
                        yield 0.0, _change(literal.span, other.lower(), reason)
                elif size is not None:
                    kind = "the string " if isinstance(value, str) else "the number "
                    kind = kind if isinstance(other, str) != isinstance(value, str) else ""
                    reason = f"{subject} {kind}{spell(value)}"
                    yield size, _change(literal.span, spell(value), reason)

    def _of_other_fields(
        self, term: Term, wanted: Sequence[Value], ways: Sequence[Way]
    ) -> Iterator[_Sized]:
        """Yield the fields beside one that have a text that is wanted of it."""
        if term.kind != "field" or not term.span.text.endswith(f".{term.names[-1]}"):
            return
        span = self._span(term.span.stop - len(term.names[-1]), term.span.stop)
        for way in ways[:_MOST_VALUES]:
            record = value_of(way, term.parts[0].column)
            for name in term.names[:-1]:
                record = record.get(name) if isinstance(record, Mapping) else None
            for name, value in record.items() if isinstance(record, Mapping) else ():
                if isinstance(value, str) and value in wanted and name != term.names[-1]:
                    yield 0.5, _change(span, name, f"`{name}` is {spell(value)}")

    def _of_threshold(
        self, operator: str, sign: Span, left: Term, right: Term, ways: Sequence[Way]
    ) -> Iterator[_Sized]:
        limit = self._constant(right)
        pairs = [(value_of(way, left.column), value_of(way, right.column)) for way in ways]
        lacks = [
            (one - other, one)
            for one, other in pairs
            if isinstance(one, int | float) and isinstance(other, int | float)
        ]
        if limit is None or not lacks or left.kind == "literal":
            return
        is_less = operator[0] == "<"
        lack, value = min(lacks) if is_less else max(lacks)
        subject = f"`{left.span.text}` is {_short(value)}"
        if not lack:
            yield 0.0, _change(sign, f"{sign.text}=", f"{subject}, exactly the limit")
            return
        new = _beyond(value, limit.text, is_less=is_less, is_strict=len(operator) == 1)
        much = f"{_short(abs(lack))} too {'much' if is_less else 'little'}"
        size = abs(lack) / (abs(float(limit.text)) or 1)
        yield min(size, 3.0), _change(limit, new, f"{subject}, {much}")

    def _constant(self, term: Term) -> Span | None:
        """Return the place of the number that a limit is, also through ``Near() = 40;``."""
        if (
            term.kind == "call"
            and term.call is not None
            and not term.call.arguments.keys() - {VALUE}
        ):
            try:
                (rule,) = self._derivations.decompose(term.call.predicate, term.call.within).rules
                (clause,) = rule.clauses
            except (QueryError, ValueError):
                return None
            term = clause.terms.get(VALUE, term)
        try:
            float(term.span.text)
        except ValueError:
            return None
        return term.span

    def _of_fields(self, stop: Stop) -> Iterator[_Sized]:
        within = stop.step.span
        for step in stop.clause.steps:
            if step.call is None or step.call.predicate != "Memory" or not stop.ways:
                continue
            memory = value_of(stop.ways[0], step.call.arguments.get("memory", ""))
            there = list(map(str, memory)) if isinstance(memory, dict) else []
            for read in step.reads:
                name = read.names[0] if read.names else ""
                close = closest(name, there, 0.6)
                if not name or name in there or not close:
                    continue
                pattern = re.compile(rf"\.\s*({re.escape(name)})\b")
                for found in pattern.finditer(self._program.text, within.start, within.stop):
                    span = self._span(*found.span(1))
                    yield 0.5, _change(span, close, f"the memory has no field {name}, but {close}")

    def _of_call(
        self, call: Call, span: Span, ways: Sequence[Way], *, binds: bool
    ) -> Iterator[_Sized]:
        name = call.predicate
        for column, term in call.terms.items():
            yield from self._of_other_fields(term, self._known(name, column), ways)
        for place, (start, stop) in enumerate(_arguments(self._program.text, span)):
            argument = _ARGUMENT.fullmatch(self._program.text, start, stop)
            if argument is None:
                continue
            column, value = argument["name"] or f"col{place}", argument["value"].strip()
            there = self._known(name, column)
            if value.startswith('"') and value.endswith('"'):
                literal = self._span(argument.start("value"), stop)
                for other in there:
                    size = _unlikeness(value[1:-1], other)
                    if size is not None:
                        new = spell(other)
                        has = f"{name} has {argument['name'] or ''} {new}".replace("  ", " ")
                        yield size, _change(literal, new, has)
            elif there and argument["name"]:
                listed = join_names(map(spell, there[:3]))
                more = " and others" if len(there) > 3 else ""
                reason = f"{name} fails in the column {column} alone, which has {listed}{more}"
                yield 4.0, _removal(self._span(start, stop), reason)
        if not binds:
            before = replace(span, stop=span.start)
            said = f"Put `~` before `{span.text}` in line {span.line}"
            if (size := self._size_of_denial(call)) is not None:
                yield size, Suggestion(said, "there is no such row", before, "~")
            yield _LAST_RESORT, _removal(span, "all the rest of the rule holds")

    def _size_of_denial(self, call: Call) -> float | None:
        """Return how likely a call is meant to be denied; None for a table of facts."""
        known = self._program.predicate(call.predicate)
        if known is not None and known.is_function:
            return _LAST_RESORT
        try:
            rules = self._derivations.decompose(call.predicate, call.within).rules
        except QueryError:
            return None
        return 4.5 if any(c.steps for rule in rules for c in rule.clauses) else None

    def _known(self, predicate: str, column: str) -> list[Value]:
        known = self._program.predicate(predicate)
        if known is None or not known.has_rows:
            return []
        try:
            rows = self._relations.rows(predicate)
        except FailureError:
            return []
        return list({str(row[column]): row[column] for row in rows if column in row}.values())

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


def _change(span: Span, new: str, reason: str) -> Suggestion:
    return Suggestion(f"Change `{span.text}` to `{new}` in line {span.line}", reason, span, new)


def _removal(span: Span, reason: str) -> Suggestion:
    return Suggestion(f"Remove `{span.text}` in line {span.line}", reason, span, "")


def _literals(term: Term) -> list[Term]:
    """Return a literal, or those that an ``if`` or ``Coalesce`` may give."""
    if term.kind == "literal":
        return [term]
    if term.kind == "coalesce":
        return [each for part in term.parts for each in _literals(part)]
    if term.kind == "if":
        return [each for part in (*term.parts[1::2], term.parts[-1]) for each in _literals(part)]
    return []


def _examples(term: Term, ways: Sequence[Way]) -> list[Value]:
    values = [value_of(way, term.column) for way in ways]
    found: dict[str, Value] = {repr(v): v for v in values if isinstance(v, str | int | float)}
    return list(found.values())[:_MOST_VALUES]


def _unlikeness(was: Value, other: Value) -> float | None:
    """Return how far a value is from another, 0 if only case or type differs; None if far."""
    one, two = str(was).lower(), str(other).lower()
    if one == two:
        return 0.0
    if isinstance(was, str) and isinstance(other, str):
        size = distance(one, two)
        return 1.0 * size if size <= min(len(one), len(two), 9) // 3 else None
    if isinstance(was, int) and isinstance(other, int):
        return 1.0 if abs(was - other) <= 1 else None
    return None


def _short(value: float) -> str:
    return format(Decimal(f"{value:.4g}"), "f")


def _beyond(value: float, limit: str, *, is_less: bool, is_strict: bool) -> str:
    """Return the next round number after a value, with about as many digits as a limit."""
    digits = len(limit.partition(".")[2])
    is_whole = digits == 0 and float(value).is_integer()
    while not is_whole and 10.0**-digits > 0.1 * max(abs(value), abs(float(limit))) and digits < 6:
        digits += 1
    unit, exact = Decimal(1).scaleb(-digits), Decimal(repr(value))
    rounding = ROUND_CEILING if is_less else ROUND_FLOOR
    new = exact.quantize(unit, rounding)
    if new == exact and is_strict:
        new += unit if is_less else -unit
    return format(new, "f")


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
