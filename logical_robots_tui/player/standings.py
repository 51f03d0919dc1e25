"""How the victories of all players of a server are distributed, and where one's own are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from logical_robots_tui.progress.board import ANONYMOUS, BoardStanding, shown_name

MEASURES = ("ticks", "size", "distance")
_INLIERS = 0.95  # share of the players whose values the bins before the last are for


class Histogram(NamedTuple):
    """How many players have won with how much of a measure; less is better.

    Attributes:
        measure: Its name.
        counts: Players by bins of equal width from the least value on; in the last also those
            with much more than nearly all others.
        bin: The number of one's own bin; None without a victory of one's own.
        rank: One's own rank, from 1; those with equal values share it. 0 without a victory.
        best: The least value.
        leader: Who has it first by name.
    """

    measure: str
    counts: tuple[int, ...]
    bin: int | None
    rank: int
    best: float
    leader: str

    @property
    def players(self) -> int:
        return sum(self.counts)


def histograms(standings: Sequence[BoardStanding], bins: int) -> Iterator[Histogram]:
    """Yield a histogram for each measure, if anybody has won."""
    for measure in MEASURES if standings else ():
        values = [float(getattr(standing, measure)) for standing in standings]
        ordered = sorted(values)
        low, high = ordered[0], ordered[int((len(values) - 1) * _INLIERS)]
        width = (high - low) / bins or 1.0
        counts = [0] * bins
        for value in values:
            counts[_bin(value, low, width, bins)] += 1
        own_value = next((v for v, s in zip(values, standings, strict=True) if s.is_me), None)
        leaders = (shown_name(s.name) for v, s in zip(values, standings, strict=True) if v == low)
        yield Histogram(
            measure,
            tuple(counts),
            None if own_value is None else _bin(own_value, low, width, bins),
            0 if own_value is None else 1 + sum(value < own_value for value in values),
            low,
            min(leaders, key=lambda name: (name == ANONYMOUS, name)),
        )


def _bin(value: float, low: float, width: float, bins: int) -> int:
    return int(min((value - low) / width, bins - 1))


def standing_rows(standings: Sequence[BoardStanding]) -> list[tuple[str, ...]]:
    """Return a table with a head, by ticks; one's own row is marked."""
    rows: list[tuple[str, ...]] = [("", "rank", "player", *MEASURES)]
    for standing in standings:
        rank = 1 + sum(rival.ticks < standing.ticks for rival in standings)
        numbers = (f"{standing.ticks:,}", f"{standing.size:,}", f"{standing.distance:,.0f}")
        mark = "you" if standing.is_me else ""
        rows.append((mark, str(rank), shown_name(standing.name), *numbers))
    return rows
