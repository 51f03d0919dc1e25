"""What robots see."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.world import Area, Beacon, Level, Robot, Sensors, World, load_level, rays
from logical_robots_tui.world.rays import RayLayout, rays_of
from logical_robots_tui.world.walls import FEW, FEWEST, Walls

from .making import levels, make_level
from .plain_sensing import plain_look
from .records import LEVELS, scripted_desires

HERE = Robot("Ann", 50.5, 50.5)


def forward(level: Level) -> tuple[int, str, str]:
    sensor = World(level).look()[0]["sensor"]
    return sensor["forward_distance"], sensor["forward_object"], sensor["forward_label"]


def assert_sees_what_the_plain_rays_see(level: Level) -> None:
    """With circles looked at one by one, all rays tried at them, those between their tangents."""
    level = replace(level, sensors=replace(level.sensors, noise=0))
    plain = plain_look(World(level))
    for fewest, few in ((10_000, 0), (0, 10_000), (0, 0)):
        with patch.multiple(rays, FEWEST=fewest, FEWEST_NEAR=fewest, FEW=few):
            assert World(level).look() == plain


@settings(deadline=None)
@given(levels())
def test_the_fast_rays_hit_what_the_plain_rays_hit(level: Level) -> None:
    assert_sees_what_the_plain_rays_see(level)


@settings(deadline=None)
@given(levels())
def test_few_rays_are_cast_as_many_are(level: Level) -> None:
    robots = World(level).robots
    rays = rays_of(robots, range(len(robots)), RayLayout(level.sensors))
    walls = Walls(level.walls, level.sensors.reach)
    found = []
    for times in (1, 1 + FEWEST // rays.cos.size, 1 + FEW // rays.cos.size):
        x, y = np.tile(rays.x, times), np.tile(rays.y, times)
        cos, sin = (np.tile(turn, (times, 1)) for turn in (rays.cos, rays.sin))
        found.append(walls.distances(x, y, cos, sin)[: len(rays.x)])
    fewest, few, many = found
    assert (fewest == many).all()
    assert (few == many).all()


@settings(deadline=None)
@given(
    levels(),
    st.lists(
        st.tuples(
            st.integers(0, 9),
            st.floats(-20, 280) | st.just(9999.0),
            st.floats(-20, 140),
            st.floats(-4, 4),
        ),
        min_size=5,
        max_size=20,
    ),
)
def test_what_was_sensed_before_changes_nothing(
    level: Level, changes: list[tuple[int, float, float, float]]
) -> None:
    """Where one robot is put elsewhere or turned, or one area switched, and all else is still."""
    world, other = World(level), World(level)
    for which, x, y, angle in changes:
        world.look()
        state = world.save()
        robots, areas = list(state.robots), list(state.areas)
        place = which % (len(robots) + len(areas))
        if place >= len(robots):
            area = areas[place - len(robots)]
            areas[place - len(robots)] = replace(area, active=not area.active)
        elif angle < 0:
            robots[place] = replace(robots[place], angle=angle)
        else:
            robots[place] = replace(robots[place], x=x, y=y)
        world.restore(replace(state, robots=tuple(robots), areas=tuple(areas)))
        other = World(level, like=other)
        other.restore(world.save())
        assert world.look() == other.look()


def test_noise_is_of_the_seed_and_the_tick_and_hits_stay_as_they_are() -> None:
    level = make_level([HERE, Robot("Bob", 90.5, 50.5, 1.0)], walls=[(150, y) for y in range(100)])

    def rays(tick: int, **sensors: float) -> list[dict[str, Any]]:
        world = World(replace(level, sensors=Sensors(rays=61, reach=120, **sensors)))  # type: ignore[arg-type] # numbers
        world.restore(replace(world.save(), tick=tick))
        return [ray for row in world.look() for ray in row["sensor"]["radar"]]

    exact, errors = rays(5), []
    for tick in range(40):
        noisy = rays(tick, noise=3)
        for ray, exact_ray in zip(noisy, exact, strict=True):
            assert ray | {"distance": 0} == exact_ray | {"distance": 0}
            assert 1 <= ray["distance"] <= 119 or ray == exact_ray
            if 20 < exact_ray["distance"] < 100:
                errors.append(ray["distance"] - exact_ray["distance"])
    assert rays(5, noise=3) == rays(5, noise=3) != rays(6, noise=3)
    assert rays(5, noise=3) != rays(5, noise=3, seed=2)
    assert abs(np.mean(errors)) < 0.2
    assert 2.8 < np.std(errors) < 3.2


@pytest.mark.sampled
@pytest.mark.parametrize("path", LEVELS, ids=lambda path: path.stem)
def test_the_fast_rays_agree_with_the_plain_ones_along_a_drive(path: Path) -> None:
    world = World(load_level(path))
    for tick in range(1, 61):
        if tick % 10 == 0:
            assert world.look() == plain_look(world)
        world.act(scripted_desires("reactive", tick, world.sense()))


@settings(deadline=None)
@given(
    heading=st.floats(0, math.tau),
    along=st.integers(1, 205) | st.floats(1, 205),
    radius=st.floats(0.001, 300),
    off=st.floats(-1e-7, 1e-7) | st.sampled_from((0.0, 1e-15, -1e-15, 1e-12, -1e-12)),
)
def test_a_ray_that_grazes_a_circle_decides_as_the_plain_one(
    heading: float, along: float, radius: float, off: float
) -> None:
    aside = radius * (1 + off)
    area = Area(
        "boulder",
        500.3 + along * math.cos(heading) - aside * math.sin(heading),
        500.7 + along * math.sin(heading) + aside * math.cos(heading),
        radius,
        impenetrable=True,
    )
    level = make_level([Robot("Ann", 500.3, 500.7, heading)], width=1000, height=1000, areas=[area])
    assert_sees_what_the_plain_rays_see(level)


def test_more_robots_than_one_pass_takes_all_see_each_other() -> None:
    crowd = [Robot(f"R{i}", 10.3 + 13 * i, 50.5, math.pi) for i in range(20)]
    world = World(make_level(crowd))
    rows = world.look()
    assert rows == plain_look(world)
    assert World(make_level([])).look() == []
    assert [row["sensor"]["forward_label"] for row in rows] == [
        "wall",
        *(robot.name for robot in crowd[:-1]),
    ]


@pytest.mark.parametrize(
    "apart",
    [4.0, pytest.param(13.0, marks=pytest.mark.proof), pytest.param(60.0, marks=pytest.mark.proof)],
)
def test_a_crowd_of_several_passes_sees_what_the_plain_rays_see(apart: float) -> None:
    crowd = [
        Robot(f"R{i}", 10.3 + apart * (i % 14), 11.7 + apart * (i // 14), 0.7 * i)
        for i in range(98)
    ]
    beacons = [Beacon(f"B{i}", 17.1 * i, 23.9 * i) for i in range(1, 9)]
    walls = [(x, y) for x in range(30, 900, 90) for y in range(0, 500, 3)]
    world = World(make_level(crowd, width=900, height=500, beacons=beacons, walls=walls))
    assert world.look() == plain_look(world)


SOLID = Area("boulder", 80.5, 50.5, 10, impenetrable=True)
NOTHING = (200, "none", "nothing")
PLACES: dict[str, tuple[dict[str, Any], tuple[int, str, str]]] = {
    "a robot 30 ahead": ({"robots": [HERE, Robot("Bob", 80.5, 50.5)]}, (22, "robot", "Bob")),
    "a beacon 30 ahead": ({"beacons": [Beacon("lamp", 80.5, 50.5)]}, (23, "beacon", "lamp")),
    "the first of two beacons at one distance": (
        {"beacons": [Beacon("first", 80.5, 50.5), Beacon("second", 80.5, 50.5)]},
        (23, "beacon", "first"),
    ),
    "a solid area is a wall": ({"areas": [SOLID]}, (21, "wall", "boulder")),
    "a solid area that is off": ({"areas": [replace(SOLID, on_beacon="lamp")]}, NOTHING),
    "an area that is not solid": ({"areas": [replace(SOLID, impenetrable=False)]}, NOTHING),
    "a solid area without size, even where a robot stands on it": (
        {"areas": [Area("dot", HERE.x, HERE.y, 0, impenetrable=True)]},
        NOTHING,
    ),
    "a wall at the first step into its cell": ({"walls": [(60, 50)]}, (10, "wall", "wall")),
    "199 ahead": ({"walls": [(249, 50)]}, (199, "wall", "wall")),
    "and no further": ({"walls": [(250, 50)]}, NOTHING),
    "the rim of the map": ({"width": 70}, (20, "wall", "wall")),
    "a radius is strict": ({"beacons": [Beacon("lamp", 80.5, 58.5)]}, NOTHING),
    "even where only one step touches it": (
        {"beacons": [Beacon("lamp", 80.5, math.nextafter(58.5, 0))]},
        (30, "beacon", "lamp"),
    ),
}


def test_what_is_ahead_is_seen_at_its_distance() -> None:
    assert {
        what: forward(make_level(**{"robots": [HERE], **level}))
        for what, (level, _) in PLACES.items()
    } == {what: seen for what, (_, seen) in PLACES.items()}


def test_a_robot_outside_the_map_sees_walls_at_1_all_around() -> None:
    row = World(make_level([Robot("Ann", -30, 50)])).look()[0]
    assert {(ray["distance"], ray["object"]) for ray in row["sensor"]["radar"]} == {(1, "wall")}


def test_at_one_distance_a_wall_is_seen_before_a_robot_before_a_beacon_before_an_area() -> None:
    wall = [(72, 50)]
    robot = Robot("Bob", 80.5, 50.5)
    beacon = Beacon("lamp", 79.5, 50.5)
    area = Area("boulder", 80.5, 50.5, 9, impenetrable=True)
    everything: dict[str, Any] = {"walls": wall, "beacons": [beacon], "areas": [area]}
    assert forward(make_level([HERE, robot], **everything)) == (22, "wall", "wall")
    del everything["walls"]
    assert forward(make_level([HERE, robot], **everything)) == (22, "robot", "Bob")
    assert forward(make_level([HERE], **everything)) == (22, "beacon", "lamp")
    del everything["beacons"]
    assert forward(make_level([HERE], **everything)) == (22, "wall", "boulder")


@settings(deadline=None)
@given(st.integers(20, 150), st.floats(1, 15))
def test_a_step_that_falls_exactly_on_a_rim_is_not_inside(step: int, aside: float) -> None:
    x, y = HERE.x + step + 10, HERE.y + aside
    area = Area("boulder", x, y, math.hypot(HERE.x + step - x, HERE.y - y), impenetrable=True)
    assert forward(make_level([HERE], areas=[area])) == (step + 1, "wall", "boulder")


def test_the_radar_sweeps_from_60_degrees_left_to_60_degrees_right() -> None:
    left_of_ann = Beacon("lamp", 80.5, 30.5)  # y grows downwards
    radar = World(make_level([HERE], beacons=[left_of_ann])).look()[0]["sensor"]["radar"]
    degrees = [math.degrees(ray["angle"]) for ray in radar]
    assert degrees == pytest.approx([60 - 4 * i for i in range(31)])
    seen = [math.degrees(ray["angle"]) for ray in radar if ray["label"] == "lamp"]
    assert min(seen) > 0
    assert any(angle == pytest.approx(32) for angle in seen)


def test_rows_hold_plain_python_values_only() -> None:
    areas = [Area("boulder", 80.5, 50.5, 10, impenetrable=True)]
    world = World(make_level([HERE, Robot("Bob", 60, 60)], areas=areas))
    plain = {dict, list, str, int, float, bool}

    def kinds(value: object) -> set[type]:
        if isinstance(value, dict):
            return {dict}.union(*map(kinds, value.values()))
        if isinstance(value, list):
            return {list}.union(*map(kinds, value))
        return {type(value)}

    assert kinds(world.sense()) <= plain
    ray = world.sense()[0]["sensor"]["radar"][0]
    assert type(ray["distance"]) is int
    assert type(ray["angle"]) is float
