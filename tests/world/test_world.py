"""The world from tick to tick, also while its level is changed."""

import copy
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Beacon, Level, Robot, World
from logical_robots_tui.world.level import Cycle
from logical_robots_tui.world.world import change_state, former_names, start_state
from tests.world.making import NAMES, levels, make_level

AHEAD = Desire(1, 1)
ANN = Robot("Ann", 50.5, 50.5)
BOB = Robot("Bob", 150.5, 50.5)

engines = st.one_of(
    st.floats(-2, 2), st.floats(), st.sampled_from((1.0, -1.0, 0.0, math.nan, math.inf))
)
desires = st.dictionaries(st.sampled_from(NAMES), st.builds(Desire, engines, engines))


def known(wanted: dict[str, Desire], level: Level) -> dict[str, Desire]:
    names = {robot.name for robot in level.robots}
    return {name: desire for name, desire in wanted.items() if name in names}


@settings(deadline=None)
@given(levels(), st.lists(desires, min_size=1, max_size=8), st.data())
def test_a_restored_world_has_the_same_future(
    level: Level, plan: list[dict[str, Desire]], data: st.DataObject
) -> None:
    plan = [known(wanted, level) for wanted in plan]
    world = World(level)
    states, rows = [world.save()], []
    for wanted in plan:
        rows.append(copy.deepcopy(world.sense()))
        world.act(wanted)
        states.append(world.save())

    start = data.draw(st.integers(0, len(plan)))
    world.restore(states[start])
    assert world.save() == states[start]
    for tick in range(start, len(plan)):
        assert world.sense() == rows[tick]
        world.act(plan[tick])
        assert world.save() == states[tick + 1]

    # A world that never saw the past goes on in the same way.
    other = World(level)
    other.restore(states[start])
    for tick in range(start, len(plan)):
        other.act(plan[tick])
    assert other.save() == states[-1]


@settings(deadline=None)
@given(levels(), st.lists(desires, min_size=1, max_size=8))
def test_no_desire_poisons_the_state(level: Level, plan: list[dict[str, Desire]]) -> None:
    world = World(level)
    for wanted in plan:
        world.act(known(wanted, level))
    for robot in world.robots:
        for value in (robot.x, robot.y, robot.angle, robot.battery_level):
            assert type(value) is float
            assert math.isfinite(value)
        assert -1 <= robot.left_engine <= 1
        assert -1 <= robot.right_engine <= 1
        assert type(robot.blocked) is type(robot.dead) is bool
    for area in world.areas:
        assert type(area.active) is bool


def test_a_world_starts_at_tick_0_with_nobody_visiting() -> None:
    world = World(make_level([ANN], areas=[Area("home", 50, 50, 20, victory_robots=("Ann",))]))
    assert (world.tick, world.won, world.won_at) == (0, False, None)
    assert world.areas[0].active
    assert world.areas[0].visitors == ()


def test_sensing_begins_a_tick_that_is_not_saved_and_looking_shows_the_present_clock() -> None:
    world = World(make_level())
    before = world.save()
    assert world.look()[0]["sensor"]["clock"] == world.tick == 0
    rows = copy.deepcopy(world.sense())
    assert world.sense() == world.look() == rows
    assert rows[0]["sensor"]["clock"] == world.tick == 1
    assert world.save() == before
    world.restore(world.save())
    assert (world.tick, world.sense()) == (0, rows)
    world.act({"Ann": AHEAD})
    assert world.look()[0]["sensor"]["clock"] == world.tick == 1


def test_acting_senses_by_itself_and_takes_nothing_from_the_rows() -> None:
    area = Area("gate", 200, 50, 10, on_beacon="lamp")
    level = make_level([ANN], beacons=[Beacon("lamp", 80, 50)], areas=[area])
    sensing, blind = World(level), World(level)
    sensing.sense()[0]["sensor"]["radar"].clear()
    sensing.act({"Ann": AHEAD})
    blind.act({"Ann": AHEAD})
    assert blind.save() == sensing.save()
    assert blind.areas[0].active


