"""Rankings: shares of points, intervals, strengths, cycles; for a terminal, a page and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from logical_robots_tui.lab.exporting import (
    ResultTable,
    Row,
    RunRecords,
    as_code,
    harmless_text,
    shade,
    table_section,
)
from logical_robots_tui.lab.folder import Manifest
from logical_robots_tui.lab.tasks import Result
from logical_robots_tui.wording import align

Numbers: TypeAlias = NDArray[np.float64]


RESAMPLES = 1_000
"""Resamples of the starts for intervals."""

_SEED = 23
_PRIOR = 0.1  # of a pairing, drawn, against a player of strength 0
_ELO = 400  # points of strength for odds of ten to one
_DIGITS = 9  # beyond which sums depend on their order
_MOST_STEPS = 100_000


class Standing(NamedTuple):
    """A player's rank, share of the points and strength, with 95% intervals.

    `best` and `worst` are the ranks not ruled out; `strength` is as of `strengths`.
    """

    player: str
    best: int
    worst: int
    share: float
    low: float
    high: float
    strength: float
    pairings: int

    @property
    def rank(self) -> str:
        """The rank, or the range of possible ranks, such as ``2-4``."""
        return str(self.best) if self.best == self.worst else f"{self.best}-{self.worst}"


class Pairing(NamedTuple):
    """A player's share of the points against another, with its 95% interval."""

    share: float
    low: float
    high: float


class Ranking(NamedTuple):
    """The result of a tournament, best first, ties by name; each pairing is there twice.

    In `cycles` each player beats the next and the last the first, beyond doubt.
    """

    standings: tuple[Standing, ...]
    pairings: Mapping[tuple[str, str], Pairing]
    cycles: tuple[tuple[str, str, str], ...]


def share_of_points(points: float, opponent_points: float) -> float:
    """Return the share of the points, from 0 to 1; one half if both have none.

    If points are below 0, the lower of the two counts as 0 and the higher one from there.
    """
    low = min(0.0, points, opponent_points)
    points, opponent_points = points - low, opponent_points - low
    return points / (points + opponent_points) if points + opponent_points else 0.5


def share_of_match(result: Result, seats: Mapping[str, str], player: str) -> float:
    lost = {seats[team] for team in result.forfeit}
    if lost:
        return 0.5 if len(lost) > 1 else float(player not in lost)
    player_points = sum(points for team, points in result.points.items() if seats[team] == player)
    opponent_points = sum(points for team, points in result.points.items() if seats[team] != player)
    return share_of_points(player_points, opponent_points)


def ranking_of(records: RunRecords, *, resamples: int = RESAMPLES) -> Ranking:
    """Return the ranking by all matches that were played from all seats."""
    manifest, players = records.manifest, records.manifest.players
    pairs = [pair for pairs in manifest.rounds for pair in pairs]
    names = [player.name for player in players]
    pair_index = {(names[i], names[j]): n for n, (i, j) in enumerate(pairs)}
    shares = np.full((2, len(pairs), manifest.starts + 1), np.nan)
    for n, pair in enumerate(pairs):
        lost = [bool(players[index].lost) for index in pair]
        if any(lost):
            shares[:, n] = 0.5 if all(lost) else float(lost[1])
    for run in records.finished:
        seats = {team: str(name) for team, name in run.cell.settings.items()}
        first, second, *_ = seats.values()
        is_swapped = (first, second) not in pair_index
        pair_names = (second, first) if is_swapped else (first, second)
        share = share_of_match(run.result, seats, pair_names[0])
        shares[int(is_swapped), pair_index[pair_names], run.start] = share
    if manifest.match.parity is not None:  # each start has been played from one of the seats
        shares = np.where(np.isnan(shares), shares[::-1], shares)
    return ranking_of_shares(names, pairs, shares.mean(axis=0), resamples=resamples)


