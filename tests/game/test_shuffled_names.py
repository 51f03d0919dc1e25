"""Names that varied starts exchange."""

from dataclasses import replace

import pytest

from logical_robots_tui import load_level
from logical_robots_tui.game.measuring import start_of, vary_start
from logical_robots_tui.world import Area, Beacon, LevelError
from logical_robots_tui.world.levels.native import read_native
from tests.short import LEVEL as SHORT


def test_varied_starts_exchange_the_names_that_a_level_shuffles_wherever_they_stand() -> None:
    level = load_level("10-distributed-mapping")
    colors = {"red": "B01", "blue": "Base"}
    lamps = tuple(
        Area(color, 10, 10, 5, on_beacon=beacon, off_beacon="B02")
        for color, beacon in colors.items()
    )
    robots = tuple(replace(each, team=each.color) for each in level.robots)
    level = replace(level, robots=robots, areas=(*level.areas, *lamps), shuffled_names=())
    plain = [vary_start(level, seed) for seed in range(20)]
    level = replace(level, shuffled_names=("B??", "[A-C]*[!e]"))
    starts = [vary_start(level, seed) for seed in range(20)]
    assert [start.robots for start in starts] == [
        vary_start(level, seed).robots for seed in range(20)
    ]
    for start, unnamed in zip(starts, plain, strict=True):
        for kind in ("robots", "beacons"):
            were, are = getattr(level, kind), getattr(start, kind)
            new = {was.name: now.name for was, now in zip(were, are, strict=True)}
            assert set(new) == set(new.values())
            kept = {name for name, other in new.items() if name == other}
            assert kept == ({"Base"} if kind == "beacons" else {"Dahlia", "Ebony", "Flint"})
            assert are == tuple(replace(one, name=new[one.name]) for one in getattr(unnamed, kind))
            if kind == "robots":
                names = new
        goal, *lamps_now = start.areas
        assert goal.victory_robots == tuple(names[name] for name in level.areas[0].victory_robots)
        assert [(lamp.on_beacon, lamp.off_beacon) for lamp in lamps_now] == [
            (new[one], new["B02"]) for one in colors.values()
        ]
    assert len({start.beacons for start in starts}) == 20


def test_one_name_stays_and_two_change_by_chance_and_the_given_start_is_as_in_the_file() -> None:
    level = read_native(SHORT, "short", "")
    two = (Beacon("one", 5, 5), Beacon("two", 9, 9), Beacon("other", 9, 5))
    level = replace(level, beacons=two, shuffled_names=("one", "t*", level.robots[0].name))
    starts = [vary_start(level, seed) for seed in range(20)]
    assert {start.robots[0].name for start in starts} == {level.robots[0].name}
    assert {tuple(beacon.name for beacon in start.beacons) for start in starts} == {
        ("one", "two", "other"),
        ("two", "one", "other"),
    }
    assert start_of(level, 0) is level


def test_patterns_that_are_none_or_match_nothing_are_refused() -> None:
    for value, where, message in (
        ("true", "", '"shuffled_names" must be a list, not true or false.'),
        ("[3]", "[0]", "This must be text, not a number."),
        ('["*", "a"]', "[1]", '"shuffled_names" has "a", but no robot or beacon has such a name.'),
        (str(["*"] * 1001), "", "There are 1001 shuffled_names; at most 1000 are allowed."),
    ):
        with pytest.raises(LevelError) as raised:
            read_native(f"shuffled_names = {value}\n{SHORT}", "short", "short.toml")
        assert raised.value.message == message
        assert raised.value.place == f"short.toml: shuffled_names{where}"
