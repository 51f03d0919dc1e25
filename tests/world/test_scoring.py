"""Teams in level files, and what each part of a score counts, whatever the order in a file."""

import itertools
import math
import random
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.values import Desire
from logical_robots_tui.world import Area, Beacon, Level, Robot, Score, Team, World, load_level
from logical_robots_tui.world.dynamics import points
from logical_robots_tui.world.world import change_state
from tests.world.making import levels, make_level
from tests.world.test_native import SMALL, place, refusal, write

HILL = Area("hill", 150, 50, 30)
TEAMS = (Team("red"), Team("blue"))
GO, STAY = Desire(1, 1), Desire(0, 0)


def match(
    *robots: Robot,
    scores: tuple[Score, ...],
    ticks: int = 100,
    areas: tuple[Area, ...] = (HILL,),
    beacons: tuple[Beacon, ...] = (),
) -> Level:
    level = make_level(robots, areas=areas, beacons=beacons)
    return replace(level, teams=TEAMS, match_ticks=ticks, scores=scores)


def red(x: float, y: float = 50.5, name: str = "Rosa") -> Robot:
    return Robot(name, x, y, team="red")


def blue(x: float, y: float = 50.5, name: str = "Bill") -> Robot:
    return Robot(name, x, y, angle=math.pi, team="blue")


def play(level: Level, ticks: int, desires: Mapping[str, Desire] = {}) -> World:
    world = World(level)
    for _ in range(ticks):
        world.act(desires)
    return world


def result(world: World) -> dict[str, tuple[float, ...]]:
    return points(world.level, world.save())


def test_overlapping_solid_areas_push_alike_in_any_order() -> None:
    areas = tuple(Area(f"gate {x}", x, 50, 30, impenetrable=True) for x in (90, 110, 140))
    places = {
        (world.robots[0].x, world.robots[0].y)
        for order in itertools.permutations(areas)
        for world in [play(match(red(98, 60), scores=(), areas=order), 1)]
    }
    assert len(places) == 1


def test_ground_is_held_by_a_team_alone() -> None:
    level = match(red(110.5), blue(200.5), scores=(Score("hold", "hill", 2),))
    # Rosa is inside after tick 10, Bill after tick 21; they are together from then on.
    assert result(play(level, 30, {"Rosa": GO, "Bill": GO})) == {"red": (22,), "blue": (0,)}
    assert result(play(level, 30, {"Bill": GO})) == {"red": (0,), "blue": (20,)}


def test_most_robots_have_an_area() -> None:
    three = (red(150), blue(150), red(150, name="Ruby"))
    for robots, points_of_red in ((three, 5), (three[:2], 0)):
        world = play(match(*robots, scores=(Score("most", "hill"),)), 5)
        assert result(world) == {"red": (points_of_red,), "blue": (0,)}


def test_areas_of_one_name_count_one_by_one_and_one_that_is_off_gives_nothing() -> None:
    areas = (HILL, replace(HILL, x=50))
    level = match(red(150), red(50, name="Ruby"), blue(250), scores=(Score("hold", "hill"),))
    assert result(play(replace(level, areas=areas), 5))["red"] == (10,)
    off = replace(HILL, on_beacon="bell")
    scores = (Score("hold", "hill"), Score("first", "hill"), Score("near", "hill"))
    level = match(red(150), blue(20), scores=scores, areas=(off,), beacons=(Beacon("bell", 5, 5),))
    assert result(play(level, 5))["red"] == (0, 0, 0)


@pytest.mark.parametrize(("ahead", "first"), [(0, (7, 7)), (1, (7, 0)), (-1, (0, 7))])
def test_the_first_in_an_area_have_points_even_together(ahead: int, first: tuple[int, int]) -> None:
    level = match(red(110.25 + ahead), blue(189.75), scores=(Score("first", "hill", 7),))
    world = play(level, 40, {"Rosa": GO, "Bill": GO})
    assert result(world) == {"red": first[:1], "blue": first[1:]}


def test_beacons_count_once_by_name() -> None:
    beacons = (Beacon("a", 80, 50), Beacon("b", 100, 80), Beacon("b", 100, 20), Beacon("c", 5, 50))
    level = match(red(20), blue(60, 90), scores=(Score("beacons", points=3),), beacons=beacons)
    assert result(play(level, 3)) == {"red": (6,), "blue": (3,)}  # Bill sees c, Rosa a and b