def ranking_of_shares(
    players: list[str], pairs: list[tuple[int, int]], shares: Numbers, *, resamples: int = RESAMPLES
) -> Ranking:
    """Return the ranking; `shares` are the first player's, pairs x starts, NaN where missing."""
    is_present = ~np.isnan(shares)
    has_shares = [bool(row.any()) for row in is_present]
    pairs = [pair for pair, has_share in zip(pairs, has_shares, strict=True) if has_share]
    shares, is_present = shares[has_shares], is_present[has_shares]
    starts = shares.shape[1]
    chance = np.random.default_rng(_SEED)
    weights = chance.multinomial(starts, [1 / starts] * starts, size=resamples).astype(float)
    means = _means(np.ones((1, starts)), shares, is_present)
    sample_means = _means(weights, shares, is_present)
    sample_means = np.where(np.isnan(sample_means), means, sample_means)
    low, high = (np.round(bound, _DIGITS) for bound in _interval(sample_means))
    (mean,) = np.round(means, _DIGITS)
    pairings: dict[tuple[str, str], Pairing] = {}
    for (i, j), *pairing in zip(pairs, mean.tolist(), low.tolist(), high.tolist(), strict=True):
        share, lowest, highest = pairing
        pairings[players[i], players[j]] = Pairing(share, lowest, highest)
        pairings[players[j], players[i]] = Pairing(1 - share, 1 - highest, 1 - lowest)
    standings = _standings(players, pairs, mean, sample_means)
    wins = {names for names, pairing in pairings.items() if pairing.low > 1 / 2}
    return Ranking(standings, pairings, _cycles([standing.player for standing in standings], wins))


def _means(weights: Numbers, shares: Numbers, is_present: NDArray[np.bool_]) -> Numbers:
    """Return the mean share of each pair over weighted starts: resamples x pairs."""
    # Not as a product of matrices, whose sums depend on the machine.
    totals = np.einsum("bs,ms->bm", weights, np.where(is_present, shares, 0.0))
    with np.errstate(invalid="ignore"):
        means: Numbers = totals / np.einsum("bs,ms->bm", weights, is_present.astype(float))
    return means


def _interval(samples: Numbers) -> Numbers:
    bounds: Numbers = np.quantile(samples, (0.025, 0.975), axis=0)
    return bounds


def _standings(
    players: list[str], pairs: list[tuple[int, int]], mean: Numbers, sample_means: Numbers
) -> tuple[Standing, ...]:
    wins = np.zeros((len(players), len(players)))
    ends: list[tuple[float, float]] = []
    for n, (i, j) in enumerate(pairs):
        wins[i, j], wins[j, i] = mean[n], 1 - mean[n]
    for index in range(len(players)):
        player_shares = [sample_means[:, n] for n, (i, _) in enumerate(pairs) if i == index]
        player_shares += [1 - sample_means[:, n] for n, (_, j) in enumerate(pairs) if j == index]
        low, high = _interval(np.mean(player_shares, axis=0)) if player_shares else (0.0, 1.0)
        ends.append((round(float(low), _DIGITS), round(float(high), _DIGITS)))
    games = wins + wins.T > 0
    strength = strengths(wins)
    standings = []
    for index, name in enumerate(players):
        low, high = ends[index]
        count = int(games[index].sum())
        share = round(float(wins[index].sum()) / count, _DIGITS) if count else 0.5
        best = 1 + sum(other_low > high for other_low, _ in ends)
        worst = len(players) - sum(other_high < low for _, other_high in ends)
        rating = round(float(strength[index]), 3)
        standings.append(Standing(name, best, worst, share, low, high, rating, count))
    return tuple(sorted(standings, key=lambda standing: (-standing.share, standing.player)))


def strengths(wins: Numbers) -> Numbers:
    """Return maximum-likelihood strengths; 0 points is average, 400 more odds of ten to one.

    By the MM algorithm for the Bradley-Terry model (Hunter, "MM algorithms for generalized
    Bradley-Terry models", 2004). A tenth of a drawn pairing against an average player is added,
    so that losing everything has a strength. `wins`, players x players, are the row's shares
    against the column's; both sides of a pairing add up to 1, or are 0 if they have not met.
    """
    games = wins + wins.T
    win_totals = wins.sum(axis=1) + _PRIOR / 2
    gamma = np.ones(len(wins))
    for _ in range(_MOST_STEPS):
        previous = gamma
        expected = (games / (gamma[:, None] + gamma[None, :])).sum(axis=1) + _PRIOR / (gamma + 1)
        gamma = win_totals / expected
        if np.abs(np.log(gamma / previous)).max(initial=0.0) < 1e-12:
            break
    points: Numbers = _ELO * np.log10(gamma)
    return points


def _cycles(players: list[str], wins: set[tuple[str, str]]) -> tuple[tuple[str, str, str], ...]:
    cycles = []
    for a, b, c in combinations(players, 3):
        if (a, b) in wins and (b, c) in wins and (c, a) in wins:
            cycles.append((a, b, c))
        elif (a, c) in wins and (c, b) in wins and (b, a) in wins:
            cycles.append((a, c, b))
    return tuple(cycles)


