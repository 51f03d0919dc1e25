"""What teams have achieved is part of the world: travelling, recordings and replays keep it."""

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.replay import Replay, _hash_of, load_replay
from logical_robots_tui.world import Level, World, load_level
from logical_robots_tui.world.dynamics import points
from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import COUNTER, HALL, Play
from tests.game.test_replay import again, first_stage, kept, written
from tests.game.test_run import frames

MATCH = """
match = {ticks = 100}
teams = [{name = "red"}, {name = "blue"}]
scores = [{kind = "hold", area = "Door"}, {kind = "near", area = "Door", points = 10}]
""" + (
    HALL.replace('name = "Ada"', 'name = "Ada"\nteam = "red"')
    .replace('name = "Bo"\nx = 40', 'name = "Bo"\nx = 30\nteam = "blue"')
    .replace('goal_for = ["Ada", "Bo"]', "")
)
LEVEL = read_native(MATCH, "match", "")
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
