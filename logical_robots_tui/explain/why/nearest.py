"""The nearest miss: single changes that would have given a rule a row."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

from logical_robots_tui.explain.why.deriving import value_of
from logical_robots_tui.explain.why.probing import (
    ORDERING,
    PredicateCall,
    Probing,
    RuleParts,
    SourceSpan,
    Term,
)
from logical_robots_tui.explain.why.refuting import FailedStep, Refuter
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
_TEST_PREDICATE = "NearestMiss"
_ARGUMENT = re.compile(r"\s*(?:(?P<name>[a-z_]\w*)\s*:)?\s*(?P<value>.*)", re.DOTALL)
_OPPOSITE = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A tested change of a span, "" to remove it, after which a rule would have had a row.

    `advice` says what to change, `reason` continues it and says why.
    """

    advice: str
    reason: str
    span: SourceSpan
    change: str

    @property
    def text(self) -> str:
        """One sentence that says what to change and why."""
        return f"{self.advice}: {self.reason}."


_Sized: TypeAlias = "tuple[float, Suggestion]"
"""A suggestion with its size: smaller ones are more likely meant."""


class Nearest:
    def __init__(
        self,
        program: Program,
        derivations: Derivations,
        values: Mapping[str, Value],
        limits: Limits,
    ) -> None:
        self._program, self._derivations, self._values = program, derivations, values
        self._limits = limits
        self._relations = derivations.relations

    def suggestions(self, probing: Probing, rule: RuleParts) -> Iterator[Suggestion]:
        """Yield single changes that give a rule a row, smallest first; raise Stopped.

        To remove a condition is suggested only where nothing else helps.
        """
        self._relations.budget.renew()
        stop = self._stop(probing, rule, self._values)
        candidates = sorted(self._step_changes(rule, stop, 0), key=itemgetter(0)) if stop else ()
        distinct: dict[tuple[int, int, str], _Sized] = {}
        for size, suggestion in candidates:
            distinct.setdefault(
                (suggestion.span.start, suggestion.span.stop, suggestion.change), (size, suggestion)
            )
        count = 0
        for size, suggestion in [*distinct.values()][:_MOST_TRIED]:
            if count == MOST or (count and size >= _LAST_RESORT):
                return
            if self._works(probing.predicate, rule.span, suggestion):
                count += 1
                yield suggestion

    def _stop(
        self, probing: Probing, rule: RuleParts, values: Mapping[str, Value]
    ) -> FailedStep | None:
        targets = {c: v for c, v in values.items() if c not in probing.parameters}
        arguments = probing.arguments(values)
        try:
            self._derivations.prepare(probing)
            return Refuter(self._derivations, probing, arguments, targets).stop(rule)
        except FailureError:
            return None

    def _step_changes(self, rule: RuleParts, stop: FailedStep, depth: int) -> Iterator[_Sized]:
        step = stop.step
        span, call = step.span, step.call
        is_in_head = ":-" not in self._program.text[rule.span.start : span.start]
        if call is not None and depth < _DEEPEST:
            entry = self._program.predicate(call.predicate)
            if entry is not None and entry.is_function:
                yield from self._function_changes(call, stop.matches, depth)
        if is_in_head:
            return
        yield from self._memory_changes(stop)
        if step.kind == "denial" and span.text.startswith("~"):
            sign = SourceSpan(span.start, span.start + 1, span.line, "~")
            yield 5.0, _removal(sign, f"`{span.text[1:].strip()}` has rows")
        elif step.kind == "call" and call is not None and call.predicate not in INPUTS:
            yield from self._call_changes(call, span, stop.matches, binds=bool(step.bindings))
        elif step.misread is not None:
            if (correction := step.misread.correction) is not None:
                advice = f"Put `{correction.text}` in line {correction.line} in parentheses"
                reason = f"`=` is read before `{step.misread.operator}`"
                text = self._program.text[correction.start : correction.stop]
                yield 0.0, Suggestion(advice, reason, correction, f"({text})")
        elif step.kind in ("condition", "value"):
            yield from self._condition_changes(span, step.terms, stop.matches)
            if not step.bindings:
                yield _LAST_RESORT, _removal(span, "all the rest of the rule holds")

    def _function_changes(
        self, call: PredicateCall, matches: Sequence[Way], depth: int
    ) -> Iterator[_Sized]:
        try:
            function = self._derivations.decompose(call.predicate, call.within)
        except QueryError:
            return
        places = {c: p for c, p in call.arguments.items() if c in function.parameters}
        calls = [{c: value_of(match, p) for c, p in places.items()} for match in matches]
        distinct = list({repr(arguments): arguments for arguments in calls}.values())[:_MOST_CALLS]
        for rule in function.rules:
            stops: dict[str, FailedStep] = {}  # by the step's query, with the matches of all calls
            for arguments in distinct:
                stop = self._stop(function, rule, arguments)
                if stop is not None:
                    earlier = stops.get(stop.step.query)
                    all_matches = [*earlier.matches, *stop.matches] if earlier else stop.matches
                    stops[stop.step.query] = replace(stop, matches=all_matches)
            for stop in stops.values():
                yield from self._step_changes(rule, stop, depth + 1)

    def _condition_changes(
        self, span: SourceSpan, terms: Sequence[Term], matches: Sequence[Way]
    ) -> Iterator[_Sized]:
        for term in terms:
            if term.kind == "truth":
                yield from self._condition_changes(term.span, term.parts, matches)
        if len(terms) == 2:
            left, right = terms
            between = self._program.text[left.span.stop : right.span.start]
            operator = between.strip("() \n")
            if operator in ("==", "="):
                yield from self._equation_changes(left, right, matches)
            elif operator in ORDERING:
                offset = left.span.stop + between.index(operator)
                sign = self._span(offset, offset + len(operator))
                yield from self._threshold_changes(operator, sign, left, right, matches)
                yield from self._threshold_changes(_OPPOSITE[operator], sign, right, left, matches)

    def _equation_changes(
        self, left: Term, right: Term, matches: Sequence[Way]
    ) -> Iterator[_Sized]:
        for term, counterpart in ((left, right), (right, left)):
            if term.kind != "literal":
                for literal in _literals(counterpart):
                    yield from self._field_changes(term, _examples(literal, matches), matches)
                    yield from self._literal_changes(term, literal, matches)

    @staticmethod
    def _literal_changes(term: Term, literal: Term, matches: Sequence[Way]) -> Iterator[_Sized]:
        subject = f"`{term.span.text}` is"
        for value in _examples(term, matches):
            for current in _examples(literal, matches):
                size = _unlikeness(current, value)
                if isinstance(current, str) and current.lower() in ("true", "false"):
                    if value in (0, 1) and not isinstance(value, str):
                        reason = f"{subject} a Boolean, not a string"
                        yield 0.0, _change(literal.span, current.lower(), reason)
                elif size is not None:
                    kind = "the string " if isinstance(value, str) else "the number "
                    kind = kind if isinstance(current, str) != isinstance(value, str) else ""
                    reason = f"{subject} {kind}{spell(value)}"
                    yield size, _change(literal.span, spell(value), reason)

    def _field_changes(
        self, term: Term, texts: Sequence[Value], matches: Sequence[Way]
    ) -> Iterator[_Sized]:
        """Yield the fields beside one that have one of the texts it is compared with."""
        if term.kind != "field" or not term.span.text.endswith(f".{term.names[-1]}"):
            return
        span = self._span(term.span.stop - len(term.names[-1]), term.span.stop)
        for match in matches[:_MOST_VALUES]:
            record = value_of(match, term.parts[0].column)
            for name in term.names[:-1]:
                record = record.get(name) if isinstance(record, Mapping) else None
            for name, value in record.items() if isinstance(record, Mapping) else ():
                if isinstance(value, str) and value in texts and name != term.names[-1]:
                    yield 0.5, _change(span, name, f"`{name}` is {spell(value)}")

    def _threshold_changes(
        self, operator: str, sign: SourceSpan, left: Term, right: Term, matches: Sequence[Way]
    ) -> Iterator[_Sized]:
        limit = self._constant(right)
        pairs = [(value_of(match, left.column), value_of(match, right.column)) for match in matches]
        gaps = [
            (left_value - right_value, left_value)
            for left_value, right_value in pairs
            if isinstance(left_value, int | float) and isinstance(right_value, int | float)
        ]
        if limit is None or not gaps or left.kind == "literal":
            return
        is_less = operator[0] == "<"
        gap, value = min(gaps) if is_less else max(gaps)
        subject = f"`{left.span.text}` is {_short(value)}"
        if not gap:
            yield 0.0, _change(sign, f"{sign.text}=", f"{subject}, exactly the limit")
            return
        new_limit = _beyond(value, limit.text, is_less=is_less, is_strict=len(operator) == 1)
        amount = f"{_short(abs(gap))} too {'much' if is_less else 'little'}"
        size = abs(gap) / (abs(float(limit.text)) or 1)
        yield min(size, 3.0), _change(limit, new_limit, f"{subject}, {amount}")

    def _constant(self, term: Term) -> SourceSpan | None:
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

    def _memory_changes(self, stop: FailedStep) -> Iterator[_Sized]:
        step_span = stop.step.span
        for step in stop.clause.steps:
            if step.call is None or step.call.predicate != "Memory" or not stop.matches:
                continue
            memory = value_of(stop.matches[0], step.call.arguments.get("memory", ""))
            names = list(map(str, memory)) if isinstance(memory, dict) else []
            for term in step.reads:
                name = term.names[0] if term.names else ""
                close = closest(name, names, 0.6)
                if not name or name in names or not close:
                    continue
                pattern = re.compile(rf"\.\s*({re.escape(name)})\b")
                for occurrence in pattern.finditer(
                    self._program.text, step_span.start, step_span.stop
                ):
                    span = self._span(*occurrence.span(1))
                    yield 0.5, _change(span, close, f"the memory has no field {name}, but {close}")

    def _call_changes(
        self, call: PredicateCall, span: SourceSpan, matches: Sequence[Way], *, binds: bool
    ) -> Iterator[_Sized]:
        name = call.predicate
        for column, term in call.terms.items():
            yield from self._field_changes(term, self._column_values(name, column), matches)
        for index, (start, stop) in enumerate(_arguments(self._program.text, span)):
            argument = _ARGUMENT.fullmatch(self._program.text, start, stop)
            if argument is None:
                continue
            column, value = argument["name"] or f"col{index}", argument["value"].strip()
            values = self._column_values(name, column)
            if value.startswith('"') and value.endswith('"'):
                literal = self._span(argument.start("value"), stop)
                for candidate in values:
                    size = _unlikeness(value[1:-1], candidate)
                    if size is not None:
                        new = spell(candidate)
                        reason = f"{name} has {argument['name'] or ''} {new}".replace("  ", " ")
                        yield size, _change(literal, new, reason)
            elif values and argument["name"]:
                examples = join_names(map(spell, values[:3]))
                suffix = " and others" if len(values) > 3 else ""
                reason = f"{name} fails in the column {column} alone, which has {examples}{suffix}"
                yield 4.0, _removal(self._span(start, stop), reason)
        if not binds:
            insertion = replace(span, stop=span.start)
            advice = f"Put `~` before `{span.text}` in line {span.line}"
            if (size := self._size_of_denial(call)) is not None:
                yield size, Suggestion(advice, "there is no such row", insertion, "~")
            yield _LAST_RESORT, _removal(span, "all the rest of the rule holds")

    def _size_of_denial(self, call: PredicateCall) -> float | None:
        """Return how likely a call is meant to be denied; None for a table of facts."""
        entry = self._program.predicate(call.predicate)
        if entry is not None and entry.is_function:
            return _LAST_RESORT
        try:
            rules = self._derivations.decompose(call.predicate, call.within).rules
        except QueryError:
            return None
        return 4.5 if any(c.steps for rule in rules for c in rule.clauses) else None

    def _column_values(self, predicate: str, column: str) -> list[Value]:
        entry = self._program.predicate(predicate)
        if entry is None or not entry.has_rows:
            return []
        try:
            rows = self._relations.rows(predicate)
        except FailureError:
            return []
        return list({str(row[column]): row[column] for row in rows if column in row}.values())

    def _works(self, predicate: str, rule: SourceSpan, suggestion: Suggestion) -> bool:
        span, change = suggestion.span, suggestion.change
        text = self._program.text
        if not change and text[span.start : span.stop] != "~":
            span = _with_comma(text, span)
        new_text = text[: span.start] + change + text[span.stop :]
        shift = len(new_text) - len(text)
        start = rule.start + (shift if span.start < rule.start else 0)
        stop = rule.stop + (shift if span.start < rule.stop else 0)
        rule_text = new_text[start:stop].replace(predicate, _TEST_PREDICATE, 1)
        try:
            program = replace(self._program, text=new_text)
            rows = self._relations.answer(program, f"{rule_text};", self._limits)
        except (ProgramError, FailureError):
            return False
        values = self._values.items()
        row = next((row for row in rows if all(row.get(c) == value for c, value in values)), {})
        return any(value is not None for value in row.values())

    def _span(self, start: int, stop: int) -> SourceSpan:
        text = self._program.text
        return SourceSpan(start, stop, text.count("\n", 0, start) + 1, text[start:stop].strip())


