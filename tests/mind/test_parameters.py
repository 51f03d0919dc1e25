"""Predicates that are left open for `:=` to fill in."""

from contextlib import closing

import pytest

from logical_robots_tui.mind import Mind, Program, ProgramError, QueryError
from tests.mind.rows import ROBOT, row, think

PATTERN = """
Station("Fire");
Mine("Mine");
Spot(robot_name:, ray:) :- Sensor(robot_name:, sensor:), ray in sensor.radar, Post(ray.label);
Worker(robot_name:, distance: ray.distance) :- Spot(robot_name:, ray:);
Firefighter := Worker(Post: Station);
Miner := Worker(Post: Mine);
"""
ROWS = [row("Ada", sees={3: (44, "beacon", "Fire"), 4: (55, "beacon", "Mine")})]

FROM_A_PATTERN = """
Team(robot_name:, distance:) :- Worker(robot_name:, distance:), Allowed(distance);
Quick := Team(Allowed: Near);
QuickMiner := Quick(Post: Mine);
Near(x) :- x in [55, 56];
"""


@pytest.mark.parametrize(
    ("rules", "trade", "distance"),
    [("", "Firefighter", 44), ("", "Miner", 55), (FROM_A_PATTERN, "QuickMiner", 55)],
)
def test_what_is_left_open_is_filled_in_from_outside(rules: str, trade: str, distance: int) -> None:
    (decision,) = think(f"{PATTERN}{rules}{ROBOT} {trade}(robot_name:, distance: m);", ROWS, {})
    assert (decision.memory, decision.notices) == (distance, ())


def test_a_pattern_has_no_rows_of_its_own_and_says_why() -> None:
    program = Program.compile(f"{PATTERN}{ROBOT} Miner(robot_name:, distance: m);")
    rows = {predicate.name: predicate.has_rows for predicate in program.predicates}
    assert (rows["Spot"], rows["Worker"], rows["Miner"]) == (False, False, True)
    refused = pytest.raises(QueryError, match="Worker uses Post, which is a parameter")
    with closing(Mind(program)) as mind, refused:
        mind.query("Worker", ROWS, {})


@pytest.mark.parametrize(
    "text",
    [
        f"{PATTERN}{ROBOT} Worker(robot_name:, distance: m);",
        PATTERN.replace("(Post:", "(Pots:") + f"{ROBOT} Miner(robot_name:, distance: m);",
    ],
    ids=["the robots use the pattern", "another name is filled in"],
)
def test_what_nobody_fills_in_is_not_defined(text: str) -> None:
    with pytest.raises(ProgramError) as refused:
        Program.compile(text)
    (problem,) = [d for d in refused.value.diagnostics if "Post is not defined" in d.message]
    assert problem.line == 4
