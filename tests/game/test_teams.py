"""Several minds in one world, each about itself; what teams achieve is part of the world."""

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.frame import standing
from logical_robots_tui.game.measuring import play_through
from logical_robots_tui.game.replay import Replay, _hash_of, load_replay
from logical_robots_tui.mind import Limits, Program
from logical_robots_tui.world import Level, World, load_level
from logical_robots_tui.world.dynamics import points
from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import BACKWARDS, COUNTER, HALL, SLOW, Play
from tests.game.test_replay import again, first_stage, kept, written
from tests.game.test_run import frames

MATCH = (
    HALL.replace('name = "Ada"', 'team = "red"\nname = "Ada"')
    .replace('name = "Bo"', 'team = "blue"\nname = "Bo"')
    .replace("[[areas]]", '[[robots]]\nname = "Cy"\nteam = "red"\nx = 60\ny = 25\n\n[[areas]]')
    + '\n[visibility]\nmemory = "all"\nsensor = "all"\n'
    + '\n[[teams]]\nname = "red"\n\n[[teams]]\nname = "blue"\n'
)
NOSY = """
@Visible(Memory, "all");
@Visible(Sensor, "all");
Others(n? += 1) distinct :- Memory(robot_name:);
Seen(n? += 1) distinct :- Sensor(robot_name:);
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {others: m, seen: s}) :-
  Sensor(robot_name:), Others(n: m), Seen(n: s);
Robot(robot_name: "Bo", desire: {left_engine: -1, right_engine: -1}, memory: "mine");
"""


@pytest.fixture
def match() -> Level:
    return read_native(MATCH, "match", "")


def teams(red: str, blue: str) -> Program:
    return Program.compile({"red": red, "blue": blue})


async def test_each_team_follows_its_own_program(match: Level, play: Play) -> None:
    program = teams(COUNTER, BACKWARDS)
    frame = await play(program, match).run_until(tick=5)
    assert [robot.x for robot in frame.after.robots] == [45, 35, 65]
    assert [decision.robot_name for decision in frame.decisions] == ["Ada", "Bo", "Cy"]
    assert play_through(match, program, 30).won_at is None  # the quick loop thinks alike
    assert play_through(match, Program.compile(COUNTER), 100).won_at is not None


async def test_nothing_but_the_team_looked_at_is_visible(match: Level, play: Play) -> None:
    game = play(teams(NOSY, COUNTER), match)  # which asks to see all, and commands the others
    frame = await game.run_until(tick=3)
    two = {"others": 2, "seen": 2}
    assert frame.memories == {"Ada": two, "Bo": 3, "Cy": two}
    assert frame.after.robots[1].x == 43
    (ada, bo, _) = frame.decisions
    assert [notice.kind for notice in ada.notices] == ["unknown robot"]
    assert not bo.notices
    assert len((await game.query("Sensor")).rows) == 2
    assert {row[0] for row in (await game.query("Memory")).rows} == {"Ada", "Cy"}
    here = game.frame
    game.look_at("blue")
    assert game.frame is here
    (row,) = (await game.query("Robot")).rows
    assert row[0] == "Bo"


async def test_looking_at_another_team_changes_nothing(match: Level, play: Play) -> None:
    plain = play(teams(NOSY, COUNTER), match)
    looking = play(teams(NOSY, COUNTER), match)
    for tick in range(1, 9):
        looking.look_at("red" if tick % 2 else "blue")
        assert await plain.step() == await looking.step()
    marks = looking.history.marks
    assert all(mark.kind != "program" for tick in range(9) for mark in marks.marks_at(tick))
    looking.go_to(3)
    assert await looking.run_until(tick=8) == plain.frame
    assert [tick for tick, _ in looking.history.programs(8)] == [1]


async def test_one_program_may_play_every_team(match: Level, play: Play) -> None:
    alone = NOSY[: NOSY.index('Robot(robot_name: "Bo"')]
    frame = await play(alone, match).step()
    two, one = {"others": 2, "seen": 2}, {"others": 1, "seen": 1}
    assert frame.memories == {"Ada": two, "Bo": one, "Cy": two}


FLOOD = """
Long(x) = (if Length(x) < 1 then "0123456789" else x ++ x ++ x ++ x);
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: Long(memory)) :-
  Sensor(robot_name:), Memory(robot_name:, memory:);
"""


