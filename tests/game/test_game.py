"""The game: ticks, time travel, and work that is dropped when the player moves on."""

import asyncio
from itertools import pairwise

import pytest

from logical_robots_tui.game import Frame, Game, NoSuchTickError, Superseded
from logical_robots_tui.game.pace import FLAT_OUT, Pace
from logical_robots_tui.mind import Program, QueryError
from logical_robots_tui.mind.limits import Limits
from tests.game.playing import COUNTER, SLOW, Play
from tests.virtual_time import VirtualClock, later, virtual_loop
from tests.waiting import PATIENCE


async def test_a_game_begins_before_anybody_thinks_and_each_step_senses_thinks_and_acts_once(
    hall_game: Game,
) -> None:
    start = hall_game.frame
    assert (start.tick, start.decisions, start.memories) == (0, (), {"Ada": "", "Bo": ""})
    assert [r["robot_name"] for r in start.sensors] == ["Ada", "Bo"]
    assert start.sensors[0]["sensor"]["clock"] == 0
    frame = await hall_game.step()
    assert frame is hall_game.frame
    assert (frame.tick, frame.sensors[0]["sensor"]["clock"]) == (1, 1)
    assert frame.after.robots[0].x == pytest.approx(41)
    assert frame.memories_before == {"Ada": "", "Bo": ""}
    assert frame.memories == {"Ada": 1, "Bo": 1}


async def test_running_ends_with_victory_and_goes_on_when_asked_to(hall_game: Game) -> None:
    await hall_game.run()
    won_at = hall_game.won_at
    assert won_at == hall_game.frame.tick
    assert not hall_game.running
    assert hall_game.frame.after.areas[0].visitors == ("Ada", "Bo")
    await hall_game.run_until(tick=won_at + 5)
    assert (hall_game.won_at, hall_game.frame.tick) == (won_at, won_at + 5)


async def test_a_run_that_is_taken_back_between_two_ticks_ends_with_victory_again(
    hall_game: Game,
) -> None:
    won_at = (await hall_game.run_until(tick=200)).tick
    hall_game.pace.speed = 40
    loop, beyond = asyncio.get_running_loop(), 0

    def take_back(frame: Frame) -> None:
        nonlocal beyond
        if frame.tick > won_at:
            beyond += 1
            loop.call_soon(hall_game.go_to, won_at - 3) if beyond == 1 else hall_game.pause()

    hall_game.listen(take_back)
    await hall_game.run()
    assert (hall_game.frame.tick, beyond) == (won_at, 1)


async def test_every_tick_of_a_run_is_restored_exactly_and_restarting_begins_anew(
    hall_game: Game,
) -> None:
    frames = [hall_game.frame]
    hall_game.listen(frames.append)
    await hall_game.run_until(tick=30)
    assert [hall_game.frame_at(t) for t in range(31)] == frames
    for expected in [*reversed(frames[:-1]), frames[0]]:
        assert hall_game.back() == expected
    await hall_game.run_until(tick=9)
    start = hall_game.restart()
    assert (start.tick, start.memories) == (0, {"Ada": "", "Bo": ""})
    assert (await hall_game.step()).tick == 1


async def test_history_forgets_the_oldest_ticks(play: Play) -> None:
    short = play(history=5)
    await short.run_until(tick=12)
    assert short.history.first == 8
    for _ in range(20):
        short.back()
    assert short.frame.tick == 8
    with pytest.raises(NoSuchTickError, match="ticks 8 to"):
        short.frame_at(3)


async def test_a_tick_of_a_run_that_is_over_is_dropped_and_one_may_be_cancelled(play: Play) -> None:
    slow = play(SLOW)
    for end in (lambda _: slow.restart(), asyncio.Task.cancel):
        step = asyncio.create_task(slow.step())
        await asyncio.sleep(0)
        end(step)
        with pytest.raises((Superseded, asyncio.CancelledError)):
            await step
        assert step.cancelled() == (end is asyncio.Task.cancel)
        assert slow.frame.tick == 0
    slow.use(Program.compile(COUNTER))
    assert (await slow.step()).tick == 1


async def test_a_runaway_program_leaves_the_loop_free_and_can_be_stopped(play: Play) -> None:
    patient = Limits(think_steps=10**12, think_seconds=10 * PATIENCE)
    slow = play(SLOW, limits=patient)
    running = asyncio.create_task(slow.run())
    with virtual_loop().impatient():
        for _ in range(100):
            await later(0.01)
        assert slow.running
        slow.pause()
    await running
    assert slow.frame.tick == 0
    slow.use(Program.compile(COUNTER))
    assert (await slow.step()).tick == 1


