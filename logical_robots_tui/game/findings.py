"""Findings about a run: about rules, notices, memories, texts and movement."""

from __future__ import annotations

import asyncio
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as attribute
from itertools import zip_longest
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from logical_robots_tui.explain.diagnosis.sites import Checkup, ProbeTally
from logical_robots_tui.explain.diagnosis.telling import Finding, Severity, rule_findings, shorten
from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.game.history.marks import last_rounds
from logical_robots_tui.language.diagnostics import closest
from logical_robots_tui.schema import NO_LABEL, OBJECTS
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.game.history.history import TickHistory
    from logical_robots_tui.mind.decision import NoticeKind
    from logical_robots_tui.world import Level, RobotState


_LONG = 150
"""Ticks for which a robot must be blocked or stand still to be reported."""

_TICKS_AT_ONCE = 200  # ticks before yielding to others
_MOST_TEXTS = 10_000
_MOST_STRETCHES = 4  # of each kind, because in a crowd many robots do the same


@dataclass(frozen=True, slots=True)
class Loss:
    robot: str
    field: str
    tick: int


@dataclass(frozen=True, slots=True)
class Stretch:
    """Ticks in which a robot made no progress; `period` is in ticks per round, or 0.

    `route` says in words where an unfinished robot came from and is.
    """

    kind: Literal["blocked", "still", "circle", "unfinished"]
    robot: str
    first: int
    last: int
    period: int = 0
    route: str = ""


@dataclass(slots=True)
class Observations:
    """What was observed in a run.

    Attributes:
        notices: By kind and robot, the first tick of a notice, their number, and the message.
        fields: The fields that memories had, each with its first tick.
        since: By robot and field, a text that is remembered, with the tick of its last change.
        is_on_way: Whether a robot was still on its way at the end, or may be where it should be.
    """

    first: int
    last: int
    won_at: int | None = None
    notices: dict[tuple[NoticeKind, str], tuple[int, int, str]] = attribute(default_factory=dict)
    fields: dict[str, int] = attribute(default_factory=dict)
    since: dict[tuple[str, str], tuple[int, str]] = attribute(default_factory=dict)
    texts: set[str] = attribute(default_factory=set)
    losses: dict[tuple[str, str], Loss] = attribute(default_factory=dict)
    stretches: list[Stretch] = attribute(default_factory=list)
    is_on_way: bool = False

    @property
    def is_over(self) -> bool:
        """Whether the robots did not win, and none of them is still on its way."""
        return self.won_at is None and not self.is_on_way

    def first_notice(self, kind: NoticeKind) -> tuple[int, str]:
        return min((entry[0], robot) for (k, robot), entry in self.notices.items() if k == kind)

    def first_losses(self) -> list[Loss]:
        first: dict[str, Loss] = {}
        for loss in sorted(self.losses.values(), key=lambda loss: (loss.tick, loss.robot)):
            first.setdefault(loss.field, loss)
        return list(first.values())


async def observe(history: TickHistory, first: int, last: int) -> Observations:
    run = Observations(first, last)
    paths: dict[str, list[RobotState]] = {}
    level = history.level_at(last)
    run.is_on_way = bool(level.scores)  # to stand still may earn points
    at_home = {name: area.name for area in level.areas for name in area.victory_robots}
    memories: dict[str, Value] = dict(history.recorded(first).previous.memories)
    for tick in range(first, last + 1):
        moment = history.moment(tick)
        run.won_at = moment.after.won_at
        for robot in moment.after.robots:
            paths.setdefault(robot.name, []).append(robot)
        for decision in moment.decisions:
            for notice in decision.notices:
                key = (notice.kind, decision.robot_name)
                begin, count, message = run.notices.get(key, (tick, 0, notice.message))
                run.notices[key] = (begin, count + 1, message)
        if moment.memories != memories:
            _remember(run, tick, memories, moment.memories)
            memories = dict(moment.memories)
        if not tick % _TICKS_AT_ONCE:
            await asyncio.sleep(0)
    visitors = {area.name: area.visitors for area in moment.after.areas}
    kinds: Counter[str] = Counter()
    for name, path in paths.items():
        is_home = name in visitors.get(at_home.get(name, ""), ())
        if len(path) <= last - first or is_home:
            continue
        stretches = [*_stretches(path, first)]
        is_stuck = any(s.kind != "unfinished" and s.last == last for s in stretches)
        run.is_on_way |= not (is_stuck or path[-1].dead)
        for stretch in stretches:
            kinds[stretch.kind] += 1
            if kinds[stretch.kind] <= _MOST_STRETCHES:
                run.stretches.append(stretch)
    return run


