"""A finding: something in a run that may be a mistake, and its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from logical_robots_tui.mind.diagnosis.sites import Span

__all__ = ["Finding", "FindingKind", "Severity"]

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
    """A likely mistake.

    Attributes:
        kind: The kind.
        severity: ``warning`` for what is hardly intended, ``note`` for what may well be.
        span: Its place in the program, or None if there is no single place.
        tick: The first tick in which it happened.
        message: The finding, one plain sentence.
        hint: What to look at, one sentence.
        others: Related places, the nearest first.
        robot: The robot that it is about, or "".
    """

    kind: FindingKind
    severity: Severity
    span: Span | None
    tick: int
    message: str
    hint: str
    others: tuple[Span, ...] = ()
    robot: str = ""
