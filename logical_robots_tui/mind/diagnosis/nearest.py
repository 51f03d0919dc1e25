"""The nearest miss: single changes that would have given a rule a row."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from logical_robots_tui.mind.diagnosis.counting import Tally
from logical_robots_tui.mind.diagnosis.sites import TESTS, Span, check_up
from logical_robots_tui.mind.diagnostics import ProgramError, QueryError
from logical_robots_tui.mind.mind import Mind
from logical_robots_tui.mind.similar_names import closest, distance

if TYPE_CHECKING:
    import threading
    from collections.abc import Iterator, Mapping, Sequence

    from logical_robots_tui.mind.diagnosis.counting import Count
    from logical_robots_tui.mind.diagnosis.sites import Checkup, RuleSite, Site
    from logical_robots_tui.mind.program import Program, Question
    from logical_robots_tui.mind.table import Table
    from logical_robots_tui.values import SensorRow, Value

__all__ = ["Suggestion", "nearest_misses"]

MOST = 5
"""The most suggestions."""

_MOST_TRIED = 16
_ASKED = "NearestMiss"
_ARGUMENT = re.compile(r"\s*(?P<name>[a-z_]\w*)\s*:(?P<value>.*)", re.DOTALL)
_TRUTHS = {"true": True, "false": False}


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A change after which a rule would have had a row; it was tested.

    Attributes:
        text: What failed, and by how much; one plain sentence.
        span: The place to change.
        change: The new text; "" to remove it.
    """

    text: str
    span: Span
    change: str


def nearest_misses(
    program: Program,
    predicate: str,
    number: int,
    robot: str,
    rows: Sequence[SensorRow],
    memories: Mapping[str, Value],
    *,
    given: Mapping[str, Value] | None = None,
    memory: Literal["own", "seen", "all"] = "own",
    sensor: Literal["own", "all"] = "own",
    stop: threading.Event | None = None,
) -> tuple[Suggestion, ...]:
    """Return the single changes that would have given a rule a row, the smallest first. Blocks.

    Args:
        program: The program.
        predicate: One of its own predicates.
        number: The index of the rule, from 0.
        robot: The robot in whose mind.
        rows: The sensors of the moment, as `Mind.think` takes them.
        memories: The memories of the moment.
        given: Values of columns that a row must have, as `Mind.why` takes them.
        memory: Whose memories a robot sees, as `Mind` takes it.
        sensor: Whose sensors it sees, as `Mind` takes it.
        stop: Set it from another thread to cancel.

    Returns:
        () if the rule has a row, or if no single change is enough.

    Raises:
        QueryError: The program is too complex.
        Stopped: `stop` was set.
    """
    checkup = check_up(program, stop=stop)
    moment = _Moment(robot, rows, memories, stop)
    mind = Mind(checkup.program, memory=memory, sensor=sensor)
    try:
        tally = Tally(checkup)
        names = {probe.name: at for at, probe in enumerate(checkup.probes)}
        for name, found in mind.each(list(names), rows, memories, viewers=(robot,), stop=stop):
            if found is not None:
                tally.add(0, names[name], found)
        return _Nearest(program, checkup, tally, mind, moment, given or {}).of(predicate, number)
    finally:
        mind.close()


@dataclass(frozen=True)
class _Moment:
    """A moment for one robot."""

    robot: str
    rows: Sequence[SensorRow]
    memories: Mapping[str, Value]
    stop: threading.Event | None