def _remember(run: Observations, tick: int, old_memories: Any, memories: Any) -> None:
    for robot, memory in memories.items():
        old_memory = old_memories.get(robot)
        if memory == old_memory:
            continue
        fields = memory if isinstance(memory, dict) else {}
        old_fields = old_memory if isinstance(old_memory, dict) else {}
        for name, value in fields.items():
            run.fields.setdefault(str(name), tick)
            if isinstance(value, str) and value != old_fields.get(name):
                run.since[robot, str(name)] = tick, value
        if len(run.texts) < _MOST_TEXTS:
            # Most fields stay the same, as the objects that they are.
            changed = [value for name, value in fields.items() if value is not old_fields.get(name)]
            run.texts.update(_texts(changed if fields else memory))
        for name in old_fields:
            if name not in fields and old_fields[name] is not None:
                run.losses.setdefault((robot, str(name)), Loss(robot, str(name), tick))


def _texts(value: Any) -> Iterator[str]:
    stack = [value]
    while stack:
        value = stack.pop()
        if isinstance(value, str):
            yield value
        elif isinstance(value, dict):
            stack += value.values()
        elif isinstance(value, list):
            stack += value


def _stretches(path: Sequence[RobotState], first: int) -> Iterator[Stretch]:
    """Yield the longest stretch of each kind in which a robot made no progress."""
    name = path[-1].name if path else ""
    kinds: tuple[tuple[Literal["blocked", "still"], Callable[[RobotState], bool]], ...] = (
        ("blocked", lambda robot: robot.blocked),
        ("still", lambda robot: not (robot.left_engine or robot.right_engine or robot.dead)),
    )
    for kind, holds in kinds:
        begin, end = _longest([holds(robot) for robot in path])
        if end - begin >= _LONG and (kind == "blocked" or end == len(path)):
            yield Stretch(kind, name, first + begin, first + end - 1)
            return
    if (rounds := last_rounds(path)) is not None:
        begin, period = rounds
        yield Stretch("circle", name, first + begin, first + len(path) - 1, period)
    elif len(path) > _LONG and (path[-2].x, path[-2].y) != (path[-1].x, path[-1].y):
        old, new = path[-_LONG], path[-1]
        route = f", from ({old.x:.0f}, {old.y:.0f}) to ({new.x:.0f}, {new.y:.0f})"
        last = first + len(path) - 1
        yield Stretch("unfinished", name, last - _LONG + 1, last, route=route)


def _longest(flags: Sequence[bool]) -> tuple[int, int]:
    """Return start and end of the longest stretch of True; the last of equally long ones."""
    best, begin = (0, 0), 0
    for index, flag in enumerate([*flags, False]):
        if not flag:
            if index - begin >= best[1] - best[0]:
                best = (begin, index)
            begin = index + 1
    return best


_RAY_WORDS = frozenset({*OBJECTS, NO_LABEL})
"""What a ray may report that is not a name."""

_MOST_PLACES = 6
_MOST_LEAVES = 3


CloseTallies: TypeAlias = Mapping[tuple[str, int], ProbeTally]
"""Tallies of single robots, by robot and the tick near which they were examined."""


def findings_of(
    tally: ProbeTally,
    observations: Observations,
    close_tallies: CloseTallies,
    level: Level,
    *,
    is_complete: bool = True,
) -> tuple[list[Finding], list[Finding]]:
    """Return the findings, most significant first, in two parts; the first needs no counts.

    `close_tallies` are by robot and first tick. Unless the counts are complete, they are of some
    ticks only.
    """
    settled = [
        *_notice_findings(observations, close_tallies),
        *_memory_findings(tally.checkup, observations, close_tallies),
        *_text_findings(tally.checkup, observations, level),
        *_definition_findings(tally.checkup, observations.first),
    ]
    causes, consequences = rule_findings(
        tally, is_over=observations.is_over and is_complete, is_complete=is_complete
    )
    counted = [
        *causes,
        *_movement_findings(observations, close_tallies),
        *_unchanged_findings(tally.checkup, observations),
        *consequences,
    ]
    warnings = [finding for finding in settled if finding.severity == "warning"]
    notes = [finding for finding in settled if finding.severity == "note"]
    return warnings, sorted([*notes, *counted], key=lambda finding: finding.severity == "note")


