"""Teams in level files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.world import Team, load_level
from tests.world.test_native import SMALL, place, refusal, write

if TYPE_CHECKING:
    from pathlib import Path

TEAMS = (
    SMALL.replace("y = 15", 'y = 15\nteam = "red"')
    + """
[[robots]]
name = "Bob"
x = 25
y = 15
team = "blue"

[[teams]]
name = "red"
program = "herd"

[[teams]]
name = "blue"
"""
)


def test_robots_may_be_in_teams(tmp_path: Path) -> None:
    level = load_level(write(tmp_path, TEAMS))
    assert level.teams == (Team("red", "herd"), Team("blue"))
    assert [robot.team for robot in level.robots] == ["red", "blue"]


BAD_TEAMS = [
    ('team = "red"\n', "", "robots[0].team", 'Robot "Ann" has no team.'),
    (
        'team = "red"',
        'team = "rad"',
        "robots[0].team",
        'Robot "Ann" is in "rad", but there is no such team.',
    ),
    ('team = "red"', 'team = "blue"', "teams[0]", 'Team "red" has no robots.'),
    ('name = "blue"', 'name = "red"', "robots[1].team", "there is no such team."),
    (
        'name = "blue"',
        'name = "blue"\n[[teams]]\nname = "red"',
        "teams[2].name",
        'Two teams are called "red".',
    ),
    ('program = "herd"', "program = 3", "teams[0].program", '"program" must be text'),
    ('[[teams]]\nname = "blue"', "", "robots[1].team", "there is no such team."),
]


@pytest.mark.parametrize(("old", "new", "where", "message"), BAD_TEAMS)
def test_a_mistake_in_teams_is_refused_at_its_key(
    tmp_path: Path, old: str, new: str, where: str, message: str
) -> None:
    assert old in TEAMS
    error = refusal(tmp_path, TEAMS.replace(old, new, 1))
    assert place(error) == where
    assert message in error.message


def test_a_team_that_is_not_listed_tells_where_to_list_it(tmp_path: Path) -> None:
    error = refusal(tmp_path, SMALL.replace("y = 15", 'y = 15\nteam = "red"'))
    assert place(error) == "robots[0].team"
    assert error.hint == "List the teams as [[teams]]."