class _Nearest:
    """Searches for changes and tests them."""

    def __init__(
        self,
        program: Program,
        checkup: Checkup,
        tally: Tally,
        mind: Mind,
        moment: _Moment,
        given: Mapping[str, Value],
    ) -> None:
        self._program, self._checkup, self._tally = program, checkup, tally
        self._mind, self._moment, self._given = mind, moment, given

    def of(self, predicate: str, number: int) -> tuple[Suggestion, ...]:
        rules = [n for n, rule in enumerate(self._checkup.rules) if rule.predicate == predicate]
        if not 0 <= number < len(rules):
            return ()
        rule = self._checkup.rules[rules[number]]
        candidates = sorted(self._candidates(rules[number]), key=lambda each: each[0])
        found: list[Suggestion] = []
        tried: set[tuple[int, str]] = set()
        for _, suggestion in candidates:
            key = (suggestion.span.start, suggestion.change)
            if key in tried:
                continue
            tried.add(key)
            if self._works(rule, suggestion):
                found.append(suggestion)
            if len(found) == MOST or len(tried) == _MOST_TRIED:
                break
        return tuple(found)

    # -- candidates ----------------------------------------------------------------------------

    def _candidates(self, rule: int) -> Iterator[tuple[float, Suggestion]]:
        """Yield changes with their size."""
        stop = self._stopped(rule)
        if stop is None:
            return
        yield from self._fields(stop.span)
        for number, site in enumerate(self._checkup.sites):
            count = self._tally.sites[number]
            is_within = stop.span.start <= site.span.start and site.span.stop <= stop.span.stop
            if is_within and count.reached is not None and count.true is None:
                yield from self._of_site(site, count)
        if stop.kind == "part" and stop.predicate:
            yield from self._of_call(stop)
            beginning = Span(stop.span.start, stop.span.start, stop.span.line, stop.span.text)
            said = f"`{stop.span.text}` has no rows; with ~ before it the rule holds."
            yield 6.0, Suggestion(said, beginning, "~")
            yield 50.0, Suggestion(f"Without `{stop.span.text}` the rule holds.", stop.span, "")

    def _stopped(self, rule: int) -> Site | None:
        """Return the first part of the rule, or of a function it calls, that failed."""
        found = asked = None
        for number, site in enumerate(self._checkup.sites):
            count = self._tally.sites[number]
            if site.is_step and count.true is None:
                if site.rule == rule and count.reached is not None:
                    found = site
                elif self._checkup.rules[site.rule].is_function and count.reached is not None:
                    asked = site
        return found or (asked if self._tally.rules[rule].gave is None else None)

    def _of_site(self, site: Site, count: Count) -> Iterator[tuple[float, Suggestion]]:
        if site.kind == "denial":
            inner = Span(site.span.start, site.span.start + 1, site.span.line, site.span.text[:1])
            said = f"`{site.span.text[1:].strip()}` has rows; without ~ the rule holds."
            yield 5.0, Suggestion(said, inner, "")
        if site.literal is not None:
            yield from self._of_literal(site, count)
        elif site.operator in ("<", "<=", ">", ">="):
            yield from self._of_threshold(site, count)
        elif count.left and count.right:
            yield from self._of_pair(site, count)
        if site.kind in TESTS and site.kind != "denial":
            left = f"Without `{site.span.text}` the rule holds."
            yield 50.0, Suggestion(left, site.span, "true")

    def _of_literal(self, site: Site, count: Count) -> Iterator[tuple[float, Suggestion]]:
        assert site.literal is not None
        written = json.dumps(site.literal, ensure_ascii=False)
        at = self._program.text.find(written, site.span.start, site.span.stop)
        if at < 0:
            return
        span = Span(at, at + len(written), self._line(at), written)
        for value in count.left:
            new = json.dumps(value, ensure_ascii=False)
            size = _unlikeness(site.literal, value)
            said = f"{site.other} is {new}, not {written}."
            yield size, Suggestion(said, span, new)
            if _TRUTHS.get(site.literal.lower()) is not None and value in (0, 1):
                yield 0.0, Suggestion(said, span, site.literal.lower())

    def _of_threshold(self, site: Site, count: Count) -> Iterator[tuple[float, Suggestion]]:
        is_less = site.operator in ("<", "<=")
        lacks = count.least if is_less else count.greatest
        at = self._program.text.find(site.operator, site.span.start + 1, site.span.stop)
        if lacks is None or at < 0:
            return
        start = at + len(site.operator)
        right = self._program.text[start : site.span.stop]
        limit = right.strip().rstrip(")")
        start += right.index(limit)
        span = Span(start, start + len(limit), self._line(start), limit)
        sign, what = ("+", "too much") if is_less else ("-", "too little")
        more = abs(lacks) * 1.001 + 0.001
        try:
            number = float(limit)
            new = f"{number + more if is_less else number - more:.6g}"
            size = abs(lacks) / (abs(number) or 1)
        except ValueError:
            new, size = f"({limit}) {sign} {more:.6g}", 1.0
        how = f"{abs(lacks):.4g} {what}" if lacks else "exactly the limit"
        said = f"`{site.span.text}` fails: {site.other} is {how}."
        yield min(size, 10.0), Suggestion(said, span, new)

    def _of_pair(self, site: Site, count: Count) -> Iterator[tuple[float, Suggestion]]:
        left, sign, right = self._program.text[site.span.start : site.span.stop].partition("==")
        if not sign:
            return
        start = site.span.start + len(left) + len(sign)
        start += len(right) - len(right.lstrip())
        span = Span(start, site.span.stop, self._line(start), right.strip())
        for one in count.left:
            for other in count.right:
                size = _unlikeness(other, one)
                new = json.dumps(one, ensure_ascii=False)
                was = json.dumps(other, ensure_ascii=False)
                said = f"{site.other} is {new}, and {right.strip()} is {was}."
                yield size + 1, Suggestion(said, span, new)

    def _fields(self, within: Span) -> Iterator[tuple[float, Suggestion]]:
        """Yield memory fields that are read but missing, with existing ones."""
        memory = self._moment.memories.get(self._moment.robot)
        there = list(map(str, memory)) if isinstance(memory, dict) else []
        for field in self._checkup.reads:
            if field.name in there or not within.start <= field.span.start < within.stop:
                continue
            at = self._program.text.rfind(field.name, field.span.start, field.span.stop)
            span = Span(at, at + len(field.name), self._line(at), field.name)
            close = closest(field.name, there, 0.6)
            for other in there:
                said = f"memory has no field {field.name}; it has {other}."
                yield (0.5 if other == close else 3.0), Suggestion(said, span, other)

    def _of_call(self, site: Site) -> Iterator[tuple[float, Suggestion]]:
        """Yield changes of a call without rows: without one column, or with a known text."""
        for start, stop in _arguments(self._program.text, site.span):
            argument = self._program.text[start:stop]
            named = _ARGUMENT.fullmatch(argument)
            if named is None:
                continue
            name, value = named["name"], named["value"].strip()
            span = Span(start, stop, self._line(start), argument.strip())
            there = self._known(site.predicate, name)
            if value.startswith('"') and value.endswith('"'):
                for other in there:
                    new = json.dumps(other, ensure_ascii=False)
                    said = f"{site.predicate} has {name} {new}, not {value}."
                    size = _unlikeness(value[1:-1], other)
                    yield size, Suggestion(said, span, f"{name}: {new}")
            listed = ", ".join(json.dumps(each, ensure_ascii=False) for each in there[:3])
            has = f" It has {listed}." if listed else ""
            said = f"`{site.span.text}` fails in the column {name} alone.{has}"
            yield 4.0, Suggestion(said, span, "")

    def _known(self, predicate: str, column: str) -> list[Value]:
        """Return the values in a column of a predicate, in the robot's mind."""
        try:
            question = self._program.question(
                f"{predicate}({column}: value)", stop=self._moment.stop
            )
            table = self._answer(question)
        except (ProgramError, QueryError):
            return []
        return list({str(row[0]): row[0] for row in table.rows if row}.values())

    def _answer(self, question: Question) -> Table:
        there = self._moment
        return self._mind.ask(
            question, there.rows, there.memories, viewers=(there.robot,), stop=there.stop
        )

    # -- testing a change ---------------------------------------------------------------------

    def _works(self, rule: RuleSite, suggestion: Suggestion) -> bool:
        """Return whether the rule has a row after a change."""
        span, change = suggestion.span, suggestion.change
        text = self._program.text
        if not change and text[span.start : span.stop] != "~":
            span = _with_comma(text, span)
        changed = text[: span.start] + change + text[span.stop :]
        moved = len(changed) - len(text)
        start = rule.span.start + (moved if span.start < rule.span.start else 0)
        stop = rule.span.stop + (moved if span.start < rule.span.stop else 0)
        written = changed[start:stop].replace(rule.predicate, _ASKED, 1)
        program = replace(self._program, text=changed)
        try:
            question = program.question(f"{written};", stop=self._moment.stop)
            table = self._answer(question)
        except (ProgramError, QueryError):
            return False
        viewers = table.viewers or (self._moment.robot,) * len(table.rows)
        for viewer, row in zip(viewers, table.rows, strict=True):
            told = dict(zip(table.columns, row, strict=True))
            wanted = {**self._given}
            if "robot_name" in told:
                wanted.setdefault("robot_name", self._moment.robot)
            if viewer == self._moment.robot and all(
                told.get(column) == value for column, value in wanted.items()
            ):
                return any(value is not None for value in row)
        return False

    def _line(self, at: int) -> int:
        return self._program.text.count("\n", 0, at) + 1


def _unlikeness(text: Value, other: Value) -> float:
    """Return the dissimilarity of two values: 0 if only case or type differs."""
    one, two = str(text), str(other)
    if one.lower() == two.lower():
        return 0.0
    return distance(one.lower(), two.lower()) / max(1, min(len(one), len(two))) * 4


def _arguments(text: str, call: Span) -> Iterator[tuple[int, int]]:
    """Return begin and end of a call's arguments."""
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
    """Return an argument and the comma after or before it."""
    stop = span.stop
    while stop < len(text) and text[stop].isspace():
        stop += 1
    if text[stop : stop + 1] == ",":
        return replace(span, stop=stop + 1)
    start = span.start
    while start and text[start - 1].isspace():
        start -= 1
    return replace(span, start=start - 1) if text[start - 1 : start] == "," else span
