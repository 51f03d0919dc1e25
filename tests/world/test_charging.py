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
    """Return a world whose robots have these charges."""
    world = World(level)
    state = world.save()
    robots = tuple(
        replace(each, battery_level=charges.get(each.name, each.battery_level))
        for each in state.robots
    )
    world.restore(replace(state, robots=robots))
    return world


def charges(world: World) -> dict[str, float]:
    return {each.name: each.battery_level for each in world.robots}


@pytest.mark.parametrize(("divided", "share"), [(True, 1.0), (False, 2.0)])
def test_a_station_divides_what_it_gives_only_if_the_level_says_so(
    divided: bool, share: float
) -> None:
    world = emptied(room(robot("Ann"), robot("Bob"), divided=divided), Ann=10, Bob=20)
    world.act({})
    assert charges(world) == {"Ann": 10 + share, "Bob": 20 + share}


def test_who_is_full_takes_no_share() -> None:
    world = emptied(room(robot("Ann"), robot("Bob")), Ann=10)
    world.act({})
    assert charges(world) == {"Ann": 12, "Bob": 100}


def test_a_robot_gives_no_more_than_it_has() -> None:
    level = room(robot("Ann", giver=True), robot("Bob"), robot("Cid"), station=False)
    world = emptied(level, Ann=1.5, Bob=10, Cid=20)
    world.act({})
    assert charges(world) == {"Ann": 0, "Bob": 10.75, "Cid": 20.75}


def test_two_that_charge_each_other_gain_nothing() -> None:
    world = emptied(
        room(robot("Ann", giver=True), robot("Bob", giver=True), station=False), Ann=10, Bob=20
    )
    world.act({"Ann": Desire(1, 1)})
    assert charges(world) == {"Ann": 10, "Bob": 20}


def test_who_is_charged_pays_nothing_for_its_engines() -> None:
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
