"""Rankings from shares alone: who is how good, and how sure that is."""

import random
from itertools import combinations

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from logical_robots_tui.lab.competing import pair_off
from logical_robots_tui.lab.folder import Manifest, TournamentPlayer
from logical_robots_tui.lab.ranking import (
    Ranking,
    Standing,
    _rows,
    ranking_of_shares,
    share_of_match,
    share_of_points,
    strengths,
)
from logical_robots_tui.lab.tasks import Result

NAMES = ["ada", "ben", "cem", "dot", "eve"]
PAIRS = list(combinations(range(5), 2))


def some_shares(seed: int = 1, starts: int = 21) -> NDArray[np.float64]:
    """Shares of five players, of which the first is best and the last two are alike."""
    chance = np.random.default_rng(seed)
    skill = np.array([3.0, 2.0, 1.0, 0.5, 0.5])
    odds = np.array([[skill[i] / (skill[i] + skill[j])] for i, j in PAIRS])
    return np.clip(odds + chance.normal(0, 0.1, (len(PAIRS), starts)), 0, 1)


@pytest.mark.parametrize(
    ("own", "other", "share"),
    [(3, 1, 0.75), (0, 0, 0.5), (0, 2, 0), (-2, 3, 0), (-2, -5, 1), (-2, -2, 0.5), (1, -1, 1)],
)
def test_a_share_is_0_to_1_and_both_are_1_together(own: float, other: float, share: float) -> None:
    assert share_of_points(own, other) == share
    assert share_of_points(other, own) == 1 - share


def test_a_player_has_the_points_of_all_of_its_teams() -> None:
    seats = {"red": "ada", "green": "ben", "blue": "ada", "gold": "ben"}
    result = Result("played", points={"red": 3, "green": 1, "blue": 2, "gold": 4})
    assert share_of_match(result, seats, "ada") == 0.5
    failed = Result("played", points={"red": 3}, forfeit=("blue",))
    assert (share_of_match(failed, seats, "ada"), share_of_match(failed, seats, "ben")) == (0, 1)
    both = Result("played", forfeit=("blue", "gold"))
    assert share_of_match(both, seats, "ada") == share_of_match(both, seats, "ben") == 0.5


def test_strengths_are_those_that_the_shares_were_made_with() -> None:
    rating = np.array([120.0, 40.0, 0.0, -60.0, -100.0])
    odds = 10 ** (rating / 400)
    wins = odds[:, None] / (odds[:, None] + odds[None, :])
    np.fill_diagonal(wins, 0)
    assert strengths(wins) == pytest.approx(rating, abs=4)
    assert strengths(np.array([[0, 0.75], [0.25, 0]])) == pytest.approx([90, -90], abs=6)
    # Who lost everything has a strength, too, and not an endless one.
    clear = strengths(np.triu(np.ones((4, 4)), 1))
    assert np.isfinite(clear).all()
    assert (np.diff(clear) < -100).all()
    assert strengths(np.zeros((2, 2))) == pytest.approx([0, 0])
    # A strength of nothing has no sign of minus.
    standing = Standing("ada", 1, 1, 0.5, 0.5, 0.5, -0.04, 1)
    players = (TournamentPlayer("ada"),)
    manifest = Manifest("tournament", "", "", 1, False, (), (), 1, 1.0, (), players=players)
    (row,) = _rows(manifest, Ranking((standing,), {}, ()))
    assert row[4] == "+0"


def test_the_better_one_is_first_and_equal_ones_share_their_ranks() -> None:
    ranking = ranking_of_shares(NAMES, PAIRS, some_shares())
    assert [standing.player for standing in ranking.standings[:3]] == ["ada", "ben", "cem"]
    assert [standing.rank for standing in ranking.standings] == ["1", "2", "3", "4-5", "4-5"]
    assert all(standing.low <= standing.share <= standing.high for standing in ranking.standings)
    assert ranking.pairings["ada", "ben"].share == 1 - ranking.pairings["ben", "ada"].share
    assert ranking == ranking_of_shares(NAMES, PAIRS, some_shares()), "the same each time"


@pytest.mark.slow
def test_an_interval_holds_what_was_so_in_19_of_20_tournaments() -> None:
    true = np.mean([3 / (3 + other) for other in (2, 1, 0.5, 0.5)])
    inside = 0
    for seed in range(100):
        first = ranking_of_shares(NAMES, PAIRS, some_shares(seed), resamples=400).standings[0]
        inside += int(first.low <= true <= first.high)
    assert 85 <= inside <= 99


