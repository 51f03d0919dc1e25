"""Findings: what stands out in the counts of a run, such as rules without rows."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Literal

from logical_robots_tui.explain.diagnosis.sites import (
    MOST_VALUES,
    TESTS,
    Count,
    ProbeTally,
    Site,
    is_always_true,
    is_reportable,
)
from logical_robots_tui.explain.why.probing import SourceSpan
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
    span: SourceSpan | None
    tick: int
    message: str
    hint: str
    related: tuple[SourceSpan, ...] = ()
    robot: str = ""

    @property
    def see_also(self) -> str:
        """The lines of other places, "" if there are none."""
        own_line = {self.span.line} if self.span is not None else set[int]()
        lines = sorted({span.line for span in self.related} - own_line)
        numbers = ", ".join(map(str, lines))
        return f"See also line{'s' * (len(lines) > 1)} {numbers}." if lines else ""


_LONGEST = 60  # characters in a quotation
_MOST_LISTED = 4  # values


_RARE = 20
"""Ticks; a site evaluated in fewer of a longer run is not a reason for a warning."""


def rule_findings(
    tally: ProbeTally, *, is_over: bool, is_complete: bool = True
) -> tuple[list[Finding], list[Finding]]:
    """Return findings and their consequences, each the most significant first.

    Args:
        tally: The counts.
        is_over: Whether the robots will achieve nothing more; only then there are warnings.
        is_complete: Whether every tick was examined.
    """
    findings = list(_Reporter(tally, is_over=is_over, is_complete=is_complete).findings())
    lines = {finding.span.line for finding in findings if finding.span is not None}
    # Their values come from the places of other findings.
    consequences = [
        finding
        for finding in findings
        if finding.span and lines & {place.line for place in finding.related} - {finding.span.line}
    ]
    return [finding for finding in findings if finding not in consequences], consequences


def shorten(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


class _Reporter:
    def __init__(self, tally: ProbeTally, *, is_over: bool, is_complete: bool) -> None:
        self._tally = tally
        self._checkup = tally.checkup
        self._reported_sites: set[int] = set()
        self._is_over, self._is_complete = is_over, is_complete
        self._tick_count, self._first_tick = len(tally.ticks), min(tally.ticks, default=0)

    def findings(self) -> Iterator[Finding]:
        silent = {}
        for number, rule in enumerate(self._checkup.rules):
            count = self._tally.rules[number]
            was_asked = count.first_examined is not None and count.first_row is None
            if rule.is_needed and not rule.is_function and was_asked:
                silent[number] = self._tally.stopping_site(number)
        for number in sorted(silent, key=lambda n: self._is_consequence(n, silent)):
            finding = self._rule_finding(number, silent)
            if finding is not None:
                yield finding
        for report in (
            self._text_finding,
            self._site_finding,
            self._truth_finding,
            self._fallback_finding,
        ):
            for number, site in enumerate(self._checkup.sites):
                finding = None if number in self._reported_sites else report(number, site)
                is_often = len(self._tally.sites[number].ticks) > 1 or self._tick_count < _RARE
                if finding is not None and (finding.severity == "warning" or is_often):
                    yield finding

    def _is_consequence(self, rule: int, silent: dict[int, int | None]) -> bool:
        stop = silent[rule]
        predicate = self._checkup.sites[stop].predicate if stop is not None else ""
        rules = {n for n, rule in enumerate(self._checkup.rules) if rule.predicate == predicate}
        return bool(rules) and rules <= silent.keys()

    def _rule_finding(self, number: int, silent: dict[int, int | None]) -> Finding | None:
        rule, stop = self._checkup.rules[number], silent[number]
        if stop is None:
            return None
        site, count = self._checkup.sites[stop], self._tally.sites[stop]
        self._reported_sites.add(stop)
        if self._is_consequence(number, silent):
            rules = [n for n in silent if self._checkup.rules[n].predicate == site.predicate]
            causes = [self._checkup.sites[stop] for n in rules if (stop := silent[n]) is not None]
            message = f"This rule of {rule.predicate} never had a row; {site.predicate} had none."
            hint = f"Look at {site.predicate} first."
            related = tuple(cause.span for cause in causes)
            return Finding("no rows", "note", rule.span, self._first_tick, message, hint, related)
        message = f"The rule of {rule.predicate} in line {rule.span.line} never had a row:"
        message += f" {self._failure_reason(site, count)}"
        hint = "If it should have, check this condition."
        tick, related = count.first_reached or self._first_tick, (rule.span, *site.places)
        return Finding("no rows", self._severity(count), site.span, tick, message, hint, related)

    def _text_finding(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if (
            site.literal is None
            or count.first_reached is None
            or count.first_true is not None
            or not count.left
        ):
            return None
        self._reported_sites.add(number)
        close = most_similar(site.literal, (v for v in count.left if isinstance(v, str)))
        hint = f'Did you mean "{close}"?' if close else f"It was {_values(count.left, count)}."
        message = f"{_quote(site)} never held{self._circumstances(site, count)}."
        severity: Severity = "warning" if close else self._severity(count)
        return self._finding("never true", severity, site, count, message, hint)

    def _site_finding(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        has_own_message = site.kind in ("leaf", "text", "value", "fallback")
        if (
            count.first_reached is None
            or count.first_true is not None
            or has_own_message
            or not is_reportable(site)
        ):
            return None
        self._reported_sites.add(number)
        if self._is_explained(site):
            return None
        is_null = site.kind in TESTS and count.first_false is None
        kind: FindingKind = "always null" if is_null else "never true"
        reason = self._failure_reason(site, count)
        hint = "Check what it compares."
        if is_null:
            hint = "Part of it has no value: a missing field, or an aggregate of nothing."
        return self._finding(kind, self._severity(count), site, count, reason, hint)

    def _truth_finding(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if not is_always_true(site, count):
            return None
        message = f"{_quote(site)} held{self._circumstances(site, count, quantifier='all ')}."
        hint = "It never excluded anything; is it the right comparison?"
        return self._finding("never false", "note", site, count, message, hint)

    def _fallback_finding(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if site.kind != "fallback" or count.first_reached is None or count.first_true is not None:
            return None
        never = f"{_quote(site)} was never null{self._circumstances(site, count)}"
        message = f"{never}: `{shorten(site.counterpart)}` was never used."
        hint = "Remove the unused value, or put it first if it should win."
        return self._finding("never null", "note", site, count, message, hint)

    def _is_explained(self, whole: Site) -> bool:
        if whole.operator != "&&":
            return False
        inner = [
            (site.span, count)
            for site, count in zip(self._checkup.sites, self._tally.sites, strict=True)
            if site.kind == "operand" and site.within == whole.within
            if _is_inside(site.span, whole.span) and count.first_reached is not None
        ]
        return any(
            count.first_true is None
            and not any(_is_inside(span, outer) and c.first_true is not None for outer, c in inner)
            for span, count in inner
        )

    def _failure_reason(self, site: Site, count: Count) -> str:
        quoted = _quote(site)
        if site.kind == "part":
            return f"{quoted} had no row{self._circumstances(site, count)}."
        if site.kind in TESTS and count.first_false is None and count.first_null is not None:
            return f"{quoted} was null{self._circumstances(site, count, quantifier='all ')}."
        statement = f"{quoted} never held{self._circumstances(site, count)}"
        if count.left and count.right:
            left, right = _values(count.left, count), _values(count.right, count)
            return f"{statement}: {left} on the left, {right} on the right."
        if count.left:
            return f"{statement}: {shorten(site.counterpart)} was {_values(count.left, count)}."
        return f"{statement}{_closest_miss(site, count)}."

    def _circumstances(self, site: Site, count: Count, *, quantifier: str = "") -> str:
        """Return where, how often and when a site was first evaluated, in words."""
        verb = "evaluated" if self._is_complete else "examined"
        place = f" in {site.within}" if site.within else ""
        if count.cases == 1:
            return f"{place} in the one case {verb}, at tick {count.first_reached}"
        cases = f"{quantifier or 'the '}{count.cases:,} cases"
        return f"{place} in {cases} {verb}, first at tick {count.first_reached}"

    def _severity(self, count: Count) -> Severity:
        is_rare = len(count.ticks) < min(_RARE, self._tick_count)
        return "warning" if self._is_over and not is_rare else "note"

    def _finding(
        self,
        kind: FindingKind,
        severity: Severity,
        site: Site,
        count: Count,
        message: str,
        hint: str,
    ) -> Finding:
        tick = count.first_reached if count.first_reached is not None else self._first_tick
        return Finding(kind, severity, site.span, tick, message, hint, site.places)


def _is_inside(part: SourceSpan, whole: SourceSpan) -> bool:
    return whole.holds(part) and not part.holds(whole)


def _quote(site: Site) -> str:
    is_argument = site.kind == "text"  # the comparison is in the function that gets it
    return (
        f"`{shorten(f'{site.counterpart} == {site.span.text}' if is_argument else site.span.text)}`"
    )


def _closest_miss(site: Site, count: Count) -> str:
    difference = None
    if site.operator in ("<", "<="):
        difference, direction = count.min_difference, "too much"
    elif site.operator in (">", ">="):
        difference, direction = count.max_difference, "too little"
    if difference is None:
        return ""
    if not difference:
        return f"; at best {shorten(site.counterpart)} was exactly the limit"
    return f"; at best {shorten(site.counterpart)} was {abs(difference):.4g} {direction}"


def _values(values: Collection[Value], count: Count) -> str:
    """Return values in words; null may be on either side of a comparison."""
    ordered = sorted(values, key=str)
    quoted = [f'"{v}"' if isinstance(v, str) else f"{v:.4g}" for v in ordered[:_MOST_LISTED]]
    if count.first_null is not None:
        quoted.append("null")
    if len(ordered) > _MOST_LISTED:
        omitted_count = len(ordered) - _MOST_LISTED
        remainder = f"{'at least ' if len(ordered) == MOST_VALUES else ''}{omitted_count} others"
        return f"{', '.join(quoted)} or one of {remainder}"
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"