def powered(capacity: float, rate: float = 0.0) -> World:
    robot = replace(ANN, has_battery=True, battery_capacity=capacity, battery_consumption_rate=rate)
    return World(make_level([robot]))


def test_a_robot_drives_on_or_turns_to_its_right_and_without_a_desire_stands_still() -> None:
    world = World(make_level([ANN, BOB]))
    world.act({"Ann": AHEAD})
    ann, bob = world.robots
    assert (ann.x, ann.y, ann.left_engine, ann.right_engine) == (51.5, 50.5, 1.0, 1.0)
    assert (bob.x, bob.y, bob.left_engine, bob.right_engine) == (150.5, 50.5, 0.0, 0.0)
    world = World(make_level())
    world.act({"Ann": Desire(1, 0)})
    assert world.robots[0].angle == pytest.approx(1 / 20)
    assert world.robots[0].y > 50.5


@pytest.mark.parametrize("engine", [math.nan, math.inf, -math.inf, None, "1", 10**400])
def test_an_engine_whose_power_is_not_a_finite_number_stands_still(engine: Any) -> None:
    world = powered(10)
    world.act({"Ann": Desire(engine, 1)})
    assert (world.robots[0].left_engine, world.robots[0].right_engine) == (0.0, 1.0)
    assert world.robots[0].battery_level == 10


def test_numbers_of_numpy_drive_like_plain_ones_and_stay_out_of_the_state() -> None:
    world = World(make_level())
    world.act({"Ann": Desire(np.float32(0.5), np.float64(0.5))})  # type: ignore[arg-type] # on purpose
    robot = world.robots[0]
    assert robot.x == 51.0
    assert type(robot.x) is type(robot.left_engine) is float


def test_driving_clamps_a_desire_but_the_battery_pays_for_all_of_it_unless_it_is_free() -> None:
    world = powered(10, 0.5)
    world.act({"Ann": Desire(4, 4)})
    assert (world.robots[0].x, world.robots[0].battery_level) == (51.5, 8)
    free = powered(10)
    free.act({"Ann": Desire(1e308, 1e308)})
    assert free.robots[0].battery_level == 10


def test_a_wall_blocks_a_move_but_not_the_turn() -> None:
    world = World(make_level(walls=[(51, 50)]))
    world.act({"Ann": Desire(1, 0.9)})
    robot = world.robots[0]
    assert robot.blocked
    assert (robot.x, robot.y) == (50.5, 50.5)
    assert robot.angle == pytest.approx(0.005)
    world.act({"Ann": Desire(-1, -1)})
    assert not world.robots[0].blocked
    world = World(make_level(walls=[(50, 50)]))
    world.act({"Ann": Desire(1, -1)})
    assert not world.robots[0].blocked, "who only turns inside a wall"


def test_a_robot_with_an_empty_battery_is_dead_from_the_tick_that_empties_it() -> None:
    world = powered(1.5, 1)
    for is_dead in (False, True):
        world.act({"Ann": AHEAD})
        assert world.robots[0].dead == is_dead
    assert (world.robots[0].x, world.robots[0].left_engine) == (51.5, 0.0)


def test_victory_stays_once_it_is_reached() -> None:
    world = World(make_level([ANN], areas=[Area("home", 53, 50.5, 2, victory_robots=("Ann",))]))
    for _ in range(10):
        world.act({"Ann": AHEAD})
    assert world.won
    assert (world.won_at, world.areas[0].visitors) == (1, ())


def test_a_desire_for_a_robot_that_is_not_there_is_refused_and_changes_nothing() -> None:
    world = World(make_level([ANN, BOB]))
    with pytest.raises(ValueError, match=r'no robot "Anne"\. Did you mean "Ann"\?'):
        world.act({"Bob": AHEAD, "Anne": AHEAD})
    assert (world.tick, world.robots[1].x) == (0, 150.5)