async def test_a_team_out_of_budget_or_memory_costs_no_other_one(match: Level, play: Play) -> None:
    slow = play(teams(SLOW, COUNTER), match, limits=Limits(think_steps=300_000))
    frame = await slow.run_until(tick=3)
    assert frame.memories["Bo"] == 3
    assert not frame.decisions[1].notices
    assert {notice.kind for notice in frame.decisions[0].notices} == {"failed"}
    assert frame.is_reliable
    flooded, alone = play(teams(FLOOD, COUNTER), match), play(teams(COUNTER, COUNTER), match)
    for _ in range(15):
        frame, quiet = await flooded.step(), await alone.step()
        assert frame.memories["Bo"] == quiet.memories["Bo"]
        assert not frame.decisions[1].notices
    assert frame.decisions[0].notices


SCORED = f'match = {{ticks = 8}}\n{MATCH}\n[[scores]]\nkind = "near"\narea = "Door"\npoints = 9\n'


async def test_a_match_ends_and_may_go_on(play: Play) -> None:
    game = play(teams(COUNTER, BACKWARDS), read_native(SCORED, "scored", ""))
    await game.run_until(tick=50)
    assert game.frame.tick == 8
    scores = standing(game.level, game.frame.after)
    assert scores["red"] > scores["blue"]
    game.back(3)
    assert standing(game.level, game.frame.after)["red"] < scores["red"]
    await game.run()
    assert game.frame.tick == 8
    await game.run_until(tick=12)
    assert game.frame.tick == 12
    assert standing(game.level, game.frame.after) == scores


TALLIED = """
match = {ticks = 100}
teams = [{name = "red"}, {name = "blue"}]
scores = [{kind = "hold", area = "Door"}, {kind = "near", area = "Door", points = 10}]
""" + (
    HALL.replace('name = "Ada"', 'name = "Ada"\nteam = "red"')
    .replace('name = "Bo"\nx = 40', 'name = "Bo"\nx = 30\nteam = "blue"')
    .replace('goal_for = ["Ada", "Bo"]', "")
)
LEVEL = read_native(TALLIED, "match", "")
TICKS = 120


@pytest.mark.usefixtures("folder")
async def test_each_tick_of_a_match_comes_back_in_three_ways(tmp_path: Path, play: Play) -> None:
    game = play(COUNTER, LEVEL)
    heard = [game.frame.after]
    game.listen(lambda frame: heard.append(frame.after))
    while game.frame.tick < TICKS:
        await game.run_until(tick=TICKS)
    seen = heard[:]
    assert points(LEVEL, seen[70])["red"][0] == 12  # before the other one arrives
    assert seen[100].tallies == seen[TICKS].tallies
    assert len({state.tallies for state in seen}) > 50
    assert [game.go_to(tick).after for tick in range(TICKS + 1)] == seen
    for _ in range(2):  # the second one reads what the first one recorded
        assert [frame.after for frame in await frames(LEVEL, TICKS)] == seen
    replay = load_replay(written(await kept(game), tmp_path))
    assert list(replay.states()) == seen
    async with again(replay) as (other, verifier):
        assert verifier.difference is None
        assert other.go_to(50).after == seen[50]


async def test_a_replay_with_other_tallies_is_refused(tmp_path: Path, play: Play) -> None:
    game = play(COUNTER, LEVEL)
    await game.run_until(tick=5)
    replay = await kept(game)
    for wrong in ((), ((1, 2),), ((1, 2), (1,)), ((-1, 0), (0, 0))):
        state = replace(replay.stages[0].state, tallies=wrong)
        with pytest.raises(InputError, match="does not fit the level"):
            load_replay(written(first_stage(replay, state=state), tmp_path))


async def test_a_replay_from_before_there_were_scores_is_still_read(play: Play) -> None:
    game = play()
    await game.run_until(tick=5)
    replay = await kept(game)
    told = msgspec.msgpack.decode(msgspec.msgpack.encode(replay))
    for stage in told["stages"]:
        assert stage["state"].pop("tallies") == []
    old = msgspec.msgpack.decode(msgspec.msgpack.encode(told), type=Replay)
    assert old == replay
    async with again(old) as (_, verifier):
        assert verifier.difference is None


def test_the_hash_of_a_world_without_a_score_is_what_it_always_was(level: Level) -> None:
    world = World(load_level("11-the-gate"))
    world.act({})
    assert _hash_of(world.save()).hex() == "bc3d5dae889711ff"
    match = World(LEVEL)
    assert _hash_of(match.save()) != _hash_of(World(level).save())
