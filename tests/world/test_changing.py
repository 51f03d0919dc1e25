"""A world whose level is changed while it runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Beacon, Level, Robot, World
from logical_robots_tui.world.world import change_state, former_names, start_state
from tests.world.making import make_level

ADA, BO = Robot("Ada", 30.5, 30.5), Robot("Bo", 60.5, 30.5, has_battery=True, battery_capacity=50)
GATE = Area("Gate", 90, 40, 12, on_beacon="Lamp", sticky_switch=True)


def level(*robots: Robot, areas: tuple[Area, ...] = (GATE,)) -> Level:
    beacons = (Beacon("Lamp", 45, 30),)
    return make_level(robots or (ADA, BO), width=120, height=80, beacons=beacons, areas=areas)


def later(of: Level, ticks: int = 5) -> World:
    world = World(of)
    for _ in range(ticks):
        world.act({"Ada": Desire(1, 0.5), "Bo": Desire(0.5, 1)})
    return world


def test_robots_stay_where_they_are_and_new_ones_stand_at_their_start() -> None:
    before, after = level(), level(ADA, BO, Robot("Cy", 10, 70, 1.0))
    state = later(before).save()
    changed = change_state(state, before, after, {})
    assert changed.robots == (*state.robots, start_state(after).robots[2])
    assert changed.tick == state.tick
    World(after).restore(changed)
    other = level(replace(ADA, x=11.0), replace(BO, battery_capacity=70.0))
    assert change_state(start_state(before), before, other, {}) == World(other).save()


def test_a_robot_is_put_where_one_says_and_areas_tell_at_once_who_is_in_them() -> None:
    before = level()
    state = later(before).save()
    changed = change_state(state, before, before, {"Ada": (90, 41, -1.0)})
    assert (changed.robots[0].x, changed.robots[0].y) == (90.0, 41.0)
    assert changed.robots[0].angle == pytest.approx(2 * math.pi - 1)
    assert changed.areas[0].visitors == ("Ada",)
    with pytest.raises(ValueError, match="Nobody"):
        change_state(state, before, before, {"Nobody": (1, 2, 3)})


def test_areas_stay_switched_unless_their_switches_change() -> None:
    before = level(replace(ADA, angle=0.0), replace(BO, angle=math.pi))
    state = later(before).save()
    assert state.areas[0].active
    moved = level(areas=(Area("New", 5, 5, 3), replace(GATE, x=20.0, radius=30.0)))
    assert change_state(state, before, moved, {}).areas[1].active
    other = level(areas=(replace(GATE, on_beacon="Nothing"),))
    assert not change_state(state, before, other, {}).areas[0].active


def test_a_renamed_robot_goes_on_and_batteries_hold_no_more_than_they_can() -> None:
    before = level()
    after = level(ADA, replace(BO, name="Bob", battery_capacity=20))
    assert former_names(before, after) == {"Ada": "Ada", "Bob": "Bo"}
    state = later(before).save()
    bob = change_state(state, before, after, {}).robots[1]
    assert bob == replace(state.robots[1], name="Bob", battery_level=20.0)


@settings(max_examples=30, deadline=None)
@given(
    st.integers(1, 500),
    st.integers(1, 500),
    st.lists(st.tuples(st.integers(0, 499), st.integers(0, 499), st.booleans()), max_size=3),
)
def test_what_is_made_from_a_world_with_other_walls_senses_the_same(
    width: int, height: int, strokes: list[tuple[int, int, bool]]
) -> None:
    walls = np.zeros((height, width), np.bool_)
    walls[height // 2, ::3] = True
    one = replace(make_level((ADA,), width=width, height=height), walls=walls)
    painted = walls.copy()
    for x, y, wall in strokes:
        painted[y : y + 20, x : x + 15] = wall
    other = replace(one, walls=painted)
    quick = World(other, like=World(one))
    plain = World(other)
    assert np.array_equal(quick._senses._walls._room, plain._senses._walls._room)
    assert quick.look() == plain.look()
