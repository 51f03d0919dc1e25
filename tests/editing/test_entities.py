"""Placing, changing and removing things, the level as a whole, and undoing without limit."""

import math
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing import entities
from logical_robots_tui.editing.edits import Delta, Edits
from logical_robots_tui.editing.entities import (
    Ref,
    add,
    change,
    duplicate,
    remove,
    resize,
    set_words,
)
from logical_robots_tui.editing.strokes import paint
from logical_robots_tui.world import Area, Beacon, LevelError, Robot, Visibility
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.walls import difference_box
from tests.editing.making import EDITS, Edit, drawn, room, sketch

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
    assert entities.entity_of(level, ref) == Beacon("bell", 5, 6, True)
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
    assert change(FURNISHED, GATE, radius=20.0, name="gate") is FURNISHED
    after = change(FURNISHED, GATE, name="door")  # another name changes nothing else
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
    refs = [entities.ref_at(FURNISHED, x, y) for x, y in points]
    assert refs == [ANN, LAMP, None, Ref("areas", 1), GATE, None]
    assert entities.ref_at(FURNISHED, 69, 20, reach=2) == LAMP


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
    assert np.count_nonzero(~resize(room(), 4000, 4000, wall=True).walls) == 120 * 80


@settings(deadline=None)
@given(st.lists(EDITS, max_size=12))
def test_every_edit_is_undone_and_redone_exactly(steps: list[Edit]) -> None:
    edits = Edits(room())
    steps_taken = sum(edits.do("edit", step(edits.level)) for step in steps)
    last = edits.level
    undone = [edits.level]
    while edits.undo():
        undone.append(edits.level)
    # A step may change a level to one that is the same in all but identity; it leaves no trace.
    assert len(undone) <= 1 + steps_taken
    assert alike(undone[-1], room())
    for level in reversed(undone[:-1]):
        assert edits.redo()
        assert alike(edits.level, level)
    assert alike(edits.level, last)
    assert not edits.redo()


@settings(deadline=None)
@given(st.lists(EDITS, min_size=1, max_size=5))
def test_a_delta_leads_from_one_level_to_another_and_back(steps: list[Edit]) -> None:
    before = after = room()
    for step in steps:
        after = step(after)
    delta = Delta.between(before, after)
    assert alike(delta.apply(before), after)
    assert alike(delta.apply(after, forward=False), before)
    walls = [(level.walls.shape, level.walls.tobytes()) for level in (before, after)]
    rest = [vars(level) | {"walls": None} for level in (before, after)]
    is_same = walls[0] == walls[1] and rest[0] == rest[1]
    assert delta.empty == alike(before, after) == is_same
    assert alike(after, replace(after, name="other", source="other.toml"))


def test_what_is_undone_is_called_by_its_name() -> None:
    edits = Edits(room())
    assert (edits.undo(), edits.redo(), edits.can_undo, edits.can_redo) == ("", "", "", "")
    edits.do("paint", paint(edits.level, [(5, 5)]))
    edits.do("erase", paint(edits.level, [(5, 5)], wall=False))
    assert edits.can_undo == edits.undo() == "erase"
    assert (edits.can_undo, edits.can_redo) == ("paint", "erase")
    assert edits.redo() == "erase"
    edits.undo()
    edits.do("paint", paint(edits.level, [(9, 9)]))  # something new ends what could be redone
    assert edits.redo() == ""


def test_a_stroke_that_goes_on_is_one_step_unless_it_was_saved_under_way() -> None:
    edits = Edits(room())
    for x in range(5, 50):
        edits.do("paint", paint(edits.level, [(x, 5)]), merge=x > 5)
    edits.do("paint", paint(edits.level, [(5, 40)]))
    for count in (45, 0):
        edits.undo()
        assert edits.level.walls.sum() == count
    assert not edits.is_changed
    edits.do("paint", paint(edits.level, [(5, 5)]))
    assert edits.is_changed
    edits.mark_saved()
    assert not edits.is_changed
    edits.do("paint", paint(edits.level, [(6, 5)]), merge=True)
    assert edits.is_changed
    for is_changed in (False, True):
        edits.undo()
        assert edits.is_changed == is_changed
    edits.do("paint", paint(edits.level, [(9, 9)]))
    assert edits.is_changed


def test_the_box_of_a_change_is_the_smallest() -> None:
    for width in (120, 121):
        level = room(width)
        after = paint(paint(level, [(30, 20)]), [(50, 60)])
        assert difference_box(level.walls, after.walls) == (slice(20, 61), slice(30, 51))
        assert difference_box(level.walls, level.walls.copy()) is None


def test_many_strokes_on_the_largest_level_take_little_memory() -> None:
    level = resize(room(), 4000, 4000)
    edits = Edits(level)
    tracemalloc.start()
    try:
        start = tracemalloc.get_traced_memory()[0]
        for x, y in zip(range(0, 3000, 75), range(0, 1000, 25), strict=True):
            edits.do("paint", paint(edits.level, [(x, y), (x + 200, y + 90)], width=12))
        assert tracemalloc.get_traced_memory()[0] - start < 2 * level.walls.nbytes + 500_000
    finally:
        tracemalloc.stop()