async def test_a_query_speaks_of_the_frame_that_was_asked_for_or_says_why_it_has_no_rows(
    hall_game: Game,
) -> None:
    await hall_game.run_until(tick=10)
    answer = await hall_game.query("Robot", hall_game.frame_at(4))
    assert [row[2] for row in answer.rows] == [4, 4]
    memory = await hall_game.query("Memory", hall_game.frame_at(4))
    assert memory.rows == (("Ada", 3), ("Bo", 3))
    with pytest.raises(QueryError, match="no predicate Wings"):
        await hall_game.query("Wings")
    with pytest.raises(QueryError, match="function of its arguments"):
        await hall_game.query("WeightedAverage")


async def test_pausing_a_slow_pace_takes_effect_at_once(hall_game: Game) -> None:
    hall_game.pace.speed = 0.01
    ticked = asyncio.Event()
    hall_game.listen(lambda _: ticked.set())
    running = asyncio.create_task(hall_game.run())
    await ticked.wait()
    began = hall_game.clock.now()
    hall_game.pause()
    await running
    assert hall_game.clock.now() == began
    assert hall_game.frame.tick == 1


@pytest.mark.parametrize(("speed", "spacing"), [(FLAT_OUT, 0.0), (320.0, 0.06)])
async def test_of_ticks_computed_together_each_is_shown_once_and_in_order(
    hall_game: Game, speed: float | None, spacing: float
) -> None:
    seen: list[Frame] = []
    hall_game.listen(seen.append)
    hall_game.pace.speed, hall_game.pace.spacing = speed, spacing
    await hall_game.run()
    assert [frame.tick for frame in seen] == list(range(1, len(seen) + 1))
    assert seen[-1].tick == hall_game.won_at
    assert all(b.before is a.after for a, b in pairwise(seen))


async def test_running_until_a_condition_shows_nothing_beyond_it(hall_game: Game) -> None:
    seen: list[int] = []
    hall_game.listen(lambda frame: seen.append(frame.tick))
    await hall_game.run_until(condition=lambda frame: frame.tick == 7)
    assert seen == list(range(1, 8))
    assert hall_game.history.last == 7
    await hall_game.run_until(tick=9)
    assert hall_game.frame.tick == 9


async def test_a_listener_can_end_a_run_that_is_flat_out(hall_game: Game) -> None:
    def stop(frame: Frame) -> None:
        if frame.tick == 5:
            hall_game.pause()

    hall_game.listen(stop)
    hall_game.pace.speed = None
    await hall_game.run()
    assert (hall_game.frame.tick, hall_game.history.last) == (5, 5)
    hall_game.go_to(2)
    assert (await hall_game.step()).tick == 3


async def test_a_game_that_runs_flat_out_gives_way_for_a_moment() -> None:
    clock = VirtualClock()
    pace = Pace(FLAT_OUT, clock)
    began = clock.now()
    await pace.wait()
    assert clock.now() == began
    pace.give_way()
    await pace.wait()
    assert clock.now() - began == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("spacing", "together", "seconds"), [(0.0, 1, 0.025), (0.07, 4, 0.1), (0.3, 4, 0.3)]
)
async def test_on_a_busy_machine_ticks_come_in_lots_and_then_more_slowly(
    spacing: float, together: int, seconds: float
) -> None:
    clock = VirtualClock()
    pace = Pace(40.0, clock)
    pace.spacing = spacing
    pace.start()
    began = clock.now()
    assert pace.together == together
    for _ in range(together):
        pace.count()
    await pace.wait()
    assert clock.now() - began == pytest.approx(seconds, abs=0.05)


async def test_ticks_that_ran_flat_out_are_not_waited_for_later() -> None:
    clock = VirtualClock()
    pace = Pace(FLAT_OUT, clock)
    for _ in range(10_000):
        pace.count()
    await pace.wait()
    pace.speed = 40.0
    pace.count()
    began = clock.now()
    await pace.wait()
    assert clock.now() - began == pytest.approx(0.025)


async def test_speeds_go_from_slow_motion_to_flat_out() -> None:
    pace = Pace(FLAT_OUT, VirtualClock())
    for _ in range(20):
        pace.slower()
    assert pace.speed == 1.0
    for _ in range(20):
        pace.faster()
    assert pace.speed is None
