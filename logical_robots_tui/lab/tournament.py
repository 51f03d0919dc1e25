"""Who is how good: shares of points, their intervals over starts, strengths, and cycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import msgspec
import numpy as np

from logical_robots_tui.errors import InputError
from logical_robots_tui.lab.exporting import (
    Done,
    Table,
    as_code,
    as_table,
    csv_of,
    done_runs,
    harmless_text,
    shade,
)
from logical_robots_tui.lab.folder import Cell, Folder, Ledger, Manifest, Player, digest
from logical_robots_tui.lab.submissions import Submission, entries_of, stems_of
from logical_robots_tui.lab.sweeping import Limit, Name, Positive, Starts, level_with_text
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.toml_files import TomlFile

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from logical_robots_tui.lab.folder import Ledger
    from logical_robots_tui.lab.running import Result
    from logical_robots_tui.world import Level

    Numbers: TypeAlias = NDArray[np.float64]


class TournamentTable(msgspec.Struct, frozen=True):
    """``[tournament]``; a match lasts as many ticks as the level says, or fewer."""

    level: Name
    title: str = ""
    starts: Starts = 20
    ticks: Positive | None = None
    format: Literal["all", "swiss"] | None = None


class Tournament(msgspec.Struct, frozen=True):
    tournament: TournamentTable
    limits: Limit = Limit()


SWISS_FROM = 40
"""The number of players from which on not everybody plays everybody."""

_MORE_ROUNDS = 2  # of a Swiss tournament than are needed to find its winner


def plan_tournament(file: Path, players: Path) -> tuple[Manifest, dict[str, str]]:
    """Return a tournament's first round, and the texts of level and programs by digest.

    `players` holds one program or folder per player. Raises TomlFileError, or InputError
    for fewer than two players.
    """
    spec = TomlFile(file)
    tournament = spec.read(Tournament)
    table, limits = tournament.tournament, tournament.limits
    level, text = _level(spec, table.level)
    ticks = min(table.ticks or level.match_ticks, level.match_ticks)
    inputs = {digest(text): text}
    named = sorted(entries_of(players, stems_of([level.name])).items())
    if len(named) < 2:
        raise InputError("there are fewer than two players", place=str(players), hint=_HINT)
    entered = [_player(name, entry, level, inputs) for name, entry in named]
    is_swiss = table.format == "swiss" or (not table.format and len(entered) >= SWISS_FROM)
    manifest = Manifest(
        "tournament",
        table.title or spec.file.stem,
        spec.text,
        table.starts,
        False,
        (),
        (),
        limits.steps,
        limits.seconds,
        (),
        players=tuple(entered),
        teams=tuple(team.name for team in level.teams),
        match=Cell(digest(text), "", level.name, "", ticks),
        most_rounds=_rounds(len(entered)) if is_swiss else 1,
    )
    pairs = tuple(combinations(range(len(entered)), 2))
    if is_swiss:
        pairs = pair_off(manifest, {}) or ()
    return _with_round(manifest, pairs), inputs


_HINT = "Each has a program such as ada.l, or a folder with one that is named like the level."


def _level(spec: TomlFile, name: str) -> tuple[Level, str]:
    """Return level and text; raises TomlFileError if it is no level for a match."""
    path = ("tournament", "level")
    try:
        level, text = level_with_text(name, spec.folder)
    except InputError as error:
        spec.problem(path, str(error))
    else:
        if len(level.teams) < 2:
            spec.problem(path, f"{level.name} has no teams that could play against each other")
        elif not level.scores:
            spec.problem(path, f"nothing gives points in {level.name}: it has no [[scores]]")
    spec.refuse()
    return level, text


def _player(name: str, entry: Submission, level: Level, inputs: dict[str, str]) -> Player:
    text = next(iter(entry.programs.values()), None)
    if text is None:
        return Player(name, "", "; ".join(entry.remarks))
    inputs[digest(text)] = text
    lost = ""
    try:
        Program.compile(text)
    except ProgramError as error:
        first = error.diagnostics[0]
        lost = f"line {first.line}: {first.message}"
    return Player(name, digest(text), lost)


def _with_round(manifest: Manifest, pairs: Sequence[tuple[int, int]]) -> Manifest:
    players, cells = manifest.players, list(manifest.cells)
    for pair in pairs:
        both = [players[index] for index in pair]
        if any(player.lost for player in both):
            continue
        for first in (0, 1):
            seated = [both[(seat + first) % 2] for seat in range(len(manifest.teams))]
            names = (player.name for player in seated)
            cells.append(
                msgspec.structs.replace(
                    manifest.match,
                    program_name=f"{seated[0].name} against {seated[1].name}",
                    settings=dict(zip(manifest.teams, names, strict=True)),
                    parts=tuple(player.program for player in seated),
                )
            )
    rounds = (*manifest.rounds, tuple(pairs))
    return msgspec.structs.replace(manifest, cells=tuple(cells), rounds=rounds)


def _rounds(players: int) -> int:
    return min(math.ceil(math.log2(players)) + _MORE_ROUNDS, players - 1 + players % 2)


def next_round(manifest: Manifest, ledger: Ledger) -> Manifest | None:
    """Return the manifest with the next round; None if there is no other round.

    All matches of the manifest must have been played.
    """
    if len(manifest.rounds) >= manifest.most_rounds:
        return None
    shares = {s.player: s.share for s in ranking_of(manifest, ledger, resamples=1).standings}
    pairs = pair_off(manifest, shares)
    return None if pairs is None else _with_round(manifest, pairs)


def pair_off(manifest: Manifest, shares: Mapping[str, float]) -> tuple[tuple[int, int], ...] | None:
    """Return the next round's pairs, neighbours by standing that have not met, or None.

    If the number is odd, the last player that has always played sits out. Programs break ties,
    not names. `shares` are average shares by name; none in the first round.
    """
    players = manifest.players

    def standing(index: int) -> tuple[float, str, str]:
        player = players[index]
        return -shares.get(player.name, 0.5), player.program, player.name

    met = {frozenset(pair) for pairs in manifest.rounds for pair in pairs}
    ranked = sorted(range(len(players)), key=standing)
    if len(ranked) % 2 == 0:
        return _pair(ranked, met)
    for index in reversed(ranked):
        rests = any(all(index not in pair for pair in pairs) for pairs in manifest.rounds)
        if not rests and (found := _pair([i for i in ranked if i != index], met)) is not None:
            return found
    return None


def _pair(ranked: list[int], met: set[frozenset[int]]) -> tuple[tuple[int, int], ...] | None:
    """Pair each with the next one it has not met, leaving none over; None if impossible."""
    if not ranked:
        return ()
    first, *others = ranked
    for other in others:
        if frozenset((first, other)) not in met:
            rest = _pair([index for index in others if index != other], met)
            if rest is not None:
                return (min(first, other), max(first, other)), *rest
    return None


RESAMPLES = 1_000
"""Resamples of the starts for intervals."""

_SEED = 23
_PRIOR = 0.1  # of a pairing, drawn, against a player of strength 0
_ELO = 400  # points of strength for odds of ten to one
_DIGITS = 9  # beyond which sums depend on their order
_MOST_STEPS = 100_000


class Standing(NamedTuple):
    """A player's rank, share of the points and strength, with 95 % intervals.

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
    """A player's share of the points against another, with its 95 % interval."""

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


