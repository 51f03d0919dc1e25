"""Changing the level under way: past ticks stay as they were, and all come back exactly."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.game import Frame, Game
from logical_robots_tui.mind import Program
from logical_robots_tui.world import Area, Beacon, Level, Robot, Visibility
from logical_robots_tui.world.world import Pose
from tests.game.playing import BACKWARDS, COUNTER, Play
from tests.waiting import PATIENCE
from tests.world.making import make_level

LEVEL = make_level(
    (Robot("Ada", 30.5, 30.5), Robot("Bo", 30.5, 50.5)),
    width=120,
    height=80,
    areas=(Area("Home", 90, 40, 12, on_beacon="Lamp"),),
)


def walled(level: Level, x: int, wall: bool = True) -> Level:
    walls = level.walls.copy()
    walls[20:60, x : x + 6] = wall
    walls.flags.writeable = False
    return replace(level, walls=walls)


def with_robot(level: Level, name: str) -> Level:
    names = {robot.name for robot in level.robots}
    return level if name in names else replace(level, robots=(Robot(name, 60, 20), *level.robots))


def without_robot(level: Level, at: int) -> Level:
    robots = list(level.robots)
    del robots[at % len(robots)]
    return replace(level, robots=tuple(robots)) if robots else level


EDITS: list[Callable[[Level], Level]] = [
    lambda level: walled(level, 50),
    lambda level: walled(level, 50, wall=False),
    lambda level: walled(level, 33),
    lambda level: with_robot(level, "Cy"),
    lambda level: without_robot(level, 0),
    lambda level: without_robot(level, 1),
    lambda level: replace(level, beacons=(*level.beacons, Beacon("Lamp", 60, 30))),
    lambda level: replace(level, areas=(Area("New", 40, 40, 9), *level.areas)),
    lambda level: replace(level, areas=level.areas[1:]),
    lambda level: replace(level, visibility=Visibility("all", "all")),
    lambda level: level,
]
POSES: list[dict[str, Pose]] = [{}, {"Ada": (70, 20, 1.5)}, {"Bo": (20, 70, -1.0)}]

edits = st.tuples(st.just("edit"), st.integers(0, len(EDITS) - 1), st.integers(0, len(POSES) - 1))
deeds = st.one_of(
    st.tuples(st.just("step"), st.integers(1, 40), st.just(0)),
    st.tuples(st.just("go to"), st.integers(0, 200), st.just(0)),
    edits,
)


def edited(played: Game, edit: int, poses: int) -> Frame:
    """Change the level under way, and put elsewhere who is still there."""
    level = EDITS[edit](played.level)
    names = {robot.name for robot in level.robots}
    there = {name: pose for name, pose in POSES[poses].items() if name in names}
    return played.change_level(level, there)


async def reached(played: Game, tick: int) -> None:
    """Wait until a game that runs is that far."""
    there = asyncio.Event()
    played.listen(lambda frame: there.set() if frame.tick >= tick else None)
    await asyncio.wait_for(there.wait(), PATIENCE)


@cache
def counter() -> Program:
    return Program.compile(COUNTER)


@pytest.fixture
def played(play: Play) -> Game:
    return play()


@settings(max_examples=min(25, settings().max_examples), deadline=None)
@given(st.lists(deeds, max_size=14))
def test_whatever_is_changed_when_every_tick_comes_back_as_it_was(
    done: list[tuple[str, int, int]],
) -> None:
    async def play() -> None:
        played = Game(LEVEL, counter())
        branch: list[tuple[Frame, Level]] = [(played.frame, LEVEL)]

        async def step() -> None:
            frame = await played.step()
            if frame.tick == len(branch):
                branch.append((frame, played.level))
            seen(frame)

        def seen(frame: Frame) -> None:
            then, level = branch[frame.tick]
            assert frame == then
            assert np.array_equal(played.level.walls, level.walls)
            assert played.level.robots == level.robots

        try:
            for what, number, more in done:
                if what == "step":
                    for _ in range(number):
                        await step()
                elif what == "go to":
                    seen(played.go_to(number % len(branch)))
                else:
                    frame = edited(played, number, more)
                    del branch[frame.tick :]
                    branch.append((frame, played.level))
            seen(played.go_to(0))
            while played.frame.tick < len(branch) - 1:
                await step()
            for tick in range(len(branch) - 1, -1, -1):
                seen(played.go_to(tick))
        finally:
            await played.close()

    asyncio.run(play())


async def test_a_wall_stops_robots_from_the_next_tick_on(played: Game) -> None:
    await played.run_until(tick=20)
    before, original = played.frame, played.level
    assert not before.after.robots[0].blocked
    x = int(before.after.robots[0].x)
    played.change_level(walled(original, x + 2))
    assert played.history.marks.at(20)[0].kind == "edit"
    await played.run_until(tick=30)
    assert played.frame.after.robots[0].blocked
    assert played.go_to(19).after.robots == before.before.robots
    assert np.array_equal(played.level.walls, original.walls)
    await played.run_until(tick=21)
    assert not np.array_equal(played.level.walls, original.walls)


async def test_a_robot_is_put_elsewhere_while_the_game_runs(played: Game) -> None:
    running = asyncio.create_task(played.run())
    await reached(played, 5)
    tick = played.change_level(played.level, {"Ada": (150.0, 20.0, 0.0)}).tick
    await reached(played, tick + 3)
    played.pause()
    await running
    after = played.frame_at(tick + 1)
    assert after.before.robots[0].x == 150.0
    assert after.after.robots[0].x == 151.0
    with pytest.raises(ValueError, match="Nobody"):
        played.change_level(played.level, {"Nobody": (0, 0, 0)})


async def test_a_tick_that_was_gone_back_to_comes_back_as_changed(played: Game) -> None:
    await played.run_until(tick=5)
    played.back()
    played.go_to(5)
    moved = played.change_level(played.level, {"Ada": (75.0, 20.0, 0.0)})
    await played.step()
    assert played.back().after == moved.after


async def test_beginning_again_does_not_do_again_what_was_done_by_hand(played: Game) -> None:
    original = played.level
    await played.run_until(tick=10)
    plain = await played.step()
    played.go_to(10)
    played.change_level(walled(original, 100), {"Bo": (20.0, 40.0, 0.0)})
    await played.run_until(tick=15)
    played.restart(original)
    assert (await played.run_until(tick=11)) == plain
    assert played.level is original
    assert played.history.other is not None
    played.restart(walled(original, 100))
    assert played.history.level_at(0).walls[30, 100]


async def test_beginning_again_takes_back_who_was_put_elsewhere_at_the_start(played: Game) -> None:
    original = played.frame
    level = played.level
    played.change_level(level, {"Ada": (60.0, 25.0, 0.0)})
    await played.run_until(tick=3)
    assert played.restart(level) == original
    assert played.frame_at(0) == original
    frame = await played.step()
    assert frame.after.robots[0].x == pytest.approx(original.after.robots[0].x + 1)


async def test_another_program_begins_another_future_before_an_edit(played: Game) -> None:
    await played.run_until(tick=10)
    played.change_level(played.level, {"Ada": (150.0, 20.0, 0.0)})
    await played.run_until(tick=12)
    played.go_to(5)
    played.use(Program.compile(BACKWARDS))
    frame = await played.run_until(tick=11)
    assert frame.after.robots[0].x < 50
    played.change_branch()
    assert played.frame.after.robots[0].x > 150


async def test_a_new_robot_thinks_from_the_next_tick_on_and_marks_know_who(played: Game) -> None:
    await played.run_until(tick=40)
    level = with_robot(played.level, "Cy")
    frame = played.change_level(level)
    assert (frame.decisions, frame.memories) == ((), {"Cy": "", "Ada": 40, "Bo": 40})
    while played.frame.tick < 120:
        await played.step()
    assert played.frame.memories == {"Cy": 80, "Ada": 120, "Bo": 120}
    memory = next(mark for mark in played.history.marks.at(60) if mark.kind == "memory")
    assert set(memory.names) == {"Ada", "Bo", "Cy"}
    assert played.history.marks.nearest(0, 1, (), "Cy") == 41
    played.change_level(without_robot(level, 1))
    while played.frame.tick < 130:
        await played.step()
    assert set(played.history.marks.at(125)[0].names) == {"Cy", "Bo"}
