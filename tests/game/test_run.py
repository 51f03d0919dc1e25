"""Runs: any tick, computed once, found again by the next process, and never trusted unseen."""

import asyncio
import os
import subprocess
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import Frame, Game, Run, load_program, run_key
from logical_robots_tui.game import run as running
from logical_robots_tui.game.history import recording
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.paths import is_there
from logical_robots_tui.world import Level, load_level
from tests.game.playing import BACKWARDS, COUNTER
from tests.waiting import PATIENCE

TICKS = 75  # two pieces and some
pytestmark = pytest.mark.usefixtures("folder")


def entry(folder: Path) -> Path:
    (path,) = folder.iterdir()
    return path


@asynccontextmanager
async def opened(
    level: Level, text: str = COUNTER, limits: Limits | None = None
) -> AsyncIterator[Run]:
    run = Run(level, Program.compile(text), limits=limits)
    try:
        yield run
    finally:
        await run.close()


async def frames(
    level: Level, ticks: int = TICKS, text: str = COUNTER, limits: Limits | None = None
) -> list[Frame]:
    async with opened(level, text, limits) as run:
        return [frame async for frame in run.map_ticks(0, ticks, lambda frame, _mind, _stop: frame)]


async def known(level: Level, text: str = COUNTER) -> int:
    async with opened(level, text) as run:
        return run.last


async def played(level: Level, ticks: int, text: str = COUNTER) -> list[Frame]:
    game = Game(level, Program.compile(text))
    seen = [game.frame]
    game.listen(seen.append)
    while game.frame.tick < ticks:
        await game.run_until(tick=ticks)
    await game.close()
    return seen


LARGER = (("10-distributed-mapping", 35), ("13-swarm", 3))
SLOWER = [pytest.param(*larger, marks=pytest.mark.slow) for larger in LARGER]


@pytest.mark.parametrize(("name", "ticks"), [("06-breadcrumbs", 40), *SLOWER])
async def test_a_run_is_what_a_game_plays_and_stays_so_on_disk(
    monkeypatch: pytest.MonkeyPatch, name: str, ticks: int
) -> None:
    level = load_level(name)
    text = load_program(level.solution).text
    expected = await played(level, ticks, text)
    assert await frames(level, ticks, text) == expected
    monkeypatch.setattr(Mind, "think", None)  # it can't think again
    assert await frames(level, ticks, text) == expected


async def test_a_run_goes_on_where_an_earlier_one_ended_in_any_order(level: Level) -> None:
    await frames(level, 20)
    assert await known(level) == 20
    expected = await played(level, TICKS)
    async with opened(level) as run:
        for tick in (70, 3, 0, 33, 32, 31, TICKS):
            assert await run.frame(tick) == expected[tick]
    assert await known(level) == TICKS
    assert await frames(level) == expected


async def test_it_is_told_how_far_a_run_has_come_and_the_longest_is_kept(level: Level) -> None:
    told: list[int] = []
    async with opened(level) as short, opened(level) as run:
        await short.frame(10)
        await run.frame(300, told.append)
        assert told[-1] == 300
        assert told == sorted(told)
        told.clear()
        await run.frame(200, told.append)
        assert not told
    assert await known(level) == 300


async def test_every_value_that_a_robot_may_remember_comes_back(level: Level) -> None:
    values = 'big: 9007199254740993, list: [1, 2.5], text: "ä\\u0001☃", none: []'
    text = COUNTER.replace("memory: n)", f"memory: {{n:, {values}, inner: {{a: {{b: 1.0}}}}}})")
    text = text.replace("else memory + 1", "else memory.n + 1")
    expected = await played(level, 40, text)
    assert expected[-1].memories["Ada"] != expected[-2].memories["Ada"]
    for _ in range(2):
        seen = await frames(level, 40, text)
        assert seen == expected
        assert repr([frame.memories for frame in seen]) == repr([f.memories for f in expected])