def test_a_state_of_another_level_and_two_robots_of_one_name_are_refused() -> None:
    world = World(make_level([ANN]))
    for other in (make_level([ANN, BOB]), make_level([ANN], areas=[Area("home", 1, 1, 1)])):
        with pytest.raises(ValueError, match="another level"):
            world.restore(World(other).save())
    with pytest.raises(ValueError, match="different names"):
        World(make_level([ANN, ANN]))


def face_to_face(*, solid: bool = True) -> Level:
    level = make_level((Robot("Ann", 30.5, 50.5), Robot("Bob", 70.5, 50.5, angle=math.pi)))
    return replace(level, solid_robots=solid)


def drive(world: World, ticks: int, **powers: float) -> None:
    for _ in range(ticks):
        world.act({name: Desire(power, power) for name, power in powers.items()})


def gap(world: World) -> float:
    ann, bob = world.robots
    return bob.x - ann.x


def test_robots_that_meet_block_each_other_and_can_part() -> None:
    world = World(face_to_face())
    drive(world, 40, Ann=1, Bob=1)
    assert 16 <= gap(world) <= 18
    assert all(robot.blocked for robot in world.robots)
    drive(world, 10, Ann=-1, Bob=1)
    assert not any(robot.blocked for robot in world.robots)
    assert world.robots[0].x < 40
    free = World(face_to_face(solid=False))  # unless the level says otherwise
    drive(free, 40, Ann=1, Bob=1)
    assert gap(free) < -30
    assert not any(robot.blocked for robot in free.robots)


def test_the_order_of_the_robots_makes_no_difference() -> None:
    level = face_to_face()
    world, other = World(level), World(replace(level, robots=level.robots[::-1]))
    for each in (world, other):
        drive(each, 40, Ann=1, Bob=0.7)
    assert world.robots == other.robots[::-1]


def test_all_goals_are_to_be_reached_at_once_where_the_level_says_so() -> None:
    homes = [Area(n, x, 50, 9, victory_robots=(n,)) for n, x in (("Ann", 30), ("Bob", 60))]
    level = replace(face_to_face(), areas=tuple(homes))
    first, both = World(level), World(replace(level, all_goals=True))
    for world in (first, both):
        drive(world, 15, Bob=1)
    assert (first.won_at, both.won_at) == (1, 2)


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


def test_the_clock_switches_an_area_on_in_some_ticks_of_every_period() -> None:
    hours = replace(GATE, on_beacon="", sticky_switch=False, cycle=Cycle(5, 2, 3))
    of = level(areas=(hours, replace(hours, cycle=Cycle(5, 1, 4))))
    world, ticks = World(of), [start_state(of)]
    for _ in range(12):
        world.act({})
        ticks.append(world.save())
    first, second = ([s.tick for s in ticks if s.areas[i].active] for i in (0, 1))
    assert first == [2, 3, 7, 8, 12]
    assert second == [0, 1, 2, 3, 4, 6, 7, 8, 9, 11, 12]
    world.restore(ticks[3])
    world.act({})
    assert world.save() == ticks[4]
    other = level(areas=(replace(hours, cycle=Cycle(5, 5, 5)),))
    assert [change_state(s, of, other, {}).areas[0].active for s in ticks[4:7]] == [0, 1, 0]


def test_an_area_that_the_clock_makes_solid_pushes_robots_out_from_the_next_tick_on() -> None:
    gate = Area("Gate", 30.5, 32.5, 12, impenetrable=True, cycle=Cycle(4, 3, 4))
    world = World(level(areas=(gate,)))
    places = []
    for _ in range(4):
        world.act({})
        places.append(world.robots[0].y)
    assert places == [30.5, 30.5, 30.5, pytest.approx(32.5 - 12.1)]


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
