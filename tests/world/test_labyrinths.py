"""Rooms and labyrinths, and those of the day."""

from dataclasses import replace
from datetime import date, timedelta
from zlib import crc32

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.cli.play import SIZES
from logical_robots_tui.editing.checks import check
from logical_robots_tui.editing.strokes import Regions
from logical_robots_tui.world import LevelError, load_level
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.labyrinths import DAILY_SIZES, Daily, empty_room, labyrinth
from logical_robots_tui.world.levels.native import coarsest_cell
from tests.editing.making import sketch

PLACES = st.tuples(st.integers(1, 9), st.integers(1, 9)).filter(lambda size: size != (1, 1))


@settings(deadline=None)
@given(
    PLACES, st.integers(0, 99), st.floats(0, 1), st.sampled_from([20, 45, 60]), st.integers(1, 20)
)
def test_in_a_labyrinth_every_place_can_be_reached(
    places: tuple[int, int], seed: int, loops: float, corridor: int, wall: int
) -> None:
    columns, rows = places
    level = labyrinth(columns, rows, seed=seed, loops=loops, corridor=corridor, wall=wall)
    assert level.width == columns * (corridor + wall) + wall
    assert level.height == rows * (corridor + wall) + wall
    regions = Regions(~level.walls, corners=False)
    step, middle = corridor + wall, wall + corridor // 2
    found = {
        regions.region_at(middle + row * step, middle + column * step)
        for row in range(rows)
        for column in range(columns)
    }
    assert len(found) == 1
    assert -1 not in found
    assert check(level) == []


def test_without_loops_there_is_one_way_and_with_all_no_wall_between_places_is_left() -> None:
    for seed in range(5):
        level = labyrinth(6, 5, seed=seed, loops=0, corridor=20, wall=1)
        # Each place is 400 units, each opening 20; a tree has one opening less than places.
        assert (~level.walls).sum() == 30 * 400 + 29 * 20
    level = labyrinth(3, 2, loops=1, corridor=20, wall=1)
    assert (~level.walls).sum() == 6 * 400 + 7 * 20


def test_a_seed_gives_the_same_labyrinth_for_ever() -> None:
    level = labyrinth(4, 3, seed=1, loops=0, corridor=20, wall=20)
    assert coarsest_cell(level.walls) == 20
    assert [row[10::20] for row in sketch(level)[10::20]] == EXPECTED


EXPECTED = [
    "#########",
    "#...#...#",
    "###.#.#.#",
    "#...#.#.#",
    "#.###.#.#",
    "#.....#.#",
    "#########",
]


def test_the_goal_is_where_the_way_is_longest() -> None:
    level = labyrinth(7, 1, corridor=40)
    assert (level.areas[0].x, level.robots[0].x) == (6 * 50 + 30, 30)


def test_a_room_of_any_size_is_empty_inside_its_rim() -> None:
    level = empty_room(300, 200, wall=7)
    assert not level.walls[7:-7, 7:-7].any()
    assert (~level.walls).sum() == 286 * 186
    assert check(level) == check(empty_room(40, 40)) == []
    assert empty_room(4000, 4000).width == 4000
    with pytest.raises(LevelError, match="does not fit between"):
        empty_room(39, 60)


@given(st.dates(), st.sampled_from(DAILY_SIZES), st.integers(1, 99))
def test_a_name_tells_everything(day: date, size: str, number: int) -> None:
    made = next(Daily(day, known, number) for known in DAILY_SIZES if known == size)
    assert Daily.parse(made.name) == made


def test_other_names_are_names_of_no_level() -> None:
    days = ("2026-13-01-small", "2026-02-29-small", "2026-11-22-huge", "2026-11-22", "")
    for day in (*days, "2026-11-22-small-1", "2026-11-22-small-0"):
        assert Daily.parse(f"daily-{day}") is None
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
    days = (date(2026, 11, 1) + timedelta(days) for days in range(100))
    walls = [load_level(f"daily-{day.isoformat()}-{size}").walls.tobytes() for day in days]
    assert len(set(walls)) > 95