def _change(span: SourceSpan, new: str, reason: str) -> Suggestion:
    return Suggestion(f"Change `{span.text}` to `{new}` in line {span.line}", reason, span, new)


def _removal(span: SourceSpan, reason: str) -> Suggestion:
    return Suggestion(f"Remove `{span.text}` in line {span.line}", reason, span, "")


def _literals(term: Term) -> list[Term]:
    """Return a literal, or those that an ``if`` or ``Coalesce`` may give."""
    if term.kind == "literal":
        return [term]
    if term.kind == "coalesce":
        return [t for part in term.parts for t in _literals(part)]
    if term.kind == "if":
        return [t for part in (*term.parts[1::2], term.parts[-1]) for t in _literals(part)]
    return []


def _examples(term: Term, matches: Sequence[Way]) -> list[Value]:
    values = [value_of(match, term.column) for match in matches]
    distinct: dict[str, Value] = {repr(v): v for v in values if isinstance(v, str | int | float)}
    return list(distinct.values())[:_MOST_VALUES]


def _unlikeness(old: Value, new: Value) -> float | None:
    """Return how far a value is from another, 0 if only case or type differs; None if far."""
    old_text, new_text = str(old).lower(), str(new).lower()
    if old_text == new_text:
        return 0.0
    if isinstance(old, str) and isinstance(new, str):
        size = distance(old_text, new_text)
        return 1.0 * size if size <= min(len(old_text), len(new_text), 9) // 3 else None
    if isinstance(old, int) and isinstance(new, int):
        return 1.0 if abs(old - new) <= 1 else None
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


def _arguments(text: str, call: SourceSpan) -> Iterator[tuple[int, int]]:
    start = text.find("(", call.start, call.stop) + 1
    depth, begin, is_quoted = 0, start, False
    for offset in range(start, call.stop):
        character = text[offset]
        if character == '"':
            is_quoted = not is_quoted
        elif is_quoted:
            continue
        elif character in "([{":
            depth += 1
        elif (character == ")" and not depth) or (character == "," and not depth):
            if text[begin:offset].strip():
                yield begin, offset
            begin = offset + 1
            if character == ")":
                return
        elif character in ")]}":
            depth -= 1


def _with_comma(text: str, span: SourceSpan) -> SourceSpan:
    stop = span.stop
    while stop < len(text) and text[stop].isspace():
        stop += 1
    if text[stop : stop + 1] == ",":
        return replace(span, stop=stop + 1)
    start = span.start
    while start and text[start - 1].isspace():
        start -= 1
    return replace(span, start=start - 1) if text[start - 1 : start] == "," else span
