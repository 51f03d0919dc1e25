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
from typing import TYPE_CHECKING, Any, Literal, Protocol

from logical_robots_tui.explain.diagnosis.sites import Checkup, ProbeTally
from logical_robots_tui.explain.diagnosis.telling import Finding, Severity, rule_findings, shorten
from logical_robots_tui.explain.why.probing import SourceSpan
from logical_robots_tui.game.history.marks import last_rounds
from logical_robots_tui.language.diagnostics import closest
from logical_robots_tui.schema import NO_LABEL, OBJECTS
from logical_robots_tui.values import Value, spell

if TYPE_CHECKING:
    from logical_robots_tui.game.advancing import RecordedTick
    from logical_robots_tui.game.history.packing import TickState
    from logical_robots_tui.mind.decision import NoticeKind
    from logical_robots_tui.world import Level, RobotState


_LONG = 150
"""Ticks for which a robot must be blocked or stand still to be reported."""

_AT_ONCE = 200  # ticks before yielding to others
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

    `way` says in words where an unfinished robot came from and is.
    """

    kind: Literal["blocked", "still", "circle", "unfinished"]
    robot: str
    first: int
    last: int
    period: int = 0
    way: str = ""


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
        return min((each[0], robot) for (of, robot), each in self.notices.items() if of == kind)

    def first_losses(self) -> list[Loss]:
        first: dict[str, Loss] = {}
        for loss in sorted(self.losses.values(), key=lambda each: (each.tick, each.robot)):
            first.setdefault(loss.field, loss)
        return list(first.values())


class Stored(Protocol):
    """Ticks that were computed, of a game or a run."""

    @property
    def first(self) -> int: ...
    @property
    def last(self) -> int: ...
    @property
    def turns(self) -> int: ...

    def replay(self, tick: int, /) -> tuple[TickState, RecordedTick]: ...
    def level_at(self, tick: int, /) -> Level: ...
    def is_reliable_up_to(self, tick: int, /) -> bool: ...


async def observe(history: Stored, first: int, last: int) -> Observations:
    found = Observations(first, last)
    paths: dict[str, list[RobotState]] = {}
    level = history.level_at(last)
    found.is_on_way = bool(level.scores)  # to stand still may earn points
    at_home = {name: area.name for area in level.areas for name in area.victory_robots}
    before: dict[str, Value] = dict(history.replay(first)[0].memories)
    for tick in range(first, last + 1):
        moment = history.replay(tick)[1].moment
        found.won_at = moment.after.won_at
        for robot in moment.after.robots:
            paths.setdefault(robot.name, []).append(robot)
        for decision in moment.decisions:
            for notice in decision.notices:
                key = (notice.kind, decision.robot_name)
                begin, count, message = found.notices.get(key, (tick, 0, notice.message))
                found.notices[key] = (begin, count + 1, message)
        if moment.memories != before:
            _remember(found, tick, before, moment.memories)
            before = dict(moment.memories)
        if not tick % _AT_ONCE:
            await asyncio.sleep(0)
    visitors = {area.name: area.visitors for area in moment.after.areas}
    kinds: Counter[str] = Counter()
    for name, path in paths.items():
        is_home = name in visitors.get(at_home.get(name, ""), ())
        if len(path) <= last - first or is_home:
            continue
        stretches = [*_stretches(path, first)]
        is_stuck = any(each.kind != "unfinished" and each.last == last for each in stretches)
        found.is_on_way |= not (is_stuck or path[-1].dead)
        for stretch in stretches:
            kinds[stretch.kind] += 1
            if kinds[stretch.kind] <= _MOST_STRETCHES:
                found.stretches.append(stretch)
    return found


def _remember(found: Observations, tick: int, before: Any, after: Any) -> None:
    for robot, memory in after.items():
        old = before.get(robot)
        if memory == old:
            continue
        fields = memory if isinstance(memory, dict) else {}
        former = old if isinstance(old, dict) else {}
        for name, value in fields.items():
            found.fields.setdefault(str(name), tick)
            if isinstance(value, str) and value != former.get(name):
                found.since[robot, str(name)] = tick, value
        if len(found.texts) < _MOST_TEXTS:
            # Most fields stay the same, as the objects that they are.
            changed = [each for name, each in fields.items() if each is not former.get(name)]
            found.texts.update(_texts(changed if fields else memory))
        for name in former:
            if name not in fields and former[name] is not None:
                found.losses.setdefault((robot, str(name)), Loss(robot, str(name), tick))


def _texts(value: Any) -> Iterator[str]:
    left = [value]
    while left:
        value = left.pop()
        if isinstance(value, str):
            yield value
        elif isinstance(value, dict):
            left += value.values()
        elif isinstance(value, list):
            left += value


def _stretches(path: Sequence[RobotState], first: int) -> Iterator[Stretch]:
    """Yield the longest stretch of each kind in which a robot made no progress."""
    name = path[-1].name if path else ""
    kinds: tuple[tuple[Literal["blocked", "still"], Callable[[RobotState], bool]], ...] = (
        ("blocked", lambda robot: robot.blocked),
        ("still", lambda robot: not (robot.left_engine or robot.right_engine or robot.dead)),
    )
    for kind, is_so in kinds:
        begin, end = _longest([is_so(robot) for robot in path])
        if end - begin >= _LONG and (kind == "blocked" or end == len(path)):
            yield Stretch(kind, name, first + begin, first + end - 1)
            return
    if (found := last_rounds(path)) is not None:
        begin, period = found
        yield Stretch("circle", name, first + begin, first + len(path) - 1, period)
    elif len(path) > _LONG and (path[-2].x, path[-2].y) != (path[-1].x, path[-1].y):
        before, now = path[-_LONG], path[-1]
        way = f", from ({before.x:.0f}, {before.y:.0f}) to ({now.x:.0f}, {now.y:.0f})"
        last = first + len(path) - 1
        yield Stretch("unfinished", name, last - _LONG + 1, last, way=way)


def _longest(holds: Sequence[bool]) -> tuple[int, int]:
    """Return start and end of the longest stretch of True; the last of equally long ones."""
    best, begin = (0, 0), 0
    for at, each in enumerate([*holds, False]):
        if not each:
            if at - begin >= best[1] - best[0]:
                best = (begin, at)
            begin = at + 1
    return best


_SEEN = frozenset({*OBJECTS, NO_LABEL})
"""What a ray may report that is not a name."""

_MOST_PLACES = 6
_MOST_LEAVES = 3


def findings_of(
    tally: ProbeTally,
    observed: Observations,
    closer: Mapping[tuple[str, int], ProbeTally],
    level: Level,
    *,
    is_complete: bool = True,
) -> tuple[list[Finding], list[Finding]]:
    """Return the findings, most significant first, in two parts; the first needs no counts.

    `closer` has counts by robot and first tick. Unless the counts are complete, they are of
    some ticks only.
    """
    surely = [
        *_of_notices(observed, closer),
        *_of_memory(tally.checkup, observed, closer),
        *_of_texts(tally.checkup, observed, level),
        *_of_definitions(tally.checkup, observed.first),
    ]
    causes, consequences = rule_findings(
        tally, is_over=observed.is_over and is_complete, is_complete=is_complete
    )
    others = [
        *causes,
        *_of_movement(observed, closer),
        *_of_unchanged(tally.checkup, observed),
        *consequences,
    ]
    warnings = [each for each in surely if each.severity == "warning"]
    notes = [each for each in surely if each.severity == "note"]
    return warnings, sorted([*notes, *others], key=lambda each: each.severity == "note")


def _of_notices(
    observed: Observations, closer: Mapping[tuple[str, int], ProbeTally]
) -> Iterator[Finding]:
    for named in dict.fromkeys(kind for kind, _ in observed.notices):
        tick, robot = observed.first_notice(named)
        tally, message = closer[robot, tick], observed.notices[named, robot][2]
        often = sum(each[1] for (kind, _), each in observed.notices.items() if kind == named)
        first = f"{message} First at tick {tick}, {often} times in total."
        if named == "several rows":
            yield _of_several(tally, robot, tick, first)
        elif named == "bad engine":
            yield _of_null(tally, robot, tick, first)
        elif named == "no row":
            rules = {n: r.span for n, r in enumerate(tally.checkup.rules) if r.predicate == "Robot"}
            stops = [stop for rule in rules if (stop := tally.stopping_site(rule)) is not None]
            places = [tally.checkup.sites[stop].span for stop in stops]
            span, others = _split([*places, *rules.values()])
            hint = "No rule of Robot holds here. Ask why to see where each one fails."
            yield Finding("no row", "warning", span, tick, first, hint, others, robot)
        else:
            hint = "Go to that tick and ask why."
            yield Finding("notice", "warning", None, tick, first, hint, (), robot)


def _of_several(tally: ProbeTally, robot: str, tick: int, first: str) -> Finding:
    checkup = tally.checkup
    given = tally.robot_rows.get((robot, tick), {})
    gave = [checkup.rules[number].span for number in sorted(given)]
    if len(given) > 1:
        hint = "Several rules hold at once; make them mutually exclusive."
        bodies = [body for n in sorted(given) if (body := checkup.rules[n].body) is not None]
        lines = " and ".join(str(span.line) for span in gave)
        message = f"{first} They come from the rules in lines {lines}."
        others = (*bodies, *gave[:-1])
        return Finding("several rows", "warning", gave[-1], tick, message, hint, others, robot)
    places = [place for number in given for place in _multipliers(tally, number, set())]
    span, others = _split([*places, *gave])
    hint = "A part of this rule has several matches. Look for an extra row of a predicate."
    return Finding("several rows", "warning", span, tick, first, hint, others, robot)


def _multipliers(tally: ProbeTally, rule: int, seen: set[int]) -> list[SourceSpan]:
    checkup = tally.checkup
    seen.add(rule)
    for number, site in enumerate(checkup.sites):
        count = tally.sites[number]
        if site.rule != rule or site.kind != "part" or count.passed_cases <= max(1, count.cases):
            continue
        called = [n for n, r in enumerate(checkup.rules) if r.predicate == site.predicate]
        gave = [n for n in called if tally.rules[n].first_row is not None and n not in seen]
        facts = [n for n in gave if checkup.rules[n].is_fact]
        deeper = [] if facts or len(gave) != 1 else _multipliers(tally, gave[0], seen)
        times = Counter(checkup.rules[n].key for n in facts)
        alike = [n for n in facts if times[checkup.rules[n].key] > 1]
        rules = [checkup.rules[n].span for n in (alike if facts else gave)]
        return [*deeper, *reversed(rules), site.span]
    return []


_AGGREGATE = re.compile(r"[A-Z]\w*\s*\{")


def _of_null(tally: ProbeTally, robot: str, tick: int, first: str) -> Finding:
    leaves, decided = _leaves(tally, robot), _decided(tally, robot)
    nulls = [
        place
        for number, site in enumerate(tally.checkup.sites)
        if site.kind == "value" and tally.sites[number].first_true is not None
        if tally.checkup.rules[site.rule].predicate != "Robot" or site.rule in decided
        for place in (site.span, *site.places)
    ]
    span, others = _split([*nulls, *(span for leaf in leaves for span in leaf)])
    quoted = f" `{shorten(span.text)}` was null." if nulls and span else ""
    hint = "Use Coalesce or `if` to handle a missing value."
    aggregate = next((place for place in nulls if _AGGREGATE.search(place.text)), None)
    if aggregate is not None:
        where = f"The aggregation in line {aggregate.line}"
        hint = f"{where} had no rows; Coalesce replaces null."
    return Finding("bad engine", "warning", span, tick, f"{first}{quoted}", hint, others, robot)


def _split(places: Iterable[SourceSpan]) -> tuple[SourceSpan | None, tuple[SourceSpan, ...]]:
    """Return the first place and the others, one for each line."""
    by_line: dict[int, SourceSpan] = {}
    for place in places:
        by_line.setdefault(place.line, place)
    first, *others = by_line.values() or (None,)
    return first, tuple(others[:_MOST_PLACES])


def _of_memory(
    checkup: Checkup, observed: Observations, closer: Mapping[tuple[str, int], ProbeTally]
) -> Iterator[Finding]:
    reads = {field.name: field for field in reversed(checkup.reads)}
    writes = {field.name: field for field in reversed(checkup.writes)}
    for name, field in reads.items():
        if name not in observed.fields and (name not in writes or checkup.writes_all):
            close = closest(name, {*writes, *observed.fields})
            hint = f"Did you mean {close}?" if close else "It is always null."
            message = f"memory.{name} is read, but no memory ever had a field {name}."
            made = [rule.memory for rule in checkup.rules if rule.memory is not None]
            others = (writes[close].span,) if close in writes else tuple(made)
            first = observed.first
            yield Finding(
                "memory never written", "warning", field.span, first, message, hint, others
            )
    for name, field in writes.items():
        if name not in reads and not checkup.reads_all:
            close = closest(name, reads)
            hint = f"{close} is read; did you mean that?" if close else "It can be removed."
            message = f"The field {name} of memory is written and never read."
            yield Finding("memory never read", "note", field.span, observed.first, message, hint)
    for loss in observed.first_losses():
        name, tick, robot = loss.field, loss.tick, loss.robot
        if name not in reads:
            continue
        tally = closer[robot, tick]
        given = sorted(tally.robot_rows.get((robot, tick), ()), reverse=True)
        places = [checkup.rules[n].memory or checkup.rules[n].span for n in given]
        span, others = _split([*places, reads[name].span])
        message = f"{robot} forgot memory.{name} at tick {tick}: the new memory has no such field."
        hint = f"It is read in line {reads[name].span.line}; every new memory must include it."
        yield Finding("memory lost", "warning", span, tick, message, hint, others, robot)


def _of_texts(checkup: Checkup, observed: Observations, level: Level) -> Iterator[Finding]:
    names = {robot.name for robot in level.robots} | {beacon.name for beacon in level.beacons}
    names |= {area.name for area in level.areas if area.impenetrable}  # rays see their names
    known = {*names, *_SEEN, *observed.texts}
    for field in checkup.texts:
        if field.name in known:
            continue
        close = closest(field.name, names | _SEEN, 0.6) or next(
            (n for n in names if n.lower() == field.name.lower()), ""
        )
        hint = "Robots, beacons and solid areas have other names here."
        hint = f'Did you mean "{close}"?' if close else hint
        message = f'Nothing in this level is called "{field.name}".'
        yield Finding("unknown string", "warning", field.span, observed.first, message, hint)


def _of_definitions(checkup: Checkup, first: int) -> Iterator[Finding]:
    for made, other in checkup.duplicate_copies:
        source = shorten(made.span.text.partition(":=")[2].strip())
        message = f"{made.name} and {other.name} are the same: both are `{source}`."
        hint = "Give one of them another predicate, or remove it."
        yield Finding("same copy", "note", made.span, first, message, hint, (other.span,))
    for each in checkup.unused:
        message = f"Nothing uses {each.name}."
        yield Finding("unused", "note", each.span, first, message, "Use it, or remove it.")


def _of_movement(
    observed: Observations, closer: Mapping[tuple[str, int], ProbeTally]
) -> Iterator[Finding]:
    reported: set[tuple[str, SourceSpan | None]] = set()
    for stretch in sorted(observed.stretches, key=lambda each: [*_MOVEMENTS].index(each.kind)):
        if observed.won_at is not None and stretch.kind != "blocked":
            continue
        leaves = _leaves(closer[stretch.robot, stretch.first], stretch.robot)
        span, others = _split(place for each in zip_longest(*leaves) for place in each if place)
        if (stretch.kind, span) in reported:
            continue
        reported.add((stretch.kind, span))
        is_fixed = stretch.kind == "still" and not observed.is_over  # perhaps where it should be
        is_doubtful = observed.won_at is None and stretch.kind != "unfinished" and not is_fixed
        severity: Severity = "warning" if is_doubtful else "note"
        how, hint = _MOVEMENTS[stretch.kind]
        how += f" {stretch.period} ticks" if stretch.kind == "circle" else ""
        doing = f", mostly with `{shorten(span.text)}`" if span is not None else ""
        ticks = f"from tick {stretch.first} to {stretch.last}{stretch.way}"
        said, begin = f"{stretch.robot} {how} {ticks}{doing}.", stretch.first
        yield Finding(stretch.kind, severity, span, begin, said, hint, others, stretch.robot)


def _of_unchanged(checkup: Checkup, observed: Observations) -> Iterator[Finding]:
    """Yield the states that robots without progress remain in, such as a phase of a plan."""
    stuck = {each.robot for each in observed.stretches if each.last == observed.last}
    remain: dict[str, tuple[int, str, str]] = {}
    for (robot, name), (tick, value) in sorted(observed.since.items(), key=itemgetter(1)):
        # A state is a text that the program both sets and asks for.
        is_state = checkup.program.text.count(spell(value)) > 1
        if is_state and robot in stuck and observed.last - tick >= _LONG:
            remain.setdefault(name, (tick, value, robot))
    for field in checkup.writes if observed.won_at is None else ():
        if field.name in remain:
            tick, value, robot = remain[field.name]
            quoted = f"{robot}'s memory.{field.name} stayed {spell(shorten(value))}"
            message = f"{quoted} from tick {tick} to {observed.last}."
            hint = "Check the condition that should change it: can it ever hold?"
            span, others = _split([*field.places, field.span])
            yield Finding("unchanged", "note", span, tick, message, hint, others, robot)


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
    rules, decided = tally.checkup.rules, _decided(tally, robot)
    owners = {name for n in decided for name in rules[n].sources}
    found = []
    for number, site in enumerate(tally.checkup.sites):
        if site.kind != "leaf" or site.owner not in owners:
            continue
        ticks = tally.sites[number].ticks
        if rules[site.rule].predicate == "Robot":
            ticks = ticks & decided.get(site.rule, set())
        if ticks:
            found.append((rules[site.rule].is_function, -len(ticks), number))
    sites = {tally.checkup.sites[n].span: tally.checkup.sites[n] for *_, n in sorted(found)}
    return [[site.span, *site.places] for site in [*sites.values()][:_MOST_LEAVES]]


def _decided(tally: ProbeTally, robot: str) -> dict[int, set[int]]:
    """Return the rules of `Robot` whose row counted, because it was the last, with the ticks."""
    found: dict[int, set[int]] = {}
    for (who, tick), given in tally.robot_rows.items():
        if who == robot:
            found.setdefault(max(given), set()).add(tick)
    return found
