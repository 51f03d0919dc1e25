"""Charging where a source divides what it gives."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.values import Desire
from logical_robots_tui.world import Beacon, Level, Robot, World
from tests.world.making import levels, make_level

STATION = Beacon("Station", 50, 50, charging_station=True)


def robot(name: str, level: float = 100, *, x: float = 60, giver: bool = False) -> Robot:
    return Robot(
        *(name, x, 50.5),
        has_battery=True,
        can_charge=giver,
        battery_capacity=level,
        battery_consumption_rate=1.0,
    )


def room(*robots: Robot, station: bool = True, divided: bool = True) -> Level:
    level = make_level(robots, beacons=(STATION,) if station else ())
    return replace(level, divided_charge=divided)


def emptied(level: Level, **charges: float) -> World:
    world = World(level)
    state = world.save()
    robots = tuple(
        replace(each, battery_level=charges.get(each.name, each.battery_level))
        for each in state.robots
    )
    world.restore(replace(state, robots=robots))
    return world


def charges(world: World) -> dict[str, float]:
    return {robot.name: robot.battery_level for robot in world.robots}


@pytest.mark.parametrize(
    ("level", "before", "after"),
    [
        (room(robot("Ann"), robot("Bob")), (10, 20), (11, 21)),
        (room(robot("Ann"), robot("Bob"), divided=False), (10, 20), (12, 22)),
        (room(robot("Ann"), robot("Bob")), (10, 100), (12, 100)),
        (room(robot("Ann", giver=True), robot("Bob"), station=False), (1.5, 10), (0, 11.5)),
        (
            room(robot("Ann", giver=True), robot("Bob", giver=True), station=False),
            *((10, 20), (10, 20)),
        ),
    ],
    ids=["divided", "not divided", "who is full", "no more than it has", "each other"],
)
def test_what_is_given_is_divided_among_those_who_need_it(
    level: Level, before: tuple[float, float], after: tuple[float, float]
) -> None:
    for desires in ({}, {"Ann": Desire(1, 1)}):  # who is charged pays nothing for its engines
        world = emptied(level, Ann=before[0], Bob=before[1])
        world.act(desires)
        assert charges(world) == {"Ann": after[0], "Bob": after[1]}


def test_a_robot_gives_equal_shares_and_who_gets_none_pays_for_its_engines() -> None:
    level = room(robot("Ann", giver=True), robot("Bob"), robot("Cid"), station=False)
    world = emptied(level, Ann=1.5, Bob=10, Cid=20)
    world.act({})
    assert charges(world) == {"Ann": 0, "Bob": 10.75, "Cid": 20.75}
    world = emptied(room(robot("Ann"), robot("Bob", x=200)), Ann=10, Bob=10)
    world.act({"Ann": Desire(1, 1), "Bob": Desire(1, 0)})
    assert charges(world) == {"Ann": 12, "Bob": 9.5}


def test_a_robot_that_drives_away_is_charged_where_it_was() -> None:
    near = robot("Ann", x=99.5)
    for order in ((near, robot("Bob")), (robot("Bob"), near)):
        world = emptied(room(*order), Ann=10, Bob=10)
        world.act({"Ann": Desire(1, 1)})
        assert charges(world) == {"Ann": 11, "Bob": 11}


@settings(deadline=None)
@given(levels(), st.data())
def test_the_order_of_robots_makes_no_difference(level: Level, data: st.DataObject) -> None:
    level = replace(level, divided_charge=True)
    level = replace(
        level, robots=tuple(replace(r, x=10.5 + i, y=10.5) for i, r in enumerate(level.robots))
    )
    shuffled = replace(level, robots=tuple(data.draw(st.permutations(level.robots))))
    one, other = World(level), World(shuffled)
    power = st.floats(-1, 1)
    for _ in range(6):
        desires = {r.name: Desire(data.draw(power), data.draw(power)) for r in level.robots}
        one.act(desires)
        other.act(desires)
        assert charges(one) == charges(other)
        assert sum(charges(one).values()) >= 0
