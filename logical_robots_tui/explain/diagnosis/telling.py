"""Findings: what stands out in the counts of a run, such as rules without rows."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Literal

from logical_robots_tui.explain.diagnosis.sites import (
    MOST_VALUES,
    TESTS,
    Count,
    Site,
    Tally,
    is_always_true,
    is_telling,
)
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.diagnostics import most_similar
from logical_robots_tui.values import Value

FindingKind = Literal[
    "several rows",
    "no row",
    "bad engine",
    "notice",
    "unknown string",
    "unused",
    "same copy",
    "memory never written",
    "memory never read",
    "memory lost",
    "no rows",
    "always null",
    "never true",
    "never false",
    "never null",
    "circle",
    "blocked",
    "still",
    "unfinished",
    "unchanged",
]

Severity = Literal["warning", "note"]


@dataclass(frozen=True, slots=True)
class Finding:
    """A likely mistake: a ``warning`` is hardly intended, a ``note`` may well be."""

    kind: FindingKind
    severity: Severity
    span: Span | None
    tick: int
    message: str
    hint: str
    others: tuple[Span, ...] = ()
    robot: str = ""

    @property
    def see_also(self) -> str:
        """The lines of other places, "" if there are none."""
        own = {self.span.line} if self.span is not None else set[int]()
        lines = sorted({span.line for span in self.others} - own)
        listed = ", ".join(map(str, lines))
        return f"See also line{'s' * (len(lines) > 1)} {listed}." if lines else ""


_LONGEST = 60  # characters in a quotation
_MOST_LISTED = 4  # values


_RARE = 20
"""Ticks; what was asked in fewer of a longer run is not a reason for a warning."""


def rule_findings(
    tally: Tally, *, is_over: bool, is_complete: bool = True
) -> tuple[list[Finding], list[Finding]]:
    """Return findings, and those that follow from others, the most significant first.

    Args:
        tally: The counts.
        is_over: Whether the robots will achieve nothing more; only then there are warnings.
        is_complete: Whether every tick was examined.
    """
    found = list(_Reporter(tally, is_over=is_over, is_complete=is_complete).findings())
    lines = {each.span.line for each in found if each.span is not None}
    # What these are about comes from places of other findings.
    consequences = [
        each
        for each in found
        if each.span and lines & {place.line for place in each.others} - {each.span.line}
    ]
    return [each for each in found if each not in consequences], consequences


def shorten(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


class _Reporter:
    def __init__(self, tally: Tally, *, is_over: bool, is_complete: bool) -> None:
        self._tally = tally
        self._checkup = tally.checkup
        self._said: set[int] = set()
        self._is_over, self._is_complete = is_over, is_complete
        self._all, self._first = len(tally.ticks), min(tally.ticks, default=0)

    def findings(self) -> Iterator[Finding]:
        silent = self._silent()
        for number in sorted(silent, key=lambda n: self._is_consequence(n, silent)):
            found = self._of_rule(number, silent)
            if found is not None:
                yield found
        for tell in (self._of_text, self._of_site, self._of_truth, self._of_fallback):
            for number, site in enumerate(self._checkup.sites):
                found = None if number in self._said else tell(number, site)
                is_often = len(self._tally.sites[number].ticks) > 1 or self._all < _RARE
                if found is not None and (found.severity == "warning" or is_often):
                    yield found

    def _silent(self) -> dict[int, int | None]:
        silent = {}
        for number, rule in enumerate(self._checkup.rules):
            count = self._tally.rules[number]
            was_asked = count.asked is not None and count.gave is None
            if rule.is_needed and not rule.is_function and was_asked:
                silent[number] = self._tally.stopped(number)
        return silent

    def _is_consequence(self, rule: int, silent: dict[int, int | None]) -> bool:
        stop = silent[rule]
        asked = self._checkup.sites[stop].predicate if stop is not None else ""
        mine = {n for n, each in enumerate(self._checkup.rules) if each.predicate == asked}
        return bool(mine) and mine <= silent.keys()

    def _of_rule(self, number: int, silent: dict[int, int | None]) -> Finding | None:
        rule, stop = self._checkup.rules[number], silent[number]
        if stop is None:
            return None
        site, count = self._checkup.sites[stop], self._tally.sites[stop]
        self._said.add(stop)
        if self._is_consequence(number, silent):
            rules = [n for n in silent if self._checkup.rules[n].predicate == site.predicate]
            stops = [self._checkup.sites[stop] for n in rules if (stop := silent[n]) is not None]
            said = f"This rule of {rule.predicate} never had a row; {site.predicate} had none."
            hint, others = f"Look at {site.predicate} first.", tuple(each.span for each in stops)
            return Finding("no rows", "note", rule.span, self._first, said, hint, others)
        said = f"The rule of {rule.predicate} in line {rule.span.line} never had a row:"
        said += f" {self._why_not(site, count)}"
        hint = "If it should have, check this condition."
        tick, others = count.reached or self._first, (rule.span, *site.places)
        return Finding("no rows", self._severity(count), site.span, tick, said, hint, others)

    def _of_text(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if (
            site.literal is None
            or count.reached is None
            or count.true is not None
            or not count.left
        ):
            return None
        self._said.add(number)
        close = most_similar(site.literal, (v for v in count.left if isinstance(v, str)))
        hint = f'Did you mean "{close}"?' if close else f"It was {_values(count.left, count)}."
        message = f"{_quote(site)} never held{self._asked(site, count)}."
        severity: Severity = "warning" if close else self._severity(count)
        return self._finding("never true", severity, site, count, message, hint)

    def _of_site(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        has_other_words = site.kind in ("leaf", "text", "value", "fallback")
        if (
            count.reached is None
            or count.true is not None
            or has_other_words
            or not is_telling(site)
        ):
            return None
        self._said.add(number)
        if self._is_explained(site):
            return None
        is_null = site.kind in TESTS and count.false is None
        what: FindingKind = "always null" if is_null else "never true"
        reason = self._why_not(site, count)
        hint = "Check what it compares."
        if is_null:
            hint = "Part of it has no value: a missing field, or an aggregate of nothing."
        return self._finding(what, self._severity(count), site, count, reason, hint)

    def _of_truth(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if not is_always_true(site, count):
            return None
        message = f"{_quote(site)} held{self._asked(site, count, every='all ')}."
        hint = "It never excluded anything; is it the right comparison?"
        return self._finding("never false", "note", site, count, message, hint)

    def _of_fallback(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if site.kind != "fallback" or count.reached is None or count.true is not None:
            return None
        never = f"{_quote(site)} was never null{self._asked(site, count)}"
        message = f"{never}: `{shorten(site.other)}` was never used."
        hint = "Remove the unused value, or put it first if it should win."
        return self._finding("never null", "note", site, count, message, hint)

    def _is_explained(self, whole: Site) -> bool:
        if whole.operator != "&&":
            return False
        inner = [
            (site.span, count)
            for site, count in zip(self._checkup.sites, self._tally.sites, strict=True)
            if site.kind == "operand" and site.within == whole.within
            if _is_inside(site.span, whole.span) and count.reached is not None
        ]
        return any(
            count.true is None
            and not any(_is_inside(span, around) and c.true is not None for around, c in inner)
            for span, count in inner
        )

    def _why_not(self, site: Site, count: Count) -> str:
        quoted = _quote(site)
        if site.kind == "part":
            return f"{quoted} had no row{self._asked(site, count)}."
        if site.kind in TESTS and count.false is None and count.null is not None:
            return f"{quoted} was null{self._asked(site, count, every='all ')}."
        said = f"{quoted} never held{self._asked(site, count)}"
        if count.left and count.right:
            left, right = _values(count.left, count), _values(count.right, count)
            return f"{said}: {left} on the left, {right} on the right."
        if count.left:
            return f"{said}: {shorten(site.other)} was {_values(count.left, count)}."
        return f"{said}{_closest_miss(site, count)}."

    def _asked(self, site: Site, count: Count, *, every: str = "") -> str:
        """Return where, how often and when first something was asked."""
        done = "evaluated" if self._is_complete else "examined"
        where = f" in {site.within}" if site.within else ""
        if count.ways == 1:
            return f"{where} in the one case {done}, at tick {count.reached}"
        cases = f"{every or 'the '}{count.ways:,} cases"
        return f"{where} in {cases} {done}, first at tick {count.reached}"

    def _severity(self, count: Count) -> Severity:
        is_rare = len(count.ticks) < min(_RARE, self._all)
        return "warning" if self._is_over and not is_rare else "note"

    def _finding(
        self, kind: FindingKind, severity: Severity, site: Site, count: Count, said: str, hint: str
    ) -> Finding:
        tick = count.reached if count.reached is not None else self._first
        return Finding(kind, severity, site.span, tick, said, hint, site.places)


def _is_inside(part: Span, whole: Span) -> bool:
    return whole.holds(part) and not part.holds(whole)


def _quote(site: Site) -> str:
    is_given = site.kind == "text"  # the comparison is in the function that gets it
    return f"`{shorten(f'{site.other} == {site.span.text}' if is_given else site.span.text)}`"


def _closest_miss(site: Site, count: Count) -> str:
    lacks = None
    if site.operator in ("<", "<="):
        lacks, what = count.least, "too much"
    elif site.operator in (">", ">="):
        lacks, what = count.greatest, "too little"
    if lacks is None:
        return ""
    if not lacks:
        return f"; at best {shorten(site.other)} was exactly the limit"
    return f"; at best {shorten(site.other)} was {abs(lacks):.4g} {what}"


def _values(values: Collection[Value], count: Count) -> str:
    """Return values in words; null may be on either side of a comparison."""
    known = sorted(values, key=str)
    listed = [f'"{v}"' if isinstance(v, str) else f"{v:.4g}" for v in known[:_MOST_LISTED]]
    if count.null is not None:
        listed.append("null")
    if len(known) > _MOST_LISTED:
        more = len(known) - _MOST_LISTED
        others = f"{'at least ' if len(known) == MOST_VALUES else ''}{more} others"
        return f"{', '.join(listed)} or one of {others}"
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} or {listed[-1]}"