def _notice_findings(observations: Observations, close_tallies: CloseTallies) -> Iterator[Finding]:
    for notice in dict.fromkeys(kind for kind, _ in observations.notices):
        tick, robot = observations.first_notice(notice)
        tally, message = close_tallies[robot, tick], observations.notices[notice, robot][2]
        count = sum(entry[1] for (kind, _), entry in observations.notices.items() if kind == notice)
        first = f"{message} First at tick {tick}, {count} times in total."
        if notice == "several rows":
            yield _several_rows_finding(tally, robot, tick, first)
        elif notice == "bad engine":
            yield _null_engine_finding(tally, robot, tick, first)
        elif notice == "no row":
            rules = {n: r.span for n, r in enumerate(tally.checkup.rules) if r.predicate == "Robot"}
            stops = [stop for rule in rules if (stop := tally.stopping_site(rule)) is not None]
            places = [tally.checkup.sites[stop].span for stop in stops]
            span, more_spans = _split([*places, *rules.values()])
            hint = "No rule of Robot holds here. Ask why to see where each one fails."
            yield Finding("no row", "warning", span, tick, first, hint, more_spans, robot)
        else:
            hint = "Go to that tick and ask why."
            yield Finding("notice", "warning", None, tick, first, hint, (), robot)


def _several_rows_finding(tally: ProbeTally, robot: str, tick: int, first: str) -> Finding:
    checkup = tally.checkup
    rows = tally.robot_rows.get((robot, tick), {})
    spans = [checkup.rules[number].span for number in sorted(rows)]
    if len(rows) > 1:
        hint = "Several rules hold at once; make them mutually exclusive."
        bodies = [body for n in sorted(rows) if (body := checkup.rules[n].body) is not None]
        lines = " and ".join(str(span.line) for span in spans)
        message = f"{first} They come from the rules in lines {lines}."
        more_spans = (*bodies, *spans[:-1])
        return Finding("several rows", "warning", spans[-1], tick, message, hint, more_spans, robot)
    places = [place for number in rows for place in _multipliers(tally, number, set())]
    span, more_spans = _split([*places, *spans])
    hint = "A part of this rule has several matches. Look for an extra row of a predicate."
    return Finding("several rows", "warning", span, tick, first, hint, more_spans, robot)


def _multipliers(tally: ProbeTally, rule: int, visited: set[int]) -> list[SourceSpan]:
    checkup = tally.checkup
    visited.add(rule)
    for number, site in enumerate(checkup.sites):
        count = tally.sites[number]
        if site.rule != rule or site.kind != "part" or count.passed_cases <= max(1, count.cases):
            continue
        candidates = [n for n, r in enumerate(checkup.rules) if r.predicate == site.predicate]
        firing = [
            n for n in candidates if tally.rules[n].first_row is not None and n not in visited
        ]
        facts = [n for n in firing if checkup.rules[n].is_fact]
        deeper = [] if facts or len(firing) != 1 else _multipliers(tally, firing[0], visited)
        times = Counter(checkup.rules[n].key for n in facts)
        duplicates = [n for n in facts if times[checkup.rules[n].key] > 1]
        spans = [checkup.rules[n].span for n in (duplicates if facts else firing)]
        return [*deeper, *reversed(spans), site.span]
    return []


_AGGREGATE = re.compile(r"[A-Z]\w*\s*\{")