async def test_a_key_has_all_a_run_depends_on(
    level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    def key(text: str = COUNTER, limits: Limits | None = None, **changes: Any) -> str:
        return run_key(replace(level, **changes), Program.compile(text), limits or Limits())

    ada, *others = level.robots
    keys = [key(), key(BACKWARDS), key(limits=Limits(think_rows=9)), key(walls=~level.walls)]
    keys += [key(areas=()), key(robots=(replace(ada, x=41.0), *others))]
    await frames(level, 5)
    assert await known(level) == 5
    monkeypatch.setattr(running, "simulation_digest", lambda: b"as it will be")
    assert await known(level) == 0  # a recording by other code is not looked at
    keys.append(key())
    assert len(set(keys)) == len(keys)
    assert key(title="New") == keys[-1]


async def test_of_a_run_that_is_too_long_the_first_ticks_are_kept(
    level: Level, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "MAX_BYTES", 9_000)
    expected = await frames(level, 500)
    assert entry(folder).stat().st_size <= 9_000
    assert 32 <= await known(level) < 500
    assert await frames(level, 500) == expected


async def test_what_is_held_in_memory_is_bounded_and_what_is_dropped_computed_anew(
    level: Level, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = await frames(level, 500)
    monkeypatch.setattr(recording, "MAX_BYTES", 4_000)
    monkeypatch.setattr(recording, "MAX_HELD_BYTES", 8_000)
    async with opened(level) as run:
        assert [frame async for frame in run.map_ticks(0, 500, lambda frame, *_: frame)] == expected
        held = run._recording
        assert sum(len(piece.content) for piece in held._pieces) <= 8_000
        first, *gap, last = [tick for tick in range(500) if held.is_in_gap(tick)]
        assert first > 31
        assert gap == list(range(first + 1, last))
        assert await run.to_end(gap[0]) == expected[-1].after.won_at
        for tick in (first, 500, last, last + 1, 5, 499):
            assert await run.frame(tick) == expected[tick]
    assert await known(level) == first - 1


async def test_recordings_too_large_are_dropped_and_the_oldest_go_first(
    level: Level, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    await frames(level)
    first = entry(folder)
    with monkeypatch.context() as small:
        small.setattr(recording, "MAX_BYTES", first.stat().st_size - 1)
        assert await known(level) == 0
        assert not is_there(first)
    await frames(level, 40)
    os.utime(first, (1, 1))
    monkeypatch.setattr(recording, "MAX_FOLDER_BYTES", int(1.5 * first.stat().st_size))
    await frames(level, 40, BACKWARDS)
    assert not is_there(first)
    assert await known(level, BACKWARDS) == 40


ENDLESS_AT_41 = (
    "N(x) :- x in Range(3000);\nBig(s? += a * b) distinct :- N(a), N(b), N(c);\n"
) + COUNTER.replace("left_engine: 1,", "left_engine: (if n == 41 then Sum{s :- Big(s:)} else 1),")


async def test_what_a_guard_ended_is_not_kept_nor_what_follows(level: Level) -> None:
    late = Limits(think_seconds=0.2, think_steps=10**12)
    seen = await frames(level, 42, ENDLESS_AT_41, late)
    assert [frame.is_reliable for frame in seen] == [True] * 41 + [False] * 2
    async with opened(level, ENDLESS_AT_41, late) as again:
        assert again.last == 40


async def test_what_took_too_many_steps_is_kept(level: Level) -> None:
    few = Limits(think_steps=1_000_000)
    seen = await frames(level, 44, ENDLESS_AT_41, few)
    assert [len(frame.decisions[0].notices) for frame in seen[1:]] == [0] * 40 + [1] * 4
    async with opened(level, ENDLESS_AT_41, few) as again:
        assert (again.last, again.is_reliable_up_to(44)) == (44, True)


async def test_where_nothing_can_be_kept_a_run_just_runs(
    level: Level, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = await played(level, 40)
    (tmp_path / "file").touch()
    for place in (str(tmp_path / "file"), "/proc/nowhere", ""):
        monkeypatch.setenv("LOGICAL_ROBOTS_CACHE_DIR", place)
        assert await frames(level, 40) == expected


SCRIPT = """if True:
    import asyncio, sys
    from tests.game.test_run import frames
    from logical_robots_tui.world import load_level
    for ticks in (5, 40, 20, 90):
        seen = asyncio.run(frames(load_level(sys.argv[1]), ticks))
        print([(frame.tick, frame.after, frame.memories) for frame in seen])
"""


@pytest.mark.slow
def test_many_processes_share_a_run(folder: Path, level: Level) -> None:
    command = [sys.executable, "-c", SCRIPT, level.source]
    processes = [subprocess.Popen(command, stdout=subprocess.PIPE) for _ in range(4)]
    told = {process.communicate(timeout=PATIENCE)[0] for process in processes}
    assert [process.returncode for process in processes] == [0] * 4
    assert len(told) == 1
    assert entry(folder)
    assert asyncio.run(known(level)) == 90
