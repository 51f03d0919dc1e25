"""What a program keeps from tick to tick is what it keeps on DuckDB, tick by tick."""

from pathlib import Path

import pytest
from hypothesis import settings

from tests.mind.differential.closed_loop import PROGRAMS, differences

TICKS = min(40, 2 * settings().max_examples)


@pytest.mark.sampled
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_robot_remembers_and_decides_as_on_duckdb(name: str, tmp_path: Path) -> None:
    assert not list(differences(PROGRAMS[name], TICKS, tmp_path))


@pytest.mark.proof
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_robot_remembers_and_decides_1000_ticks_as_on_duckdb(name: str, tmp_path: Path) -> None:
    assert not list(differences(PROGRAMS[name], 1_000, tmp_path))