def _null_engine_finding(tally: ProbeTally, robot: str, tick: int, first: str) -> Finding:
    leaves, deciding = _leaves(tally, robot), _deciding_rules(tally, robot)
    nulls = [
        place
        for number, site in enumerate(tally.checkup.sites)
        if site.kind == "value" and tally.sites[number].first_true is not None
        if tally.checkup.rules[site.rule].predicate != "Robot" or site.rule in deciding
        for place in (site.span, *site.places)
    ]
    span, more_spans = _split([*nulls, *(span for leaf in leaves for span in leaf)])
    quoted = f" `{shorten(span.text)}` was null." if nulls and span else ""
    hint = "Use Coalesce or `if` to handle a missing value."
    aggregate = next((place for place in nulls if _AGGREGATE.search(place.text)), None)
    if aggregate is not None:
        subject = f"The aggregation in line {aggregate.line}"
        hint = f"{subject} had no rows; Coalesce replaces null."
    return Finding("bad engine", "warning", span, tick, f"{first}{quoted}", hint, more_spans, robot)


def _split(places: Iterable[SourceSpan]) -> tuple[SourceSpan | None, tuple[SourceSpan, ...]]:
    """Return the first place and the others, one for each line."""
    by_line: dict[int, SourceSpan] = {}
    for place in places:
        by_line.setdefault(place.line, place)
    first, *more_spans = by_line.values() or (None,)
    return first, tuple(more_spans[:_MOST_PLACES])


def _memory_findings(
    checkup: Checkup,
    observations: Observations,
    close_tallies: CloseTallies,
) -> Iterator[Finding]:
    reads = {field.name: field for field in reversed(checkup.reads)}
    writes = {field.name: field for field in reversed(checkup.writes)}
    for name, field in reads.items():
        if name not in observations.fields and (name not in writes or checkup.writes_all):
            close = closest(name, {*writes, *observations.fields})
            hint = f"Did you mean {close}?" if close else "It is always null."
            message = f"memory.{name} is read, but no memory ever had a field {name}."
            memory_spans = [rule.memory for rule in checkup.rules if rule.memory is not None]
            more_spans = (writes[close].span,) if close in writes else tuple(memory_spans)
            first = observations.first
            yield Finding(
                "memory never written", "warning", field.span, first, message, hint, more_spans
            )
    for name, field in writes.items():
        if name not in reads and not checkup.reads_all:
            close = closest(name, reads)
            hint = f"{close} is read; did you mean that?" if close else "It can be removed."
            message = f"The field {name} of memory is written and never read."
            first = observations.first
            yield Finding("memory never read", "note", field.span, first, message, hint)
    for loss in observations.first_losses():
        name, tick, robot = loss.field, loss.tick, loss.robot
        if name not in reads:
            continue
        tally = close_tallies[robot, tick]
        rows = sorted(tally.robot_rows.get((robot, tick), ()), reverse=True)
        places = [checkup.rules[n].memory or checkup.rules[n].span for n in rows]
        span, more_spans = _split([*places, reads[name].span])
        message = f"{robot} forgot memory.{name} at tick {tick}: the new memory has no such field."
        hint = f"It is read in line {reads[name].span.line}; every new memory must include it."
        yield Finding("memory lost", "warning", span, tick, message, hint, more_spans, robot)


def _text_findings(checkup: Checkup, observations: Observations, level: Level) -> Iterator[Finding]:
    names = {robot.name for robot in level.robots} | {beacon.name for beacon in level.beacons}
    names |= {area.name for area in level.areas if area.impenetrable}  # rays see their names
    valid_texts = {*names, *_RAY_WORDS, *observations.texts}
    for field in checkup.texts:
        if field.name in valid_texts:
            continue
        close = closest(field.name, names | _RAY_WORDS, 0.6) or next(
            (n for n in names if n.lower() == field.name.lower()), ""
        )
        hint = "Robots, beacons and solid areas have other names here."
        hint = f'Did you mean "{close}"?' if close else hint
        message = f'Nothing in this level is called "{field.name}".'
        yield Finding("unknown string", "warning", field.span, observations.first, message, hint)


def _definition_findings(checkup: Checkup, first: int) -> Iterator[Finding]:
    for copy, original in checkup.duplicate_copies:
        source = shorten(copy.span.text.partition(":=")[2].strip())
        message = f"{copy.name} and {original.name} are the same: both are `{source}`."
        hint = "Give one of them another predicate, or remove it."
        yield Finding("same copy", "note", copy.span, first, message, hint, (original.span,))
    for predicate in checkup.unused:
        message = f"Nothing uses {predicate.name}."
        yield Finding("unused", "note", predicate.span, first, message, "Use it, or remove it.")


