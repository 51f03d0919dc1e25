"""Who is how good: shares of points, their intervals over starts, strengths, and cycles."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from logical_robots_tui.lab.exporting import done_runs
from logical_robots_tui.lab.folder import Ledger, Manifest
from logical_robots_tui.lab.running import Result

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


def share_of_points(own: float, other: float) -> float:
    """Return the share of the points, from 0 to 1; one half if both have none.

    If points are below 0, the lower of the two counts as 0 and the other from there.
    """
    low = min(0.0, own, other)
    own, other = own - low, other - low
    return own / (own + other) if own + other else 0.5


def share_of_match(result: Result, seats: Mapping[str, str], player: str) -> float:
    lost = {seats[team] for team in result.forfeit}
    if lost:
        return 0.5 if len(lost) > 1 else float(player not in lost)
    own = sum(points for team, points in result.points.items() if seats[team] == player)
    other = sum(points for team, points in result.points.items() if seats[team] != player)
    return share_of_points(own, other)


def ranking_of(manifest: Manifest, ledger: Ledger, *, resamples: int = RESAMPLES) -> Ranking:
    """Return the ranking by all matches that were played from all seats."""
    players = manifest.players
    pairs = [pair for pairs in manifest.rounds for pair in pairs]
    names = [player.name for player in players]
    number = {(names[i], names[j]): n for n, (i, j) in enumerate(pairs)}
    shares = np.full((2, len(pairs), manifest.starts + 1), np.nan)
    for n, pair in enumerate(pairs):
        lost = [bool(players[index].lost) for index in pair]
        if any(lost):
            shares[:, n] = 0.5 if all(lost) else float(lost[1])
    for done in done_runs(manifest, ledger):
        seats = {team: str(name) for team, name in done.cell.settings.items()}
        first, second, *_ = seats.values()
        turned = (first, second) not in number
        both = (second, first) if turned else (first, second)
        share = share_of_match(done.result, seats, both[0])
        shares[int(turned), number[both], done.start] = share
    return ranking_of_shares(names, pairs, shares.mean(axis=0), resamples=resamples)


def ranking_of_shares(
    players: list[str], pairs: list[tuple[int, int]], shares: Numbers, *, resamples: int = RESAMPLES
) -> Ranking:
    """Return the ranking; `shares` are the first player's, pairs x starts, NaN where missing."""
    known = ~np.isnan(shares)
    kept = [bool(row.any()) for row in known]
    pairs = [pair for pair, keep in zip(pairs, kept, strict=True) if keep]
    shares, known = shares[kept], known[kept]
    starts = shares.shape[1]
    chance = np.random.default_rng(_SEED)
    weights = chance.multinomial(starts, [1 / starts] * starts, size=resamples).astype(float)
    means = _means(np.ones((1, starts)), shares, known)
    tried = _means(weights, shares, known)
    tried = np.where(np.isnan(tried), means, tried)
    low, high = (np.round(each, _DIGITS) for each in _interval(tried))
    (mean,) = np.round(means, _DIGITS)
    found: dict[tuple[str, str], Pairing] = {}
    for (i, j), *pairing in zip(pairs, mean.tolist(), low.tolist(), high.tolist(), strict=True):
        share, least, most = pairing
        found[players[i], players[j]] = Pairing(share, least, most)
        found[players[j], players[i]] = Pairing(1 - share, 1 - most, 1 - least)
    standings = _standings(players, pairs, mean, tried)
    beaten = {both for both, pairing in found.items() if pairing.low > 1 / 2}
    return Ranking(standings, found, _cycles([each.player for each in standings], beaten))


def _means(weights: Numbers, shares: Numbers, known: NDArray[np.bool_]) -> Numbers:
    """Return the mean share of each pair over weighted starts: resamples x pairs."""
    # Not as a product of matrices, whose sums depend on the machine.
    totals = np.einsum("bs,ms->bm", weights, np.where(known, shares, 0.0))
    with np.errstate(invalid="ignore"):
        means: Numbers = totals / np.einsum("bs,ms->bm", weights, known.astype(float))
    return means


def _interval(tried: Numbers) -> Numbers:
    found: Numbers = np.quantile(tried, (0.025, 0.975), axis=0)
    return found


def _standings(
    players: list[str], pairs: list[tuple[int, int]], mean: Numbers, tried: Numbers
) -> tuple[Standing, ...]:
    wins = np.zeros((len(players), len(players)))
    ends: list[tuple[float, float]] = []
    for n, (i, j) in enumerate(pairs):
        wins[i, j], wins[j, i] = mean[n], 1 - mean[n]
    for index in range(len(players)):
        own = [tried[:, n] for n, (i, _) in enumerate(pairs) if i == index]
        own += [1 - tried[:, n] for n, (_, j) in enumerate(pairs) if j == index]
        low, high = _interval(np.mean(own, axis=0)) if own else (0.0, 1.0)
        ends.append((round(float(low), _DIGITS), round(float(high), _DIGITS)))
    games = wins + wins.T > 0
    strength = strengths(wins)
    found = []
    for index, name in enumerate(players):
        low, high = ends[index]
        count = int(games[index].sum())
        share = round(float(wins[index].sum()) / count, _DIGITS) if count else 0.5
        best = 1 + sum(other > high for other, _ in ends)
        worst = len(players) - sum(other < low for _, other in ends)
        rated = round(float(strength[index]), 3)
        found.append(Standing(name, best, worst, share, low, high, rated, count))
    return tuple(sorted(found, key=lambda each: (-each.share, each.player)))


def strengths(wins: Numbers) -> Numbers:
    """Return maximum-likelihood strengths; 0 points is average, 400 more odds of ten to one.

    By the MM algorithm for the Bradley-Terry model (Hunter, "MM algorithms for generalized
    Bradley-Terry models", 2004). A tenth of a drawn pairing against an average player is added,
    so that losing everything has a strength. `wins`, players x players, are the row's shares
    against the column's; both sides of a pairing add up to 1, or are 0 if they have not met.
    """
    games = wins + wins.T
    won = wins.sum(axis=1) + _PRIOR / 2
    now = np.ones(len(wins))
    for _ in range(_MOST_STEPS):
        before = now
        expected = (games / (now[:, None] + now[None, :])).sum(axis=1) + _PRIOR / (now + 1)
        now = won / expected
        if np.abs(np.log(now / before)).max(initial=0.0) < 1e-12:
            break
    found: Numbers = _ELO * np.log10(now)
    return found


def _cycles(ranked: list[str], beaten: set[tuple[str, str]]) -> tuple[tuple[str, str, str], ...]:
    found = []
    for a, b, c in combinations(ranked, 3):
        if (a, b) in beaten and (b, c) in beaten and (c, a) in beaten:
            found.append((a, b, c))
        elif (a, c) in beaten and (c, b) in beaten and (b, a) in beaten:
            found.append((a, c, b))
    return tuple(found)
