"""Whole programs decide and remember the same on both engines, moment after moment."""

from pathlib import Path

import pytest
from hypothesis import settings

from tests.mind.differential.whole_programs import MOMENTS, PLAYERS, PROGRAMS, differences

_TITLES = list(PROGRAMS)
_KEEPS = len({title.split(", ")[1] for title in _TITLES})
SOME = [
    title for number, title in enumerate(_TITLES) if number % _KEEPS == number // _KEEPS % _KEEPS
]
"""Every way to drive, and every way to keep a memory."""


def test_there_are_enough_of_them() -> None:
    assert len(PROGRAMS) >= 150
    assert len(MOMENTS) >= 5
    assert len({moment["level"] for moment in MOMENTS}) >= 3
    assert len(PLAYERS) >= 10
    for text in [*PROGRAMS.values(), *PLAYERS.values()]:
        assert 9 <= text.count("\n") <= 60
    assert {part for title in SOME for part in title.split(", ")} == {
        part for title in PROGRAMS for part in title.split(", ")
    }


ONE_LEVEL_OR_ALL = max(3, settings().max_examples // 4)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "title", [*SOME, *(pytest.param(t, marks=pytest.mark.proof) for t in PROGRAMS if t not in SOME)]
)
def test_a_program_means_the_same_as_on_duckdb(title: str, tmp_path: Path) -> None:
    assert not differences(PROGRAMS[title], tmp_path, ONE_LEVEL_OR_ALL)


@pytest.mark.sampled
@pytest.mark.parametrize("text", PLAYERS.values(), ids=PLAYERS)
def test_a_program_of_a_player_means_the_same(text: str, tmp_path: Path) -> None:
    assert not differences(text, tmp_path, ONE_LEVEL_OR_ALL)