def _movement_findings(
    observations: Observations, close_tallies: CloseTallies
) -> Iterator[Finding]:
    reported: set[tuple[str, SourceSpan | None]] = set()
    for stretch in sorted(observations.stretches, key=lambda s: [*_MOVEMENTS].index(s.kind)):
        if observations.won_at is not None and stretch.kind != "blocked":
            continue
        leaves = _leaves(close_tallies[stretch.robot, stretch.first], stretch.robot)
        span, more_spans = _split(place for row in zip_longest(*leaves) for place in row if place)
        if (stretch.kind, span) in reported:
            continue
        reported.add((stretch.kind, span))
        # A robot that stands still may be where it should be.
        is_fixed = stretch.kind == "still" and not observations.is_over
        is_doubtful = observations.won_at is None and stretch.kind != "unfinished" and not is_fixed
        severity: Severity = "warning" if is_doubtful else "note"
        verb, hint = _MOVEMENTS[stretch.kind]
        verb += f" {stretch.period} ticks" if stretch.kind == "circle" else ""
        desire_text = f", mostly with `{shorten(span.text)}`" if span is not None else ""
        ticks = f"from tick {stretch.first} to {stretch.last}{stretch.route}"
        message, begin = f"{stretch.robot} {verb} {ticks}{desire_text}.", stretch.first
        yield Finding(stretch.kind, severity, span, begin, message, hint, more_spans, stretch.robot)


def _unchanged_findings(checkup: Checkup, observations: Observations) -> Iterator[Finding]:
    """Yield the states that robots without progress remain in, such as a phase of a plan."""
    stuck = {s.robot for s in observations.stretches if s.last == observations.last}
    states: dict[str, tuple[int, str, str]] = {}
    for (robot, name), (tick, value) in sorted(observations.since.items(), key=itemgetter(1)):
        # A state is a text that the program both sets and asks for.
        is_state = checkup.program.text.count(spell(value)) > 1
        if is_state and robot in stuck and observations.last - tick >= _LONG:
            states.setdefault(name, (tick, value, robot))
    for field in checkup.writes if observations.won_at is None else ():
        if field.name in states:
            tick, value, robot = states[field.name]
            quoted = f"{robot}'s memory.{field.name} stayed {spell(shorten(value))}"
            message = f"{quoted} from tick {tick} to {observations.last}."
            hint = "Check the condition that should change it: can it ever hold?"
            span, more_spans = _split([*field.places, field.span])
            yield Finding("unchanged", "note", span, tick, message, hint, more_spans, robot)


_MOVEMENTS = {
    "circle": (
        "goes round in a circle of",
        "It repeats the same movement. Which rule should stop it?",
    ),
    "blocked": (
        "was blocked",
        "It pushes against a wall. Which rule should turn it away?",
    ),
    "still": ("stood still", "No rule makes it move. Which rule should?"),
    "unfinished": ("was still on its way", "Check whether it should move like this here."),
}
"""What is said of each kind of stretch, the most significant first, and the hint."""


def _leaves(tally: ProbeTally, robot: str) -> list[list[SourceSpan]]:
    """Return where a robot's desire came from, the most frequent and outermost first.

    For each choice these are its place and the sources of its values.
    """
    rules, deciding = tally.checkup.rules, _deciding_rules(tally, robot)
    owners = {name for n in deciding for name in rules[n].sources}
    ranking = []
    for number, site in enumerate(tally.checkup.sites):
        if site.kind != "leaf" or site.owner not in owners:
            continue
        ticks = tally.sites[number].ticks
        if rules[site.rule].predicate == "Robot":
            ticks = ticks & deciding.get(site.rule, set())
        if ticks:
            ranking.append((rules[site.rule].is_function, -len(ticks), number))
    sites = {tally.checkup.sites[n].span: tally.checkup.sites[n] for *_, n in sorted(ranking)}
    return [[site.span, *site.places] for site in [*sites.values()][:_MOST_LEAVES]]


def _deciding_rules(tally: ProbeTally, robot: str) -> dict[int, set[int]]:
    """Return the rules of `Robot` whose row counted, because it was the last, with the ticks."""
    rules: dict[int, set[int]] = {}
    for (name, tick), rows in tally.robot_rows.items():
        if name == robot:
            rules.setdefault(max(rows), set()).add(tick)
    return rules
