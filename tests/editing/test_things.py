"""Placing, changing and removing robots, beacons and areas, and the level as a whole."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from logical_robots_tui.editing import things
from logical_robots_tui.editing.things import Ref, add, change, duplicate, remove, resize, set_words
from logical_robots_tui.world import Area, Beacon, LevelError, Robot, Visibility
from tests.editing.making import drawn, room, sketch

ANN, LAMP, GATE = Ref("robots", 0), Ref("beacons", 0), Ref("areas", 0)
NOTHING = Visibility("none")  # type: ignore[arg-type] # as it is tested


TWO = add(room(), Robot("Bob", 1, 1))[0]
FURNISHED = room(
    beacons=(Beacon("lamp", 60, 20), Beacon("lamp", 90, 20)),
    areas=(
        Area("gate", 40, 40, 20, victory_robots=("Ann",), on_beacon="lamp", off_beacon="lamp"),
        Area("home", 44, 40, 6),
    ),
)


def test_a_new_thing_is_the_last_of_its_kind_and_a_robot_whose_name_is_taken_counts_on() -> None:
    level, ref = add(FURNISHED, Beacon("bell", 5, 6, True))
    assert ref == Ref("beacons", 2)
    assert things.thing(level, ref) == Beacon("bell", 5, 6, True)
    level, _ = add(room(), Robot("Ann", 1, 1))
    level, _ = add(level, Robot("Ann 2", 1, 1))
    level, _ = duplicate(level, ANN, 5, -5)
    assert [robot.name for robot in level.robots] == ["Ann", "Ann 2", "Ann 3", "Ann 4"]
    some, _ = add(add(level, Robot("Robo1", 1, 1))[0], Robot("Robo1", 2, 2))
    assert [robot.name for robot in some.robots][-2:] == ["Robo1", "Robo2"]
    assert (level.robots[3].x, level.robots[3].y) == (25.5, 15.5)
    long, _ = add(add(level, Robot("n" * 60, 1, 1))[0], Robot("n" * 60, 1, 1))
    assert long.robots[-1].name == "n" * 58 + " 2"


def test_every_property_can_be_set() -> None:
    level = change(FURNISHED, ANN, x=3, angle=math.pi / 3, has_battery=True, can_charge=True)
    level = change(level, ANN, battery_capacity=7.5, battery_consumption_rate=0.1, color="#123")
    assert level.robots[0] == Robot("Ann", 3, 20.5, math.pi / 3, "#123", True, True, 7.5, 0.1)
    level = change(level, LAMP, charging_station=True, y=9.25)
    assert level.beacons[0] == Beacon("lamp", 60, 9.25, True)
    level = change(level, GATE, radius=9, sticky_switch=True, impenetrable=True, off_beacon="")
    level = change(level, GATE, victory_robots=(), on_beacon="bell", color="red", name="door")
    assert level.areas[0] == Area("door", 40, 40, 9, "red", (), "bell", "", True, True)


def test_areas_follow_a_robot_and_the_last_beacon_of_a_name() -> None:
    assert change(FURNISHED, ANN, name="Zoe").areas[0].victory_robots == ("Zoe",)
    once = change(FURNISHED, LAMP, name="bell")
    assert (once.areas[0].on_beacon, once.areas[0].off_beacon) == ("lamp", "lamp")
    twice = change(once, Ref("beacons", 1), name="bell")
    assert (twice.areas[0].on_beacon, twice.areas[0].off_beacon) == ("bell", "bell")
    bare = remove(remove(FURNISHED, LAMP), LAMP)  # what is removed goes on being named
    assert bare.beacons == ()
    assert bare.areas[0].on_beacon == "lamp"
    assert remove(bare, GATE).areas == (bare.areas[1],)


def test_an_area_that_is_called_otherwise_changes_nothing_else() -> None:
    assert change(FURNISHED, GATE, radius=20.0, name="gate") is FURNISHED
    after = change(FURNISHED, GATE, name="door")
    assert after.areas == (replace(FURNISHED.areas[0], name="door"), FURNISHED.areas[1])


TOO_LARGE = "The labyrinth is 5 x 4001 units; at most 4000 x 4000 is allowed."
REFUSED: list[tuple[Callable[[], object], str]] = [
    (lambda: change(FURNISHED, ANN, name="n" * 61), '"name" is longer than 60 characters.'),
    (lambda: change(FURNISHED, ANN, name=" "), '"name" is empty.'),
    (lambda: change(FURNISHED, ANN, name="A\nnn"), "can't be shown"),
    (lambda: change(FURNISHED, ANN, x=math.nan), "finite"),
    (lambda: change(FURNISHED, ANN, x=1e7), "too large"),
    (lambda: change(FURNISHED, ANN, angle=math.inf), "finite"),
    (lambda: change(FURNISHED, ANN, color="#12"), "not a colour"),
    (lambda: change(FURNISHED, ANN, battery_capacity=-1.0), '"capacity" must be 0 or more'),
    (lambda: change(FURNISHED, ANN, radius=3), "Robots have no radius."),
    (lambda: change(FURNISHED, LAMP, name=""), '"name" is empty.'),
    (lambda: change(FURNISHED, GATE, radius=-2), '"radius" must be 0 or more, not -2.'),
    (lambda: change(FURNISHED, GATE, victory_robots=("",)), "is empty"),
    (lambda: change(TWO, Ref("robots", 1), name="Ann"), 'Two robots are called "Ann"'),
    (lambda: remove(room(), ANN), "at least one"),
    (lambda: set_words(room(), title=""), '"title" is empty.'),
    (lambda: set_words(room(), title="t" * 61), "longer than 60"),
    (lambda: set_words(room(), briefing="b" * 20_001), "longer than 20000"),
    (lambda: set_words(room(), hints=("\x1b",)), "can't be shown"),
    (lambda: set_words(room(), visibility=NOTHING), '"memory" must be'),
    (lambda: set_words(room(), width=5), "A level has no property width."),
    (lambda: resize(room(), 0, 5), '"width" must be 1 or more'),
    (lambda: resize(room(), 5, 4001), TOO_LARGE),
]


def test_what_is_out_of_bounds_is_refused() -> None:
    for act, message in REFUSED:
        with pytest.raises(LevelError, match=message):
            act()


def test_a_thousand_of_a_kind_and_a_place_that_a_file_can_say_are_the_most() -> None:
    for new in (Robot("R", 1e6, 0), Beacon("b", 0, 1e6), Area("a", 1e6, 0, 1)):
        kind = f"{type(new).__name__.lower()}s"
        full: Any = {kind: tuple(replace(new, name=f"{new.name}{i}") for i in range(1000))}
        with pytest.raises(LevelError, match=f"There are 1000 {kind} already"):
            add(replace(room(), **full), new)
        alone: Any = {kind: (new,)}
        with pytest.raises(LevelError, match="too far outside the labyrinth"):
            resize(replace(room(), **alone), 120, 81, left=1, top=1)


def test_what_is_at_a_point_is_the_nearest_robot_or_beacon_else_the_smallest_area() -> None:
    points = [(28, 20), (67.9, 20), (69, 20), (41, 40), (30, 45), (110, 70)]
    refs = [things.ref_at(FURNISHED, x, y) for x, y in points]
    assert refs == [ANN, LAMP, None, Ref("areas", 1), GATE, None]
    assert things.ref_at(FURNISHED, 69, 20, reach=2) == LAMP


def test_texts_and_visibility_are_set_as_they_will_be_loaded() -> None:
    words: dict[str, Any] = {"title": "Über", "hints": ("a", "b"), "idea": "New."}
    words |= {"starter": "wander", "visibility": Visibility("all", "own")}
    level = set_words(room(), briefing="\nGo.\n\nNow.\n", **words)
    assert vars(level).items() >= (words | {"briefing": "Go.\n\nNow."}).items()
    assert set_words(level, briefing="Go.\n\nNow.") is level


def test_another_size_keeps_what_there_was_and_everything_moves_along() -> None:
    level = drawn("#..", "..#")
    wider = resize(level, 5, 4, left=1, top=2)
    assert sketch(wider) == [".....", ".....", ".#...", "...#."]
    assert (wider.robots[0].x, wider.robots[0].y) == (2.5, 2.5)
    assert sketch(resize(level, 2, 3, left=-1, wall=True)) == ["..", ".#", "##"]
    assert sketch(resize(level, 2, 2, left=-9, wall=True)) == ["##", "##"]
    assert resize(level, level.width, level.height) is level
    largest = resize(room(), 4000, 4000, wall=True)
    assert np.count_nonzero(~largest.walls) == 120 * 80
