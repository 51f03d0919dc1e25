"""Findings: what stands out in the counts of a run, such as rules without rows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from logical_robots_tui.explain.diagnosis.counting import Count, Tally, is_always_true
from logical_robots_tui.explain.diagnosis.sites import TESTS, Site
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.language.diagnostics import most_similar
from logical_robots_tui.schema import INPUTS
from logical_robots_tui.values import Value

FindingKind = Literal[
    "several rows",
    "no row",
    "bad engine",
    "notice",
    "unknown text",
    "memory never written",
    "memory never read",
    "memory lost",
    "no rows",
    "always null",
    "never true",
    "never false",
    "circle",
    "blocked",
    "still",
    "unfinished",
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


_LONGEST = 60  # characters in a quotation
_MOST_LISTED = 4  # values


def rule_findings(tally: Tally, *, won: bool) -> list[Finding]:
    """Return findings, the most significant first; notes, not warnings, if the run was won."""
    return list(_Reporter(tally, won=won).findings())


def shorten(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


class _Reporter:
    def __init__(self, tally: Tally, *, won: bool) -> None:
        self._tally = tally
        self._checkup = tally.checkup
        self._said: set[int] = set()
        self._severity: Severity = "note" if won else "warning"

    def findings(self) -> Iterator[Finding]:
        silent = self._silent()
        for number in sorted(silent, key=lambda n: self._is_consequence(n, silent)):
            found = self._of_rule(number, silent)
            if found is not None:
                yield found
        for tell in (self._of_text, self._of_site, self._of_truth):
            for number, site in enumerate(self._checkup.sites):
                found = None if number in self._said else tell(number, site)
                if found is not None:
                    yield found

    # -- rules ---------------------------------------------------------------------------------

    def _silent(self) -> dict[int, int | None]:
        silent = {}
        for number, rule in enumerate(self._checkup.rules):
            count = self._tally.rules[number]
            if rule.is_needed and not rule.is_function and count.looks and count.gave is None:
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
            return Finding(
                "no rows",
                "note",
                rule.span,
                self._tally.ticks[0],
                f"This rule of {rule.predicate} never had a row; {site.predicate} has none.",
                f"Look at {site.predicate} first.",
                (site.span,),
            )
        reason = self._why_not(site, count)
        return Finding(
            "no rows",
            self._severity,
            site.span,
            count.reached or self._tally.ticks[0],
            f"The rule of {rule.predicate} in line {rule.span.line} never had a row: {reason}",
            "If it should have, check this condition.",
            (rule.span, *site.places),
        )

    # -- sites ---------------------------------------------------------------------------------

    def _of_text(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if site.literal is None or count.reached is None or count.true is not None:
            return None
        if not count.left:
            return None
        self._said.add(number)
        close = most_similar(site.literal, (v for v in count.left if isinstance(v, str)))
        hint = f'Did you mean "{close}"?' if close else f"It was {_join(count.left)}."
        message = f'{shorten(site.other)} was never "{site.literal}"{_in(site)}.'
        severity: Severity = "warning" if close else self._severity
        return self._finding("never true", severity, site, count, message, hint)

    def _of_site(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if (
            count.reached is None
            or count.true is not None
            or site.kind in ("leaf", "text", "value")
        ):
            return None
        if site.kind == "part" and site.predicate in ("", *INPUTS):
            return None
        if site.kind == "part" and site.stands == "denied":
            return None  # reported where it is negated
        self._said.add(number)
        if self._is_explained(site):
            return None
        is_null = site.kind in TESTS and count.false is None
        what: FindingKind = "always null" if is_null else "never true"
        reason = self._why_not(site, count)
        hint = "Check what it compares."
        if is_null:
            hint = "Part of it has no value: a missing field, or an aggregate of nothing."
        return self._finding(
            what, self._severity, site, count, reason[0].upper() + reason[1:], hint
        )

    def _of_truth(self, number: int, site: Site) -> Finding | None:
        count = self._tally.sites[number]
        if not is_always_true(site, count):
            return None
        message = f"{_quote(site)} was never false{_in(site)}."
        hint = "It never excluded anything; is it the right comparison?"
        return self._finding("never false", "note", site, count, message, hint)

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
        quoted, where = _quote(site), _in(site)
        if site.kind == "part":
            return f"{quoted} had no rows{where}."
        if site.kind in TESTS and count.false is None and count.null is not None:
            return f"{quoted} was always null{where}."
        if count.left and count.right:
            left, right = _join(count.left), _join(count.right)
            return f"{quoted} was never true{where}: {left} on the left, {right} on the right."
        if count.left:
            other = shorten(site.other)
            return f"{quoted} was never true{where}: {other} was {_join(count.left)}."
        missed = _closest_miss(site, count)
        return f"{quoted} was never true{where}{missed}."

    def _finding(
        self,
        kind: FindingKind,
        severity: Severity,
        site: Site,
        count: Count,
        message: str,
        hint: str,
    ) -> Finding:
        tick = count.reached if count.reached is not None else self._tally.ticks[0]
        return Finding(kind, severity, site.span, tick, message, hint, site.places)


def _is_inside(part: Span, whole: Span) -> bool:
    return whole.holds(part) and not part.holds(whole)


def _quote(site: Site) -> str:
    return f"`{shorten(site.span.text)}`"


def _in(site: Site) -> str:
    return f" in {site.within}" if site.within else ""


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


def _value(value: Value) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:.4g}"


def _join(values: Iterable[Value]) -> str:
    known = sorted(values, key=str)
    more = len(known) - _MOST_LISTED
    listed = [_value(value) for value in known[:_MOST_LISTED]]
    if more > 0:
        return f"{', '.join(listed)} or one of {more} others"
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} or {listed[-1]}"
