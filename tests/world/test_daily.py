"""The labyrinths of the day."""

from dataclasses import replace
from datetime import date, timedelta
from zlib import crc32

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.cli.play import SIZES
from logical_robots_tui.world import LevelError, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.labyrinths import DAILY_SIZES, Daily

DAYS = [date(2026, 11, 1) + timedelta(days) for days in range(100)]


@given(st.dates(), st.sampled_from(DAILY_SIZES), st.integers(1, 99))
def test_a_name_tells_everything(day: date, size: str, number: int) -> None:
    made = next(Daily(day, known, number) for known in DAILY_SIZES if known == size)
    assert Daily.named(made.name) == made


def test_other_names_are_names_of_no_level() -> None:
    days = ("2026-13-01-small", "2026-02-29-small", "2026-11-22-huge", "2026-11-22", "")
    for day in (*days, "2026-11-22-small-1", "2026-11-22-small-0"):
        assert Daily.named(f"daily-{day}") is None
        with pytest.raises(LevelError, match="There is no level called"):
            load_level(f"daily-{day}")


def test_everybody_gets_the_same_of_a_day_and_its_second_is_another_one() -> None:
    assert SIZES == DAILY_SIZES
    level = load_level("daily-2026-11-22-small")
    assert alike(level, load_level("daily-2026-11-22-small"))
    assert (level.width, level.height) == (570, 460)
    assert crc32(level.walls.tobytes()) == 2772251438  # on every machine, in every Python
    assert level.title == "Labyrinth of 2026-11-22, small"
    first, second = (load_level(f"daily-2026-11-22-large{more}") for more in ("", "-2"))
    assert not alike(replace(first, name=second.name, source=second.source), second)


@pytest.mark.parametrize("size", DAILY_SIZES)
def test_another_day_brings_another_labyrinth(size: str) -> None:
    walls = [load_level(f"daily-{day.isoformat()}-{size}").walls.tobytes() for day in DAYS]
    assert len(set(walls)) > 95
