"""Histograms of victories: who has won how well, and where one's own victory is."""

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.player.standings import MEASURES, histograms, standing_rows
from logical_robots_tui.progress.board import BoardStanding

BINS = 21
NAMES = st.none() | st.text(max_size=5)
NUMBERS = st.integers(1, 10**6)
DISTANCES = st.floats(0, 1e9, allow_nan=False)


@st.composite
def standings(draw: st.DrawFn) -> list[BoardStanding]:
    rows = draw(st.lists(st.tuples(NAMES, NUMBERS, NUMBERS, DISTANCES), min_size=1, max_size=40))
    mine = draw(st.none() | st.integers(0, len(rows) - 1))
    return [
        BoardStanding(name, i == mine, ticks, size, distance)
        for i, (name, ticks, size, distance) in enumerate(rows)
    ]


@given(standings())
def test_each_player_is_in_one_bin_and_ones_own_rank_counts_the_better_ones(
    rows: list[BoardStanding],
) -> None:
    mine = next((row for row in rows if row.is_me), None)
    shown = list(histograms(rows, BINS))
    assert [histogram.measure for histogram in shown] == list(MEASURES)
    for histogram in shown:
        values = [getattr(row, histogram.measure) for row in rows]
        assert len(histogram.counts) == BINS
        assert histogram.players == len(rows)
        assert histogram.best == min(values)
        assert histogram.leader in {
            "anonymous" if row.name is None else row.name
            for row in rows
            if getattr(row, histogram.measure) == min(values)
        }
        if mine is None:
            assert (histogram.bin, histogram.rank) == (None, 0)
        else:
            own = getattr(mine, histogram.measure)
            assert histogram.bin is not None
            assert histogram.counts[histogram.bin]
            assert histogram.rank == 1 + sum(value < own for value in values)


def test_one_very_bad_victory_does_not_push_all_others_into_one_bin() -> None:
    rows = [BoardStanding(None, False, ticks, 1, 1.0) for ticks in range(100, 200)]
    rows.append(BoardStanding(None, True, 10**6, 1, 1.0))
    ticks = next(histograms(rows, BINS))
    assert all(ticks.counts)
    assert (ticks.bin, ticks.rank) == (BINS - 1, 101)


def test_without_victories_there_is_nothing() -> None:
    assert list(histograms([], BINS)) == []


def test_a_table_shares_ranks_of_equal_ticks() -> None:
    rows = [
        BoardStanding("Ada", False, 100, 20, 5.0),
        BoardStanding(None, True, 100, 30, 4.0),
        BoardStanding("Ben", False, 1_200, 10, 3_000.0),
    ]
    assert standing_rows(rows)[1:] == [
        ("", "1", "Ada", "100", "20", "5"),
        ("you", "1", "anonymous", "100", "30", "4"),
        ("", "3", "Ben", "1,200", "10", "3,000"),
    ]
