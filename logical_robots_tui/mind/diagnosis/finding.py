"""A finding: something in a run that may be a mistake, and where to look."""

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
    """What was found.

    Attributes:
        kind: What sort of thing.
        severity: ``warning`` for what is hardly meant, ``note`` for what may well be.
        span: Where it stands in the program, or None if it is not one place.
        tick: The first tick of it.
        message: What was found, one plain sentence.
        hint: What to look at, one sentence.
        others: Further places that have a part in it, the nearest first.
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
