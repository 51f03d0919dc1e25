"""Predicates that are asked row by row of others are computed once, and mean the same."""

from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import ROBOT, row, slow, think

GAPS = Path(__file__).with_name("gaps.l").read_text("utf-8")
"""The widest gap between what is near: for each pair of rays it is asked what is between them."""


def looking(count: int) -> list[Any]:
    """Robots that see something near at two places, each at others."""
    near = (20, "wall", "wall")
    return [row(f"R{n}", sees={n % 9: near, 12 + n % 17: near}) for n in range(count)]


@pytest.mark.parametrize(
    ("visible", "robots"),
    [("own", 3), ("all", 3), slow("own", 1), slow("seen", 1), slow("all", 1), slow("seen", 3)],
)
def test_gaps_are_found_as_the_plain_way_finds_them(visible: Any, robots: int) -> None:
    found = think(GAPS, looking(robots), {}, memory=visible)
    assert len({decision.memory for decision in found}) == robots
    assert not [decision.notices for decision in found if decision.notices]


@pytest.mark.parametrize("robots", [3, 33])
def test_a_query_that_is_asked_for_each_pair_is_computed_once(robots: int) -> None:
    program = Program.compile(GAPS)
    with closing(Mind(program)) as mind:
        plan = mind.query_plan("Robot", looking(robots), {}).plan
    assert [line for line in plan if "MATERIALIZE" in line and "Blocked" in line]
    (asked,) = [line for line in plan if "SEARCH" in line and "Blocked" in line]
    assert "AUTOMATIC COVERING INDEX" in asked
    for text in (program.tuned["Robot"].together, *program.tuned["Robot"].crowd):
        assert text.count("Blocked AS MATERIALIZED") == 1


def test_each_robot_of_a_crowd_has_its_own_gaps() -> None:
    crowd = looking(33)
    with closing(Mind(Program.compile(GAPS))) as mind:
        assert mind.think(crowd, {}) == [mind.think([one], {})[0] for one in crowd]


def test_a_query_that_is_asked_once_a_robot_is_computed_once_where_all_see_everything() -> None:
    text = f"""
    Near(robot_name:, distance? Min= r.distance) distinct :-
      Sensor(robot_name:, sensor:), r in sensor.radar;
    {ROBOT} m = Max{{d :- Near(robot_name:, distance: d)}};
    """
    robot = Program.compile(text).tuned["Robot"]
    assert "Near AS MATERIALIZED" in robot.sql
    assert "Near AS MATERIALIZED" not in robot.together
    for sql in (robot.sql, robot.together):
        assert "JSON_EACH" not in sql
    found = think(text, looking(7), {}, memory="all", sensor="all")
    assert [decision.memory for decision in found] == [20] * 7
