"""The level format of the web platform."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.world import (
    Area,
    Beacon,
    Level,
    LevelError,
    Robot,
    Visibility,
    World,
    load_level,
)
from logical_robots_tui.world.levels.load import read_web
from logical_robots_tui.world.levels.native import read_native

from .records import LEVELS


def small(**more: object) -> dict[str, Any]:
    level: dict[str, Any] = {"width": 3, "height": 2, "walls": "111102"}
    level["robots"] = [{"name": "Ann", "x": 1.5, "y": 1.5}]
    return {**level, **more}


def robot(**more: object) -> dict[str, Any]:
    return small(robots=[{"name": "Ann", "x": 1, "y": 1, **more}])


def area(**more: object) -> dict[str, Any]:
    return small(areas=[{"name": "home", "x": 1, "y": 1, "radius": 5, **more}])


def beacon(**more: object) -> dict[str, Any]:
    return small(beacons=[{"name": "lamp", "x": 1, "y": 1, **more}])


def read(level: object) -> Level:
    return read_web(json.dumps(level), "level", "level.json")


def refusal(text: str) -> LevelError:
    with pytest.raises(LevelError) as caught:
        read_web(text, "level", "level.json")
    return caught.value


@pytest.mark.parametrize("path", LEVELS, ids=lambda path: path.stem)
def test_levels_of_the_platform_load_with_everything_visible_to_all(path: Path) -> None:
    level = load_level(path)
    assert level.walls.shape == (level.height, level.width)
    assert level.visibility == Visibility(memory="all", sensor="all")
    assert (level.name, level.source) == (path.stem, str(path))
    assert World(level).tick == 0


def test_only_the_digit_1_is_a_wall_missing_ones_are_free_and_surplus_ones_ignored() -> None:
    walls = read(small(walls="1?1Ω02")).walls
    assert walls.tolist() == [[True, False, True], [False, False, False]]
    assert not walls.flags.writeable
    for digits, count in (("1", 1), ("1" * 99, 6)):
        assert np.count_nonzero(read(small(walls=digits)).walls) == count


def test_what_a_robot_leaves_out_has_its_default_and_what_makes_no_sense_is_ignored() -> None:
    assert read(robot()).robots == (Robot("Ann", 1, 1),)
    assert read(robot(angle=-20)).robots[0].angle == -20
    assert not read(robot(can_charge=True)).robots[0].can_charge
    assert read(robot(can_charge=True, has_battery=True)).robots[0].can_charge
    level = read(robot(has_battery=True, battery_capacity=30, battery_level=7))
    assert World(level).robots[0].battery_level == 30


def test_truths_are_compared_as_the_platform_does() -> None:
    for value in (True, 1, "1", "yes", False, 2):
        (station,) = read(beacon(charging_station=value)).beacons
        assert station == Beacon("lamp", 1, 1, value in (True, "1")), value
    truthy: list[object] = [True, 1, "no", []]
    for switch in (*truthy, False, 0, ""):
        assert read(area(sticky_switch=switch)).areas[0].sticky_switch is (switch in truthy), switch
    for value in (True, 1, "true"):
        assert read(area(impenetrable=value)).areas[0].impenetrable is (value is True), value


def test_an_area_may_name_robots_and_beacons_that_do_not_exist() -> None:
    level = read(area(victory_robots=["Nobody"], on_beacon="none", off_beacon=None))
    assert level.areas == (Area("home", 1, 1, 5, victory_robots=("Nobody",), on_beacon="none"),)


@pytest.mark.parametrize("color", ["#12345", "\u001b[31m", 7])
def test_a_colour_that_is_none_becomes_the_default(color: object) -> None:
    assert read(robot(color=color)).robots[0].color == Robot("Ann", 0, 0).color
    assert read(area(color=color)).areas[0].color == Area("home", 0, 0, 0).color


BAD_VALUES = [
    (small(width=None), "width", '"width" is missing.'),
    (small(width="3"), "width", '"width" must be a number, not text.'),
    (small(sensors={"rays": 7}), "sensors", "A level of the web platform can't say sensors."),
    (small(width=1.5), "width", '"width" must be a whole number, not 1.5.'),
    (small(height=0), "height", '"height" must be 1 or more, not 0.'),
    (small(height=4001), "width", "The labyrinth is 3 x 4001 units; at most 4000 x 4000 is "),
    (small(walls=None), "walls", '"walls" must be text with one digit per cell, row after row.'),
    (small(walls=[1]), "walls", '"walls" must be text with one digit per cell, row after row.'),
    (small(robots=None), "robots", "The level has no robots."),
    (small(robots=[]), "robots", "The level has no robots."),
    (small(robots={}), "robots", '"robots" must be a list, not a record.'),
    (small(robots=["Ann"]), "robots[0]", "This must be a record, not text."),
    (small(robots=[{}] * 1001), "robots", "There are 1001 robots; at most 1000 are allowed."),
    (small(robots=small()["robots"] * 2), "robots[1].name", 'Two robots are called "Ann".'),
    (robot(name=None), "robots[0].name", '"name" is missing.'),
    (robot(name=5), "robots[0].name", '"name" must be text, not a number.'),
    (robot(name=""), "robots[0].name", '"name" is empty.'),
    (robot(name="n" * 61), "robots[0].name", '"name" is longer than 60 characters.'),
    (robot(name="\x1b[31mAnn"), "robots[0].name", '"name" has a character that can\'t be shown.'),
    (robot(name="\ud800"), "robots[0].name", '"name" has a character that can\'t be shown.'),
    (robot(x=float("nan")), "robots[0].x", '"x" must be a finite number, not nan.'),
    (robot(y=[]), "robots[0].y", '"y" must be a number, not a list.'),
    (robot(has_battery=1), "robots[0].has_battery", "must be true or false, not a number."),
    (robot(battery_capacity=-1), "robots[0].battery_capacity", "must be 0 or more, not -1."),
    (beacon(x=None), "beacons[0].x", '"x" is missing.'),
    (beacon(name="a\nb"), "beacons[0].name", '"name" has a character that can\'t be shown.'),
    (area(radius=-1), "areas[0].radius", '"radius" must be 0 or more, not -1.'),
    (area(radius=float("inf")), "areas[0].radius", '"radius" must be a finite number, not inf.'),
    (area(victory_robots="Ann"), "areas[0].victory_robots", "must be a list, not text."),
    (area(victory_robots=[1]), "areas[0].victory_robots[0]", "This must be text, not a number."),
    (area(on_beacon=1), "areas[0].on_beacon", '"on_beacon" must be text, not a number.'),
]


@pytest.mark.parametrize(("level", "key", "message"), BAD_VALUES)
def test_a_bad_value_is_refused_at_its_key(level: object, key: str, message: str) -> None:
    error = refusal(json.dumps(level))
    assert error.place == f"level.json: {key}"
    assert message in error.message


def test_broken_json_is_placed_by_line_and_column() -> None:
    error = refusal('{\n  "width": ,\n}')
    assert error.place == "level.json, line 2, column 12"
    assert error.message == "This is not valid JSON: Expecting value."


def test_json_that_its_parser_chokes_on_or_that_is_no_object_is_refused() -> None:
    for text in ("9" * 5000, "[" * 50_000):
        assert refusal(text).message.startswith("This is not valid JSON: ")
    assert refusal("[]").message == "The file must hold one JSON object."


_anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=5,
)
_KEYS = sorted({*small(), *Robot.__slots__, *Beacon.__slots__, *Area.__slots__})


def _spoiled(level: dict[str, Any], key: str, value: object) -> dict[str, Any]:
    if key in {"width", "height", "walls", "robots"}:
        return {**level, key: value}
    kinds = ("robots", "beacons", "areas")
    return {**level, **{kind: [{**level[kind][0], key: value}] for kind in kinds}}


@settings(deadline=None)
@given(st.sampled_from(_KEYS), _anything)
def test_whatever_a_value_is_the_level_plays_or_is_refused(key: str, value: object) -> None:
    level = _spoiled({**area(), **beacon(), "areas": area()["areas"]}, key, value)
    problem = None
    try:
        world = World(read(level))
        world.act({})
    except LevelError as error:
        problem = error
    if problem is None:
        assert world.tick == 1
    else:
        assert key in problem.place or problem.place == "level.json: width"


@settings(deadline=None)
@given(st.text())
def test_text_that_is_not_a_level_is_refused_in_words(text: str) -> None:
    for reader in (read_web, read_native):
        with pytest.raises(LevelError, match=r"^level: ?.+|^level, .+"):
            reader(text, "level", "level")
