"""Which matches look the same from every seat."""

from dataclasses import replace

import pytest

from logical_robots_tui.game.measuring import start_of
from logical_robots_tui.world import Level, Sensors, load_level
from logical_robots_tui.world.symmetry import has_equal_seats

HIGH_GROUND = load_level("16-high-ground")


@pytest.mark.parametrize("start", [0, 1, 7])
def test_seats_are_equal_where_half_a_turn_exchanges_the_teams(start: int) -> None:
    assert has_equal_seats(start_of(HIGH_GROUND, start))
    assert has_equal_seats(load_level("18-low-voltage"))
    assert not has_equal_seats(load_level("01-first-steps"))


def test_seats_differ_where_names_tell_them_apart() -> None:
    assert not has_equal_seats(load_level("17-four-doors"))


def wall_more(level: Level) -> Level:
    walls = level.walls.copy()
    walls[15, 15] = True
    return replace(level, walls=walls)


CHANGED = {
    "a wall": wall_more(HIGH_GROUND),
    "a beacon": replace(HIGH_GROUND, beacons=HIGH_GROUND.beacons[:-1]),
    "noise": replace(HIGH_GROUND, sensors=Sensors(noise=1)),
    "a name": replace(
        HIGH_GROUND,
        robots=(replace(HIGH_GROUND.robots[0], name="Zoe"), *HIGH_GROUND.robots[1:]),
    ),
    "a heading": replace(
        HIGH_GROUND,
        robots=(replace(HIGH_GROUND.robots[0], angle=0.1), *HIGH_GROUND.robots[1:]),
    ),
    "an area": replace(
        HIGH_GROUND,
        areas=(*HIGH_GROUND.areas[:-1], replace(HIGH_GROUND.areas[-1], cycle=None)),
    ),
}


@pytest.mark.parametrize("change", CHANGED)
def test_any_difference_makes_seats_differ(change: str) -> None:
    assert not has_equal_seats(CHANGED[change])