_WIDEST = 30  # players of a matrix in a terminal
_MOST_CYCLES = 20
_SHOWN_DIGITS = 4
_HEAD = ("rank", "player", "share", "95% interval", "strength", "opponents", "remark")


def _rows(manifest: Manifest, ranking: Ranking) -> list[tuple[str, ...]]:
    losses = {player.name: player.lost for player in manifest.players}
    return [
        (
            s.rank,
            harmless_text(s.player),
            f"{100 * s.share:.1f}%",
            f"{100 * s.low:.1f} to {100 * s.high:.1f}%",
            f"{round(s.strength):+d}",
            str(s.pairings),
            "does not play: " + harmless_text(losses[s.player]) if losses[s.player] else "",
        )
        for s in ranking.standings
    ]


def tournament_lines(records: RunRecords) -> list[str]:
    ranking = ranking_of(records)
    lines = align([_HEAD, *_rows(records.manifest, ranking)], right=(0, *range(2, len(_HEAD) - 1)))
    names = [s.player for s in ranking.standings]
    if len(names) <= _WIDEST:
        numbers = [str(n) for n in range(1, len(names) + 1)]
        rows = [("%", "", *numbers)]
        for number, name in zip(numbers, names, strict=True):
            pairings = (ranking.pairings.get((name, opponent)) for opponent in names)
            cells = ("·" if p is None else f"{100 * p.share:.0f}" for p in pairings)
            rows.append((number, harmless_text(name), *cells))
        lines += [
            "",
            "The row's share of the points against the column:",
            *align(rows, right=(0, *range(2, len(rows[0])))),
        ]
    for cycle in ranking.cycles[:_MOST_CYCLES]:
        lines.append(_cycle_text(cycle))
    if (excess := len(ranking.cycles) - _MOST_CYCLES) > 0:
        lines.append(f"and {excess:,} more cycles")
    return lines


def _cycle_text(cycle: Sequence[str]) -> str:
    return "Cycle: " + " beats ".join(harmless_text(name) for name in (*cycle, cycle[0]))


def tournament_parts(records: RunRecords) -> list[str]:
    ranking = ranking_of(records)
    names = [s.player for s in ranking.standings]
    parts = [table_section("Ranking", _HEAD, _rows(records.manifest, ranking))]
    rows: list[Sequence[Any]] = []
    for name in names:
        cells = [ranking.pairings.get((name, opponent)) for opponent in names]
        rows.append((name, *(p and shade(p.share, f"{100 * p.share:.0f}") for p in cells)))
    intro = "The row's share of the points against the column, in percent."
    parts.append(table_section("Pairs", ("", *names), rows, intro))
    if ranking.cycles:
        rows = [(_cycle_text(cycle).partition(" ")[2],) for cycle in ranking.cycles]
        parts.append(table_section("Cycles", ["each beats the next beyond doubt"], rows))
    rows = []
    for run in records.finished:
        if run.start == 0:
            seats = run.cell.settings
            points = ", ".join(f"{seats[t]} ({t}) {n:,g}" for t, n in run.result.points.items())
            command = as_code(records.manifest.command(run.cell, 0))
            rows.append((run.cell.program_name, points, command))
    intro = (
        "Each from the given start; runs.csv has all. Run the commands in this folder; "
        "replace play with replay record to keep a match in a file."
    )
    parts.append(table_section("Matches", ("match", "points", "to see it"), rows, intro))
    return parts


def tournament_tables(records: RunRecords) -> dict[str, ResultTable]:
    ranking = ranking_of(records)
    losses = {player.name: player.lost for player in records.manifest.players}
    names = [s.player for s in ranking.standings]
    standings: list[Row] = [
        (
            *(s.player, s.best, s.worst),
            *(round(n, _SHOWN_DIGITS) for n in (s.share, s.low, s.high)),
            *(round(s.strength, 1) + 0.0, s.pairings, losses[s.player]),
        )
        for s in ranking.standings
    ]
    head = ("player", "best_rank", "worst_rank", "share", "low", "high", "strength", "opponents")
    pairs = [
        (name, opponent, *(round(n, _SHOWN_DIGITS) for n in ranking.pairings[name, opponent]))
        for name in names
        for opponent in names
        if (name, opponent) in ranking.pairings
    ]
    return {
        "ranking": ResultTable((*head, "remark"), standings),
        "pairs": ResultTable(("player", "opponent", "share", "low", "high"), list(pairs)),
        "cycles": ResultTable(("beats_second", "beats_third", "beats_first"), list(ranking.cycles)),
    }
