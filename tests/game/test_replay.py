"""Replays: what a history holds comes back from its file, and nothing else is taken for one."""

import asyncio
import gc
import json
import lzma
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace as changed

from logical_robots_tui.editing.level_text import write_native
from logical_robots_tui.errors import InputError
from logical_robots_tui.game import Game
from logical_robots_tui.game.replay import Replay, Verifier, gather, load_replay, play_into
from logical_robots_tui.mind import Program
from logical_robots_tui.world.level import alike
from tests.damage import Change, changes
from tests.damage import changed as damaged
from tests.game.playing import BACKWARDS, Play, hall
from tests.game.test_live_edits import LEVEL, counter, edited, edits
from tests.mind.hostile.bounds import bounded_memory, bounded_work


async def kept(played: Game, **options: bool) -> Replay:
    return await gather(played.history, write_native, lambda _program: "counter", **options)


@asynccontextmanager
async def again(replay: Replay) -> AsyncIterator[tuple[Game, Verifier]]:
    programs = [Program.compile(texts) for texts in replay.programs.values()]
    other = Game(replay.levels[0], programs[0])
    try:
        yield other, await play_into(other, replay, programs, other.use)
    finally:
        await other.close()


def written(replay: Replay, folder: Path) -> Path:
    path = folder / "a.replay"
    path.write_bytes(replay.to_bytes())
    return path


deeds = st.one_of(
    st.tuples(st.just("run"), st.integers(1, 130), st.just(0)),
    edits,
    st.tuples(st.just("use"), st.sampled_from([0, 1]), st.just(0)),
)


@settings(max_examples=3 if settings().max_examples < 20 else 20, deadline=None)
@given(st.lists(deeds, max_size=8))
def test_whatever_was_done_comes_back_exactly(
    tmp_path_factory: pytest.TempPathFactory, done: list[tuple[str, int, int]]
) -> None:
    async def play() -> None:
        played = Game(LEVEL, counter())
        for what, number, more in [*done, ("run", 3, 0)]:
            if what == "run":
                end = played.frame.tick + number
                while played.frame.tick < end:
                    await played.run_until(tick=end)
            elif what == "use":
                played.use((counter(), Program.compile(BACKWARDS))[number])
            else:
                edited(played, number, more)
        replay = load_replay(written(await kept(played), tmp_path_factory.mktemp("replay")))
        async with again(replay) as (other, verifier):
            assert verifier.difference is None
            assert other.history.last == played.history.last
            states = list(replay.states())
            for tick in range(played.history.last + 1):
                assert other.go_to(tick) == played.go_to(tick)
                assert states[tick] == played.frame.after
                assert alike(other.level, played.level)
            assert replay.to_bytes() == (await kept(other)).to_bytes()
        await played.close()

    asyncio.run(play())


async def test_a_history_that_has_lost_its_beginning_is_kept_from_there_on(play: Play) -> None:
    played = play(counter(), LEVEL, history=70)
    await played.run_until(tick=300)
    replay = await kept(played)
    assert replay.first == played.history.first - 1 > 200
    async with again(replay) as (other, verifier):
        assert verifier.difference is None
        assert other.history.first == played.history.first
        assert other.go_to(290) == played.go_to(290)


async def test_the_robots_do_what_they_did_whatever_the_program_would_do_or_without_one(
    play: Play, tmp_path: Path
) -> None:
    played = play()
    await played.run_until(tick=30)
    replay = await kept(played)
    texts = (changed(replay.texts[0], text=BACKWARDS),)
    async with again(changed(replay, texts=texts)) as (other, verifier):
        assert verifier.difference == (1, "Ada decides differently.")
        assert other.go_to(30).after == played.frame.after
        other.go_to(10)
        other.forget_future()
        back = await other.step()  # from here on its own program decides
        assert back.after.robots[0].x < back.before.robots[0].x
    without = load_replay(written(await kept(played, with_programs=False), tmp_path))
    assert not without.has_programs
    assert b"Sensor" not in msgspec.msgpack.encode(without)
    async with again(without) as (other, verifier):
        assert verifier.difference is None
        assert other.frame.after == played.frame.after


