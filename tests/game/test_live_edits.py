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
from tests.game.playing import BACKWARDS, COUNTER
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
    at %= len(level.robots)
    return replace(level, robots=level.robots[:at] + level.robots[at + 1 :] or level.robots)


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


def edited(game: Game, edit: int, poses: int) -> Frame:
    level = EDITS[edit](game.level)
    names = {robot.name for robot in level.robots}
    there = {name: pose for name, pose in POSES[poses].items() if name in names}
    return game.change_level(level, there)


async def reached(game: Game, tick: int) -> None:
    there = asyncio.Event()
    game.listen(lambda frame: there.set() if frame.tick >= tick else None)
    await asyncio.wait_for(there.wait(), PATIENCE)


@cache
def counter() -> Program:
    return Program.compile(COUNTER)


@settings(max_examples=min(25, settings().max_examples), deadline=None)
@given(st.lists(deeds, max_size=14))
def test_whatever_is_changed_every_tick_comes_back(done: list[tuple[str, int, int]]) -> None:
    async def play() -> None:
        game = Game(LEVEL, counter())
        branch: list[tuple[Frame, Level]] = [(game.frame, LEVEL)]

        async def step() -> None:
            frame = await game.step()
            if frame.tick == len(branch):
                branch.append((frame, game.level))
            seen(frame)

        def seen(frame: Frame) -> None:
            then, level = branch[frame.tick]
            assert frame == then
            assert np.array_equal(game.level.walls, level.walls)
            assert game.level.robots == level.robots

        try:
            for what, number, more in done:
                if what == "step":
                    for _ in range(number):
                        await step()
                elif what == "go to":
                    seen(game.go_to(number % len(branch)))
                else:
                    frame = edited(game, number, more)
                    del branch[frame.tick :]
                    branch.append((frame, game.level))
            seen(game.go_to(0))
            while game.frame.tick < len(branch) - 1:
                await step()
            for tick in range(len(branch) - 1, -1, -1):
                seen(game.go_to(tick))
        finally:
            await game.close()

    asyncio.run(play())


async def test_a_wall_stops_robots_from_the_next_tick_on(game: Game) -> None:
    await game.run_until(tick=20)
    before, original = game.frame, game.level
    assert not before.after.robots[0].blocked
    game.change_level(walled(original, int(before.after.robots[0].x) + 2))
    assert game.history.marks.marks_at(20)[0].kind == "edit"
    await game.run_until(tick=30)
    assert game.frame.after.robots[0].blocked
    assert game.go_to(19).after.robots == before.before.robots
    assert np.array_equal(game.level.walls, original.walls)
    await game.run_until(tick=21)
    assert not np.array_equal(game.level.walls, original.walls)
    moved = game.change_level(game.level, {"Ada": (75.0, 20.0, 0.0)})
    await game.step()
    assert game.back().after == moved.after  # a tick gone back to comes back as changed


async def test_a_robot_is_put_elsewhere_while_the_game_runs(game: Game) -> None:
    running = asyncio.create_task(game.run())
    await reached(game, 5)
    tick = game.change_level(game.level, {"Ada": (150.0, 20.0, 0.0)}).tick
    await reached(game, tick + 3)
    game.pause()
    await running
    after = game.frame_at(tick + 1)
    assert after.before.robots[0].x == 150.0
    assert after.after.robots[0].x == 151.0
    with pytest.raises(ValueError, match="Nobody"):
        game.change_level(game.level, {"Nobody": (0, 0, 0)})


async def test_beginning_again_does_not_do_again_what_was_done_by_hand(game: Game) -> None:
    level, start = game.level, game.frame
    game.change_level(level, {"Ada": (60.0, 25.0, 0.0)})
    await game.run_until(tick=3)
    assert game.restart(level) == start
    assert game.frame_at(0) == start
    frame = await game.step()
    assert frame.after.robots[0].x == pytest.approx(start.after.robots[0].x + 1)
    await game.run_until(tick=10)
    plain = await game.step()
    game.go_to(10)
    game.change_level(walled(level, 100), {"Bo": (20.0, 40.0, 0.0)})
    await game.run_until(tick=15)
    game.restart(level)
    assert (await game.run_until(tick=11)) == plain
    assert game.level is level
    assert game.history.other_ticks is not None
    game.restart(walled(level, 100))
    assert game.history.level_at(0).walls[30, 100]


async def test_another_program_begins_another_future_before_an_edit(game: Game) -> None:
    await game.run_until(tick=10)
    game.change_level(game.level, {"Ada": (150.0, 20.0, 0.0)})
    await game.run_until(tick=12)
    game.go_to(5)
    game.use(Program.compile(BACKWARDS))
    frame = await game.run_until(tick=11)
    assert frame.after.robots[0].x < 50
    game.change_branch()
    assert game.frame.after.robots[0].x > 150


async def test_a_new_robot_thinks_from_the_next_tick_on_and_marks_know_who(game: Game) -> None:
    await game.run_until(tick=40)
    level = with_robot(game.level, "Cy")
    frame = game.change_level(level)
    assert (frame.decisions, frame.memories) == ((), {"Cy": "", "Ada": 40, "Bo": 40})
    while game.frame.tick < 120:
        await game.step()
    assert game.frame.memories == {"Cy": 80, "Ada": 120, "Bo": 120}
    memory = next(mark for mark in game.history.marks.marks_at(60) if mark.kind == "memory")
    assert set(memory.names) == {"Ada", "Bo", "Cy"}
    assert game.history.marks.nearest(0, 1, (), "Cy") == 41
    game.change_level(without_robot(level, 1))
    while game.frame.tick < 130:
        await game.step()
    assert set(game.history.marks.marks_at(125)[0].names) == {"Cy", "Bo"}
