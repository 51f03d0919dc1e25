"""What looks wrong with a level is found, with its place."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui import World
from logical_robots_tui.editing.checks import LevelFinding, check
from logical_robots_tui.editing.strokes import paint, paint_rectangle
from logical_robots_tui.world import Area, Beacon, Level, Robot, Visibility, load_level
from tests.editing.making import CONFORMANCE, EDITS, SHIPPED, Edit, room

RADIUS = 9
LONG = "n" * 61
NO_MEMORY = Visibility("none")  # type: ignore[arg-type] # as it is tested


def hall(**more: Any) -> Level:
    """A room with a rim, 400 x 200 units, one robot on the left and a goal on the right."""
    level = room(400, 200, **{"areas": (goal(),), **more})
    level = paint_rectangle(level, (0, 0), (399, 199), border=5)
    return replace(level, robots=(Robot("Ann", 50.5, 100.5),))


def goal(**more: Any) -> Area:
    return replace(Area("home", 350, 100, 20, victory_robots=("Ann",)), **more)


def wall_with_gap(level: Level, gap: int) -> Level:
    level = paint_rectangle(level, (200, 0), (209, 199))
    return paint_rectangle(level, (200, 100), (209, 99 + gap), wall=False) if gap else level


def texts(level: Level) -> list[str]:
    return [finding.text for finding in check(level)]


def test_a_goal_behind_a_wall_or_a_narrow_gap_is_told_and_an_open_way_is_not() -> None:
    assert check(hall()) == []
    assert check(wall_with_gap(hall(), 2 * RADIUS)) == []
    text = 'Ann can\'t reach the goal "home".'
    assert check(wall_with_gap(hall(), 0)) == [LevelFinding(text, 350, 100)]
    level = wall_with_gap(hall(), 1)
    walls = level.walls.copy()
    walls[100, 205] = True  # walls that touch at a corner: a point slips between them
    walls[101, 205] = False
    gaps = [replace(level, walls=walls), level, wall_with_gap(hall(), 2 * RADIUS - 2)]
    text = 'Ann can reach the goal "home" only through gaps narrower than a robot.'
    assert [check(level) for level in gaps] == [[LevelFinding(text, 350, 100)]] * 3


@pytest.mark.sampled
@pytest.mark.parametrize("path", [*SHIPPED, *CONFORMANCE], ids=lambda path: path.stem)
def test_nothing_is_wrong_with_our_own_levels_or_forbids_loading_one_that_was(path: Path) -> None:
    findings = check(load_level(path))
    assert not any(finding.forbids for finding in findings)
    assert not findings or path in CONFORMANCE


def test_a_solid_area_is_in_the_way_unless_something_switches_it_off() -> None:
    plug = Area("plug", 205, 109, 20, impenetrable=True)
    for on, off in [("", ""), ("", "lamp"), ("", "nothing"), ("lamp", "")]:
        area = replace(plug, on_beacon=on, off_beacon=off)
        level = hall(beacons=(Beacon("lamp", 60, 60),), areas=(goal(), area))
        is_open = 'Ann can\'t reach the goal "home".' not in texts(wall_with_gap(level, 18))
        assert is_open == ("lamp" in (on, off))


def test_an_open_rim_lets_robots_drive_round_walls() -> None:
    level = wall_with_gap(hall(), 0)
    level = paint_rectangle(level, (0, 80), (9, 119), wall=False)
    level = paint_rectangle(level, (390, 150), (399, 150), wall=False)
    assert texts(level) == [
        'Ann can reach the goal "home" only through gaps narrower than a robot.',
        "The outer wall has a gap on the left, 40 units wide.",
        "The outer wall has a gap on the right, 1 unit wide.",
    ]
    assert [(finding.x, finding.y) for finding in check(level)[1:]] == [(0.5, 100), (399.5, 150.5)]


def test_every_robot_that_a_goal_is_for_is_asked() -> None:
    names = ("Ann", "Bob", "Cid", "Dot", "Eve")
    robots = tuple(Robot(name, 50.5 + 3 * i, 50.5) for i, name in enumerate(names))
    level = replace(wall_with_gap(hall(), 0), robots=robots, areas=(goal(victory_robots=names),))
    assert texts(level) == ['Ann, Bob, Cid and 2 more can\'t reach the goal "home".']
    level = replace(level, robots=(*robots[:2], replace(robots[2], x=300.0), *robots[3:]))
    level = replace(level, areas=(goal(victory_robots=names[:3]),))
    assert texts(level) == ['Ann and Bob can\'t reach the goal "home".']


def test_what_is_inside_walls_or_outside_the_map_is_told() -> None:
    level = hall(
        beacons=(Beacon("lamp", 2, 50), Beacon("star", 500, 50), Beacon("moon", 50, 50)),
        areas=(Area("cave", 3, 3, 2), Area("sky", 900, 3, 9), Area("dot", 50, 50, 0)),
    )
    level = replace(level, robots=(Robot("Ann", 398, 50), Robot("Bob", -1, 50)))
    assert [(finding.text, finding.x) for finding in check(level)] == [
        ('Robot "Bob" is outside the labyrinth. The labyrinth is 400 x 200 units.', -1),
        ('Robot "Ann" is inside a wall.', 398),
        ('Beacon "lamp" is inside a wall.', 2),
        ('Beacon "star" is outside the labyrinth.', 500),
        ('Area "cave" is inside walls.', 3),
        ('Area "sky" is outside the labyrinth.', 900),
        ('Area "dot" is too small: its radius is below 1.', 50),
    ]


def test_goals_that_are_solid_and_names_that_nothing_has_or_shares_are_told() -> None:
    solid = 'No robot can be inside the goal "home": it is solid.'
    assert texts(hall(areas=(goal(impenetrable=True),))) == [solid]
    lamps = (Beacon("lamp", 60, 60),)
    level = replace(hall(beacons=lamps, areas=(goal(name="lamp"),)), shared_names=("lamp",))
    assert texts(level) == ['"lamp" is a shared name, but no two beacons or areas have it.']
    area = goal(victory_robots=("Ann", "ann"), on_beacon="lamb", off_beacon="xyz")
    assert texts(hall(beacons=lamps, areas=(area,))) == [
        'Area "home" is a goal for "ann", but there is no such robot. Did you mean "Ann"?',
        'Area "home" is switched by "lamb", but there is no such beacon. Did you mean "lamp"?',
        'Area "home" is switched by "xyz", but there is no such beacon.',
    ]


def test_names_used_twice_are_told_and_those_of_robots_forbid_loading() -> None:
    level = hall(
        beacons=(Beacon("lamp", 60, 60), Beacon("lamp", 70, 60), Beacon("lamp", 80, 60)),
        areas=(goal(), goal(x=300)),
    )
    assert check(level) == [
        LevelFinding('3 beacons are called "lamp"; a radar can\'t distinguish them.', 70, 60),
        LevelFinding('2 areas are called "home".', 300, 100),
    ]
    assert texts(replace(level, shared_names=("lamp",))) == ['2 areas are called "home".']
    assert check(replace(level, shared_names=("home", "lamp"))) == []
    twins = replace(level, robots=level.robots * 2, shared_names=("Ann",))
    text = '2 robots are called "Ann"; each needs a unique name.'
    assert check(twins)[0] == LevelFinding(text, 50.5, 100.5, forbids=True)


NOWHERE = (Robot("Ann", math.nan, 6),)
MANY = tuple(Beacon(f"b{i}", 60, 60) for i in range(1001))
WIDE = {"width": 4001, "walls": np.zeros((200, 4001), np.bool_)}
UNSAYABLE: list[tuple[dict[str, Any], str, tuple[float, float] | tuple[()]]] = [
    ({"robots": ()}, "The level has no robots.", ()),
    ({"title": ""}, '"title" is empty.', ()),
    ({"visibility": NO_MEMORY}, '"memory" must be "own" or "seen" or "all".', ()),
    ({"robots": (Robot(LONG, 5, 6),)}, f'"{LONG}": "name" is longer than 60 characters.', (5, 6)),
    ({"robots": NOWHERE}, '"Ann": "x" must be a finite number, not nan.', ()),
    ({"areas": (goal(radius=-1),)}, '"home": "radius" must be 0 or more, not -1.', (350, 100)),
    ({"beacons": MANY}, "There are 1001 beacons; at most 1000 are allowed.", ()),
    (WIDE, "The labyrinth is 4001 x 200 units; at most 4000 x 4000 is allowed.", ()),
]


def test_what_no_file_could_say_forbids_loading() -> None:
    for changes, text, place in UNSAYABLE:
        finding = replace(LevelFinding(text, *place), forbids=True)
        assert check(replace(hall(), **changes)) == [finding]


@settings(deadline=None)
@given(st.lists(EDITS, max_size=8))
def test_a_level_that_was_edited_can_be_loaded_and_run(steps: list[Edit]) -> None:
    level = room()
    for step in steps:
        level = step(level)
    assert not any(finding.forbids for finding in check(level))
    assert World(level).tick == 0


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 399), st.integers(0, 199)), min_size=2, max_size=4))
def test_walls_never_make_it_easier_to_get_to_a_goal(points: list[tuple[int, int]]) -> None:
    ranks = {"": 0, "narrower than a robot": 1, "can't get": 2}

    def rank(level: Level) -> int:
        findings = str(texts(level))
        return max(rank for words, rank in ranks.items() if words in findings)

    level = wall_with_gap(hall(), 30)
    harder = paint(level, points, width=8)
    if not harder.walls[100, 50]:
        assert rank(harder) >= rank(level)
