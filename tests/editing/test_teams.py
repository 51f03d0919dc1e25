"""Saving levels of teams with their scores, and those of the web platform: nothing is added."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.editing.entities import add, change, duplicate, set_words
from logical_robots_tui.editing.files import rewrite_text, save_level
from logical_robots_tui.editing.level_text import lost_in_web, write_native, write_web
from logical_robots_tui.world import Area, Level, LevelError, Robot, Score, Team
from logical_robots_tui.world.level import alike
from logical_robots_tui.world.levels.load import read_web
from tests.editing.test_files import BOB, HOME, after, read, says_no_more
from tests.world.test_scoring import matches

TEAMS = """\
title = "Match"
cell = 10
walls = '''
####
#..#
####
'''

divided_charge = true  # fair
match = {ticks = 50}

# who plays
[[teams]]
name = "red"  # the first
program = "herd"

[[teams]]
name = "blue"

[[scores]]
kind = "hold"
area = "hill"  # the middle

[[scores]]
kind = "charged"
points = 0.5

[[areas]]
name = "hill"
x = 20
y = 15
radius = 5

[[robots]]
name = "Ann"
x = 15
y = 15
team = "red"

[[robots]]
name = "Bob"
x = 25
y = 15
team = "blue"
"""
MATCH = read(TEAMS)


def test_teams_are_written_and_keep_their_comments() -> None:
    assert alike(read(write_native(MATCH)), MATCH)
    moved = change(MATCH, BOB, x=24)
    assert rewrite_text(TEAMS, moved) == TEAMS.replace("x = 25", "x = 24")
    joined, ref = add(moved, Robot("Cid", 16, 16))
    assert joined.robots[2].team == "red"
    for level in (
        change(joined, ref, team="blue"),
        set_words(MATCH, teams=(Team("red"), Team("blue", "swarm"))),
        set_words(MATCH, match_ticks=60, scores=(Score("near", "hill", 2),)),
    ):
        after(TEAMS, level)


def test_a_score_follows_an_area_that_is_called_otherwise() -> None:
    renamed = change(MATCH, HOME, name="top")
    assert renamed.scores == (Score("hold", "top"), Score("charged", points=0.5))
    twice, ref = duplicate(MATCH, HOME, 2, 0)
    assert change(twice, ref, name="top").scores == MATCH.scores


@settings(deadline=None)
@given(matches())
def test_any_match_is_read_as_it_was_written(level: Level) -> None:
    level = replace(level, areas=(*level.areas, Area("home", 10, 10, 5)))
    assert alike(read(write_native(level)), level)


def test_teams_are_lost_in_the_web_format() -> None:
    level = replace(MATCH, solid_robots=True, all_goals=True, shuffled_names=("*",))
    lost = ["teams", "match_ticks", "scores"]
    lost += ["divided_charge", "solid_robots", "all_goals", "shuffled_names", "visibility"]
    assert lost_in_web(level)[-8:] == lost
    robots = tuple(replace(robot, team="") for robot in level.robots)
    assert read_web(write_web(level), "match", "").robots == robots


def test_a_team_without_robots_is_not_saved(tmp_path: Path) -> None:
    path = tmp_path / "level.toml"
    with pytest.raises(LevelError, match='Team "blue" has no robots'):
        save_level(replace(MATCH, robots=MATCH.robots[:1]), path)
    assert not path.exists()


DIGITS, FLAGS, NAMES = st.integers(0, 9), st.booleans(), st.sampled_from(["", "a"])
PLACED = {"name": st.text(st.sampled_from("abc"), min_size=1), "x": DIGITS, "y": DIGITS}
COLORED = {**PLACED, "color": st.just("red")}
WEB_LEVELS = st.fixed_dictionaries(
    {
        "width": st.just(3),
        "height": st.just(2),
        "walls": st.text("01", min_size=6, max_size=6),
        "robots": st.lists(
            st.fixed_dictionaries(
                COLORED,
                optional={
                    "angle": st.floats(-9, 9),
                    "has_battery": FLAGS,
                    "can_charge": FLAGS,
                    "battery_capacity": DIGITS,
                    "battery_consumption_rate": st.floats(0, 9),
                },
            ),
            min_size=1,
            unique_by=lambda robot: robot["name"],
        ),
        "beacons": st.lists(st.fixed_dictionaries(PLACED, optional={"charging_station": FLAGS})),
        "areas": st.lists(
            st.fixed_dictionaries(
                {**COLORED, "radius": DIGITS, "victory_robots": st.just(["a"])},
                optional={
                    "on_beacon": NAMES,
                    "off_beacon": NAMES,
                    "sticky_switch": FLAGS,
                    "impenetrable": FLAGS,
                },
            )
        ),
    }
)


@settings(deadline=None)
@given(WEB_LEVELS)
def test_nothing_is_added_to_a_level_on_its_way_there_and_back(written: dict[str, Any]) -> None:
    says_no_more(read(write_native(read_web(json.dumps(written), "level", ""))), written)