_WIDEST = 30  # players of a matrix in a terminal
_MOST_CYCLES = 20
_DIGITS = 4
_HEAD = ("rank", "player", "share", "95 % interval", "strength", "opponents", "remark")


def _rows(manifest: Manifest, ranking: Ranking) -> list[tuple[str, ...]]:
    lost = {player.name: player.lost for player in manifest.players}
    return [
        (
            each.rank,
            harmless_text(each.player),
            f"{100 * each.share:.1f} %",
            f"{100 * each.low:.1f} to {100 * each.high:.1f} %",
            f"{each.strength:+.0f}",
            str(each.pairings),
            "does not play: " + harmless_text(lost[each.player]) if lost[each.player] else "",
        )
        for each in ranking.standings
    ]


def tournament_lines(manifest: Manifest, ledger: Ledger) -> list[str]:
    ranking = ranking_of(manifest, ledger)
    lines = _align([_HEAD, *_rows(manifest, ranking)], left=(1, len(_HEAD) - 1))
    names = [each.player for each in ranking.standings]
    if len(names) <= _WIDEST:
        numbers = [str(n) for n in range(1, len(names) + 1)]
        rows = [("%", "", *numbers)]
        for number, name in zip(numbers, names, strict=True):
            pairings = (ranking.pairings.get((name, other)) for other in names)
            cells = ("·" if each is None else f"{100 * each.share:.0f}" for each in pairings)
            rows.append((number, harmless_text(name), *cells))
        lines += ["", "The row's share of the points against the column:", *_align(rows, left=(1,))]
    for cycle in ranking.cycles[:_MOST_CYCLES]:
        lines.append(_cycle_text(cycle))
    if (more := len(ranking.cycles) - _MOST_CYCLES) > 0:
        lines.append(f"and {more:,} more cycles")
    return lines