@pytest.mark.parametrize("seed", range(5))
def test_the_order_in_which_players_are_named_changes_nothing(seed: int) -> None:
    shares = some_shares()
    ranking = ranking_of_shares(NAMES, PAIRS, shares)
    order = random.Random(seed).sample(range(5), 5)
    pairs, rows = [], []
    for i, j in combinations(range(5), 2):
        a, b = order[i], order[j]
        row = shares[PAIRS.index((min(a, b), max(a, b)))]
        pairs.append((i, j))
        rows.append(row if a < b else 1 - row)
    again = ranking_of_shares([NAMES[n] for n in order], pairs, np.array(rows))
    assert (again.standings, again.cycles) == (ranking.standings, ranking.cycles)


def test_rock_paper_and_scissors_are_a_cycle() -> None:
    names = ["rock", "paper", "scissors", "nobody"]
    pairs = list(combinations(range(4), 2))
    won = {("paper", "rock"), ("rock", "scissors"), ("scissors", "paper")}
    won |= {(name, "nobody") for name in names[:3]}
    shares = np.array([[float((names[i], names[j]) in won)] * 3 for i, j in pairs])
    ranking = ranking_of_shares(names, pairs, shares)
    assert ranking.cycles == (("paper", "rock", "scissors"),)
    assert [standing.rank for standing in ranking.standings] == ["1-3", "1-3", "1-3", "4"]
    assert ranking_of_shares(names, pairs, np.full_like(shares, 0.5)).cycles == ()


def test_matches_that_are_missing_are_left_out() -> None:
    shares = some_shares()
    shares[0, 3] = np.nan
    shares[1] = np.nan
    ranking = ranking_of_shares(NAMES, PAIRS, shares)
    played = {standing.player: standing.pairings for standing in ranking.standings}
    assert played == {"ada": 3, "ben": 4, "cem": 3, "dot": 4, "eve": 4}
    assert ("ada", "cem") not in ranking.pairings
    assert ranking.pairings["ada", "ben"].share == pytest.approx(np.nanmean(shares[0]))
    # Before the first match nothing is known.
    ranking = ranking_of_shares(NAMES, PAIRS, np.full((len(PAIRS), 3), np.nan))
    assert [standing.rank for standing in ranking.standings] == ["1-5"] * 5
    assert not ranking.pairings


def test_looking_for_pairs_ends_where_one_player_has_met_all_others() -> None:
    players = tuple(TournamentPlayer(f"p{n:02}", str(n)) for n in range(40))
    rounds = (tuple((n, 39) for n in range(39)),)
    manifest = Manifest("tournament", "", "", 0, False, (), (), 1, 1, (), players=players)
    assert pair_off(msgspec.structs.replace(manifest, rounds=rounds), {}) is None


def rounds_of(count: int, rounds: int) -> list[tuple[tuple[int, int], ...]]:
    players = tuple(TournamentPlayer(f"p{n:02}", f"{n * 7919 % 1000:03}") for n in range(count))
    manifest = Manifest("tournament", "", "", 0, False, (), (), 1, 1, (), players=players)
    for _ in range(rounds):
        wins = {player.name: 0.0 for player in manifest.players}
        for pairs in manifest.rounds:
            for pair in pairs:
                wins[manifest.players[max(pair)].name] += 1 / len(manifest.rounds)
        pairs_ = pair_off(manifest, wins)
        if pairs_ is None:
            break
        manifest = msgspec.structs.replace(manifest, rounds=(*manifest.rounds, pairs_))
    return list(manifest.rounds)


@pytest.mark.parametrize(("count", "rounds"), [(40, 8), (41, 8), (100, 9), (2, 1), (3, 3)])
def test_nobody_meets_anybody_twice_in_a_swiss_tournament(count: int, rounds: int) -> None:
    found = rounds_of(count, rounds)
    assert len(found) == rounds
    pairs = [pair for meetings in found for pair in meetings]
    assert len(set(pairs)) == len(pairs) == rounds * (count // 2)
    rests = [(set(range(count)) - {n for pair in meetings for n in pair}) for meetings in found]
    assert [len(rest) for rest in rests] == [count % 2] * rounds
    assert len(set().union(*rests)) == rounds * (count % 2), "nobody rests twice"
    assert found == rounds_of(count, rounds)


def test_neighbours_by_standing_meet() -> None:
    *_, last = rounds_of(32, 5)
    assert (30, 31) in last or (29, 31) in last
    assert rounds_of(6, 9) == rounds_of(6, 5), "it ends when all have met"