def test_robots_that_can_drive_on_count_as_charged() -> None:
    weak = replace(red(20), has_battery=True, battery_capacity=3.0, battery_consumption_rate=1.0)
    level = match(weak, blue(250), red(30, name="Ruby"), scores=(Score("charged"),))
    world = play(level, 2, {"Rosa": GO})
    assert result(world) == {"red": (2,), "blue": (1,)}
    world.act({"Rosa": GO})
    assert result(world)["red"] == (1,)


def test_who_is_nearer_at_the_end_has_more_and_a_match_ends_after_its_last_tick() -> None:
    level = match(red(150), blue(220), scores=(Score("near", "hill", 100),))
    diagonal = math.hypot(level.width, level.height)
    away = math.hypot(220 - 150, 0.5) - 30
    assert result(World(level))["blue"][0] == pytest.approx(100 * (1 - away / diagonal), abs=1e-3)
    assert result(play(level, 1))["red"] == (100,)
    scores = (Score("hold", "hill"), Score("near", "hill", 10), Score("charged"))
    world = play(match(red(150), blue(20), scores=scores, ticks=4), 4)
    before = result(world)
    for _ in range(100):
        world.act({"Rosa": GO})
    assert result(world) == before
    assert before["red"][0] == 4


def test_going_back_takes_the_tallies_back() -> None:
    level = match(red(110.5), blue(250), scores=(Score("hold", "hill"), Score("beacons")))
    world = play(level, 20, {"Rosa": GO})
    state, before = world.save(), result(world)
    for _ in range(10):
        world.act({"Rosa": GO})
    assert result(world) != before
    world.restore(state)
    assert result(world) == before
    with pytest.raises(ValueError, match="another level"):
        world.restore(replace(state, tallies=()))


def test_an_edit_keeps_the_score_unless_it_changes_what_is_scored() -> None:
    level = match(red(150), blue(250), scores=(Score("hold", "hill"),))
    assert play(make_level(), 3).save().tallies == ()
    state = play(level, 5).save()
    moved = replace(level, areas=(replace(HILL, x=50),))
    assert change_state(state, level, moved, {}).tallies == state.tallies == ((5, 0),)
    other = replace(level, scores=(Score("most", "hill"),))
    assert change_state(state, level, other, {}).tallies == ((0, 0),)


KINDS = (
    *(Score(kind, "home", 2) for kind in ("hold", "most", "first", "near")),
    *(Score("beacons"), Score("charged")),
)


@st.composite
def matches(draw: st.DrawFn) -> Level:
    level = draw(levels())
    names = [robot.name for robot in level.robots]
    teams = draw(st.permutations(["red", "blue", "green"]))[: len(names)]
    wanted = [*teams, *(draw(st.sampled_from(teams)) for _ in names[len(teams) :])]
    near = st.floats(0, 40)
    robots = tuple(
        replace(robot, team=team, x=draw(near), y=draw(near))
        for robot, team in zip(level.robots, wanted, strict=True)
    )
    known = tuple(Team(name) for name in teams)
    return replace(level, robots=robots, teams=known, match_ticks=9, scores=KINDS)


@settings(deadline=None)
@given(matches(), st.integers(0, 2**32))
def test_the_order_of_robots_and_teams_decides_nothing(level: Level, seed: int) -> None:
    chance = random.Random(seed)
    robots, teams = list(level.robots), list(level.teams)
    chance.shuffle(robots)
    chance.shuffle(teams)
    one, other = World(level), World(replace(level, robots=tuple(robots), teams=tuple(teams)))
    for _ in range(12):
        rows = {row["robot_name"]: row for row in one.sense()}
        assert rows == {row["robot_name"]: row for row in other.sense()}
        desires = {name: Desire(chance.uniform(-1, 1), chance.uniform(-1, 1)) for name in rows}
        one.act(desires)
        other.act(desires)
        assert {r.name: r for r in one.robots} == {r.name: r for r in other.robots}
        assert result(one) == result(other)
        for mine, same in zip(one.areas, other.areas, strict=True):
            assert set(mine.visitors) == set(same.visitors)


MATCH = Path(__file__).with_name("match.toml").read_text("utf-8")
IN_TEAMS = MATCH.partition("\n[match]")[0]


def test_robots_may_be_in_teams(tmp_path: Path) -> None:
    level = load_level(write(tmp_path, IN_TEAMS))
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
    [*((IN_TEAMS, *case) for case in BAD_TEAMS), *((MATCH, *case) for case in BAD_SCORES)],
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
