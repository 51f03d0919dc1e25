"""Teams in level files."""

from pathlib import Path

import pytest

from logical_robots_tui.world import Score, Team, load_level
from tests.world.test_native import SMALL, place, refusal, write

MATCH = Path(__file__).with_name("match.toml").read_text("utf-8")
TEAMS = MATCH.partition("\n[match]")[0]


def test_robots_may_be_in_teams(tmp_path: Path) -> None:
    level = load_level(write(tmp_path, TEAMS))
    assert level.teams == (Team("red", "herd"), Team("blue"))
    assert [robot.team for robot in level.robots] == ["red", "blue"]


NO_TEAM = 'Robot "Ann" is in "rad", but there is no such team.'
AGAIN = 'name = "blue"\n[[teams]]\nname = "red"'
BAD_TEAMS = [
    ('team = "red"\n', "", "robots[0].team", 'Robot "Ann" has no team.'),
    ('team = "red"', 'team = "rad"', "robots[0].team", NO_TEAM),
    ('team = "red"', 'team = "blue"', "teams[0]", 'Team "red" has no robots.'),
    ('name = "blue"', 'name = "red"', "robots[1].team", "there is no such team."),
    ('name = "blue"', AGAIN, "teams[2].name", 'Two teams are called "red".'),
    ('program = "herd"', "program = 3", "teams[0].program", '"program" must be text'),
    ('[[teams]]\nname = "blue"', "", "robots[1].team", "there is no such team."),
]


def test_a_match_has_a_length_and_scores(tmp_path: Path) -> None:
    level = load_level(write(tmp_path, MATCH))
    assert level.match_ticks == 50
    assert level.scores == (Score("hold", "hill", 1), Score("beacons", "", 2.5))
    assert not level.divided_charge


BEACONS = "\n".join(f'[[beacons]]\nname = "b{i}"\nx = 15\ny = 15' for i in range(61))
BAD_SCORES = [
    ("ticks = 50", "ticks = 0", "match.ticks", '"ticks" must be 1 or more, not 0.'),
    ("ticks = 50", "", "match.ticks", '"ticks" is missing.'),
    ("[match]\nticks = 50", "", "scores[0]", "A score needs a match."),
    ('kind = "hold"', "", "scores[0].kind", '"kind" is missing.'),
    ('kind = "hold"', 'kind = "own"', "scores[0].kind", '"kind" must be "hold" or "most" or '),
    ('area = "hill"', "", "scores[0].area", '"area" is missing.'),
    ('area = "hill"', 'area = "Hill"', "scores[0].area", 'There is no area "Hill".'),
    ("points = 2.5", "points = -1", "scores[1].points", '"points" must be 0 or more, not -1.'),
    ("points = 2.5", 'area = "hill"', "scores[1].area", '"beacons" is scored everywhere'),
    ("points = 2.5", BEACONS, "scores[1].kind", "At most 60 beacons of different names"),
]


@pytest.mark.parametrize(
    ("text", "old", "new", "where", "message"),
    [*((TEAMS, *case) for case in BAD_TEAMS), *((MATCH, *case) for case in BAD_SCORES)],
    ids=range(len(BAD_TEAMS) + len(BAD_SCORES)),
)
def test_a_mistake_in_teams_or_in_a_score_is_refused_at_its_key(
    tmp_path: Path, text: str, old: str, new: str, where: str, message: str
) -> None:
    assert old in text
    error = refusal(tmp_path, text.replace(old, new, 1))
    assert place(error) == where
    assert message in error.message


def test_a_match_needs_teams_which_a_hint_tells_where_to_list(tmp_path: Path) -> None:
    error = refusal(tmp_path, SMALL + "[match]\nticks = 5\n")
    assert (place(error), error.message) == ("match", "A match needs teams.")
    error = refusal(tmp_path, SMALL.replace("y = 15", 'y = 15\nteam = "red"'))
    assert (place(error), error.hint) == ("robots[0].team", "List the teams as [[teams]].")