async def test_another_world_is_noticed_at_the_next_hash(play: Play) -> None:
    played = play(counter(), LEVEL)
    await played.run_until(tick=250)
    replay = await kept(played)
    assert list(replay.hashes) == [100, 200, 250]
    other = changed(replay, hashes={**replay.hashes, 200: b"12345678"})
    async with again(other) as (_, verifier):
        assert verifier.difference == (200, "The state of the world differs.")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Replay:
    async def play() -> Replay:
        played = Game(hall(tmp_path_factory.mktemp("whole")), counter())
        await played.run_until(tick=20)
        played.change_level(played.level, {"Ada": (60.0, 25.0, 1.0)})
        await played.run_until(tick=40)
        replay = await kept(played)
        await played.close()
        return replay

    return asyncio.run(play())


FIRST_LINE = b"logical-robots replay 2\n"


def packed(body: bytes, first_line: bytes = FIRST_LINE) -> bytes:
    content = lzma.compress(body, preset=0)
    return first_line + sha256(content).digest() + content


def test_what_is_not_a_replay_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "false.replay"
    with pytest.raises(InputError, match="can't be read"):
        load_replay(path)
    for content, reason in (
        (b"", "its first line is wrong"),
        (b"hello", "its first line is wrong"),
        (b"logical-robots replay 3\nabc", "another version"),
        (FIRST_LINE + bytes(40), "damaged"),
        (FIRST_LINE + sha256(b"abc").digest() + b"abc", "is not a replay file"),
        (FIRST_LINE + bytes(64_000_000), "more than 64,000,000 bytes"),
        (packed(msgspec.msgpack.encode([1, 2])), "is not a replay file"),
        (packed(b"\x91" * 100_000), "is not a replay file"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=reason) as caught:
            load_replay(path)
        assert caught.value.place == str(path)


MANY = 1_500_000
STATE = {"tick": 0, "robots": [], "areas": [], "won_at": None, "tallies": []}
STAGE = {"level": "", "state": STATE, "memories": "{}", "is_decided": False, "desires": []}
ROBOT = dict.fromkeys(("x", "y", "angle", "battery_level", "left_engine", "right_engine"), 1)
TEAMS = f"# teams: {json.dumps(dict.fromkeys(range(7_000), 0))}"


def bomb(first_line: bytes = FIRST_LINE, **values: object) -> bytes:
    parts = {"name": "", "last": 1, "stages": [STAGE], "texts": [], "hashes": {}}
    return packed(msgspec.msgpack.encode({**parts, **values}), first_line)


def in_stage(**values: object) -> bytes:
    return bomb(stages=[{**STAGE, **values}])


def in_state(**values: object) -> bytes:
    return in_stage(state={**STATE, **values})


BOMBS = {
    "zeros": lambda: packed(bytes(300_000_000)),
    "stages": lambda: bomb(stages=[STAGE] * MANY),
    "hashes": lambda: bomb(hashes=dict.fromkeys(range(MANY), b"ab")),
    "robots": lambda: in_state(robots=[{"name": "A", **ROBOT}] * 300_000),
    "visitors": lambda: in_state(areas=[{"name": "A", "visitors": ["ab"] * 9 * MANY}]),
    "tallies": lambda: in_state(tallies=[[]] * 20 * MANY),
    "desires": lambda: in_stage(desires=[b"ab"] * 7 * MANY),
    "desires of stages": lambda: bomb(stages=[{**STAGE, "desires": [b"ab"] * 1_000}] * 9_000),
    "texts": lambda: bomb(texts=[{"tick": 1, "name": "", "text": ""}] * MANY),
    "teams": lambda: bomb(
        b"logical-robots replay 1\n", texts=[{"tick": 1, "name": "", "text": TEAMS}] * 450
    ),
    "ticks": lambda: bomb(last=900_000, stages=[{**STAGE, "desires": [bytes(14_400_000)]}]),
    "memories": lambda: in_stage(memories=f"[{'[],' * 9 * MANY}1]"),
}
LARGE = [pytest.param(bomb, marks=pytest.mark.slow) for bomb in ("zeros", "stages", "hashes")]


@pytest.mark.sampled
@pytest.mark.parametrize("bomb", [*[*BOMBS][3:], *LARGE])
def test_what_unpacks_to_more_than_memory_should_hold_is_refused(bomb: str, tmp_path: Path) -> None:
    path = tmp_path / "bomb.replay"
    path.write_bytes(BOMBS[bomb]())
    gc.collect()
    with bounded_memory(), pytest.raises(InputError):
        load_replay(path)


def test_memories_that_take_far_more_as_objects_are_refused(whole: Replay, tmp_path: Path) -> None:
    memories = f'{{"Ada":[{"{}," * 1_000_000}1]}}'
    with bounded_memory(), pytest.raises(InputError, match="memories at tick 0 are too large"):
        load_replay(written(first_stage(whole, memories=memories), tmp_path))
    with pytest.raises(InputError, match="more than the 48,000,000"):  # it is not written at all
        first_stage(whole, desires=(bytes(48_000_000),)).to_bytes()


def first_stage(replay: Replay, **values: object) -> Replay:
    first, *rest = replay.stages
    return changed(replay, stages=(changed(first, **values), *rest))


def test_a_forged_replay_is_refused(tmp_path: Path, whole: Replay) -> None:
    text, stage = whole.texts[0], whole.stages[0]
    ada, *others = stage.state.robots
    nowhere = replace(stage.state, robots=(replace(ada, x=float("nan")), *others))
    for forged, reason in (
        (changed(whole, stages=()), "out of bounds"),
        (changed(whole, last=10**9), "out of bounds"),
        (changed(whole, last=0), "out of bounds"),
        (changed(whole, stages=(stage, stage)), "out of order"),
        (changed(whole, hashes={}), "hashes don't belong"),
        (changed(whole, hashes={**whole.hashes, whole.last + 1: bytes(8)}), "hashes don't"),
        (changed(whole, hashes={whole.last: b"short"}), "hashes don't belong"),
        (changed(whole, texts=()), "out of order"),
        (changed(whole, texts=(text, text)), "out of order"),
        (first_stage(whole, level="[[robots]]"), "is not a replay file"),
        (first_stage(whole, desires=()), "don't act"),
        (first_stage(whole, desires=(b"1", b"2")), "don't act"),
        (first_stage(whole, is_decided=True), "does not fit"),
        (first_stage(whole, memories="{}"), "does not fit"),
        (first_stage(whole, memories="[1"), "is not a replay file"),
        (first_stage(whole, memories="[" * 100_000), "is not a replay file"),
        (first_stage(whole, state=nowhere), "does not fit"),
    ):
        with pytest.raises(InputError, match=reason):
            load_replay(written(forged, tmp_path))


@pytest.mark.slow
def test_a_replay_of_too_many_stages_or_levels_is_refused(tmp_path: Path, whole: Replay) -> None:
    for forged, reason in (
        (changed(whole, stages=whole.stages * 6000), "length <= 10000"),
        (first_stage(whole, level="#" * 40_000_000), "too many levels"),
    ):
        with pytest.raises(InputError, match=reason):
            load_replay(written(forged, tmp_path))


@given(st.integers(0), st.integers(1, 255))
def test_a_byte_that_was_changed_is_noticed(
    whole: Replay, tmp_path_factory: pytest.TempPathFactory, place: int, flips: int
) -> None:
    content = bytearray(whole.to_bytes())
    content[place % len(content)] ^= flips
    path = tmp_path_factory.mktemp("changed") / "a.replay"
    path.write_bytes(content)
    with pytest.raises(InputError):
        load_replay(path)


@given(changes=changes())
def test_a_replay_whose_content_was_changed_is_read_or_refused(
    whole: Replay, tmp_path_factory: pytest.TempPathFactory, changes: list[Change]
) -> None:
    told = msgspec.msgpack.encode(whole)
    path = tmp_path_factory.mktemp("changed") / "a.replay"
    path.write_bytes(packed(damaged(told, changes)))
    with bounded_memory(), bounded_work(), suppress(InputError):
        list(load_replay(path).states())