def _cycle_text(cycle: Sequence[str]) -> str:
    return "Cycle: " + " beats ".join(harmless_text(name) for name in (*cycle, cycle[0]))


def _align(rows: Sequence[Sequence[str]], left: Sequence[int]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if n in left else cell.rjust(width)
            for n, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def tournament_parts(manifest: Manifest, ledger: Ledger, done: Sequence[Done]) -> list[str]:
    ranking = ranking_of(manifest, ledger)
    names = [each.player for each in ranking.standings]
    parts = ["<h2>Ranking</h2>" + as_table(_HEAD, _rows(manifest, ranking))]
    rows: list[Sequence[Any]] = []
    for name in names:
        cells = [ranking.pairings.get((name, other)) for other in names]
        rows.append((name, *(p and shade(p.share, f"{100 * p.share:.0f}") for p in cells)))
    said = "<p>The row's share of the points against the column, in percent.</p>"
    parts.append("<h2>Pairs</h2>" + said + as_table(("", *names), rows))
    if ranking.cycles:
        rows = [(_cycle_text(cycle).partition(" ")[2],) for cycle in ranking.cycles]
        parts.append(f"<h2>Cycles</h2>{as_table(('each beats the next beyond doubt',), rows)}")
    rows = []
    for each in done:
        if each.start == 0:
            at = each.cell.settings
            points = ", ".join(f"{at[t]} ({t}) {n:,g}" for t, n in each.result.points.items())
            rows.append((each.cell.program_name, points, as_code(each.replay)))
    said = (
        "<p>Each from the given start; runs.csv has all. The commands are typed in this folder; "
        "replay record instead of play keeps a match in a file.</p>"
    )
    parts.append("<h2>Matches</h2>" + said + as_table(("match", "points", "to see it"), rows))
    return parts


def export_tournament(folder: Folder, manifest: Manifest, ledger: Ledger) -> list[str]:
    """Write ranking and pairs as CSV; return the names of the files, or raise InputError."""
    ranking = ranking_of(manifest, ledger)
    lost = {player.name: player.lost for player in manifest.players}
    names = [each.player for each in ranking.standings]
    standings = [
        (
            each.player,
            each.best,
            each.worst,
            *(round(n, _DIGITS) for n in (each.share, each.low, each.high)),
            round(each.strength, 1),
            each.pairings,
            lost[each.player],
        )
        for each in ranking.standings
    ]
    head = ("player", "best_rank", "worst_rank", "share", "low", "high", "strength", "opponents")
    pairs = [
        (name, other, *(round(n, _DIGITS) for n in ranking.pairings[name, other]))
        for name in names
        for other in names
        if (name, other) in ranking.pairings
    ]
    tables = {
        "ranking": Table((*head, "remark"), list(standings)),
        "pairs": Table(("player", "opponent", "share", "low", "high"), list(pairs)),
        "cycles": Table(("beats_second", "beats_third", "beats_first"), list(ranking.cycles)),
    }
    for name, table in tables.items():
        folder.put(folder.path / f"{name}.csv", csv_of(table))
    return [f"{name}.csv" for name in tables]
