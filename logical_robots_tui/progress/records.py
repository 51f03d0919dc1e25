"""Immutable records of a player's work on levels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from datetime import datetime

State: TypeAlias = Literal["new", "in work", "won"]


class Measures(NamedTuple):
    """The measures of a victory; less is better, except for `wins` and `goals`.

    `distance` is map units of all robots together; `wins` of `starts` shifted starts is None if
    not tried.
    """

    ticks: int
    rules: int
    distance: float
    wins: int | None = None
    starts: int = 0
    goals: tuple[str, ...] = ()


class Bests(NamedTuple):
    """The best of each measure, possibly of different programs; None if not measured yet."""

    ticks: int | None = None
    rules: int | None = None
    distance: float | None = None
    wins: int | None = None
    starts: int = 0
    goals: tuple[str, ...] = ()


class LevelRecord(NamedTuple):
    state: State = "new"
    hints: int = 0
    bests: Bests = Bests()
    versions: int = 0


class Version(NamedTuple):
    """A program used in a level; `kept` is when it was last used, with time zone."""

    number: int
    text: str
    kept: datetime
    won: bool = False
    measures: Measures | None = None


NEW = LevelRecord()
"""The record of a level that was never started."""
