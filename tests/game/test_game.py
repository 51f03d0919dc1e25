"""The game: ticks, time travel, branches and how they differ, and work that is dropped."""

import asyncio
from itertools import pairwise

import pytest

from logical_robots_tui.game import Frame, Game, NoSuchTickError, Superseded
from logical_robots_tui.game.debugging.proof_difference import compare_proofs
from logical_robots_tui.game.pace import FLAT_OUT, Pace
from logical_robots_tui.mind import Program, QueryError
from logical_robots_tui.mind.limits import Limits
from tests.game.playing import BACKWARDS, COUNTER, SLOW, Play
from tests.virtual_time import VirtualClock, later, virtual_loop
from tests.waiting import PATIENCE

BLANK = {"Ada": "", "Bo": ""}


async def test_a_game_begins_before_any_thought_and_a_step_does_all_once(game: Game) -> None:
    start = game.frame
    assert (start.tick, start.decisions, start.memories) == (0, (), BLANK)
    assert [row["robot_name"] for row in start.sensors] == ["Ada", "Bo"]
    assert start.sensors[0]["sensor"]["clock"] == 0
    frame = await game.step()
    assert frame is game.frame
    assert (frame.tick, frame.sensors[0]["sensor"]["clock"]) == (1, 1)
    assert frame.after.robots[0].x == pytest.approx(41)
    assert (frame.memories_before, frame.memories) == (BLANK, {"Ada": 1, "Bo": 1})


async def test_running_ends_with_victory_which_is_marked_and_goes_on_if_asked(game: Game) -> None:
    await game.run()
    marks, won_at = game.history.marks, game.won_at
    assert won_at == game.frame.tick
    assert not game.running
    assert game.frame.after.areas[0].visitors == ("Ada", "Bo")
    marked = [(mark.kind, mark.names) for mark in marks.marks_at(won_at)]
    assert marked == [("victory", ()), ("memory", ("Ada", "Bo"))]
    assert marks.nearest(0, 1, ["victory"], None) == won_at
    assert marks.nearest(won_at, 1, ["victory"], None) is None
    assert marks.nearest(won_at, -1, ["victory"], "Bo") == won_at - 1
    assert marks.nearest(won_at, -1, ["victory"], None) is None
    await game.run_until(tick=won_at + 5)
    assert (game.won_at, game.frame.tick) == (won_at, won_at + 5)


async def test_a_run_taken_back_between_ticks_ends_with_victory_again(game: Game) -> None:
    won_at = (await game.run_until(tick=200)).tick
    game.pace.speed = 40
    loop, beyond = asyncio.get_running_loop(), 0

    def take_back(frame: Frame) -> None:
        nonlocal beyond
        if frame.tick > won_at:
            beyond += 1
            loop.call_soon(game.go_to, won_at - 3) if beyond == 1 else game.pause()

    game.listen(take_back)
    await game.run()
    assert (game.frame.tick, beyond) == (won_at, 1)


async def test_before_the_start_there_is_nothing_and_restarting_begins_anew(game: Game) -> None:
    start = game.frame
    await game.run_until(tick=2)
    assert [game.back() for _ in range(3)][1:] == [start, start]
    await game.run_until(tick=9)
    start = game.restart()
    assert (start.tick, start.memories) == (0, BLANK)
    assert (await game.step()).tick == 1


async def test_history_forgets_the_oldest_ticks_and_restarts_beyond_them(play: Play) -> None:
    short = play(history=5)
    await short.run_until(tick=12)
    assert short.history.first == 8
    for _ in range(20):
        short.back()
    assert short.frame.tick == 8
    with pytest.raises(NoSuchTickError, match="ticks 8 to"):
        short.frame_at(3)
    assert short.restart().tick == 0
    assert (short.history.first, short.history.last) == (0, 0)
    assert (await short.step()).tick == 1


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
    slow = play(SLOW, limits=Limits(think_steps=10**12, think_seconds=10 * PATIENCE))
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


async def test_a_query_speaks_of_the_frame_asked_for_or_says_why_it_has_no_rows(game: Game) -> None:
    await game.run_until(tick=10)
    answer = await game.query("Robot", game.frame_at(4))
    assert [row[2] for row in answer.rows] == [4, 4]
    assert (await game.query("Memory", game.frame_at(4))).rows == (("Ada", 3), ("Bo", 3))
    for predicate, message in (
        ("Wings", "no predicate Wings"),
        ("WeightedAverage", "function of its arguments"),
    ):
        with pytest.raises(QueryError, match=message):
            await game.query(predicate)


async def test_pausing_a_slow_pace_takes_effect_at_once(game: Game) -> None:
    game.pace.speed = 0.01
    ticked = asyncio.Event()
    game.listen(lambda _: ticked.set())
    running = asyncio.create_task(game.run())
    await ticked.wait()
    began = game.clock.now()
    game.pause()
    await running
    assert game.clock.now() == began
    assert game.frame.tick == 1


async def test_of_ticks_computed_together_each_is_shown_once_and_in_order(game: Game) -> None:
    frames: list[Frame] = []
    game.listen(frames.append)
    for game.pace.speed, game.pace.spacing in ((FLAT_OUT, 0.0), (320.0, 0.06)):
        game.restart()
        game.forget_future()
        frames.clear()
        await game.run()
        assert [frame.tick for frame in frames] == list(range(1, len(frames) + 1))
        assert frames[-1].tick == game.won_at
        assert all(later.before is earlier.after for earlier, later in pairwise(frames))


async def test_a_condition_or_a_listener_ends_a_run_and_shows_nothing_beyond(game: Game) -> None:
    ticks: list[int] = []
    game.listen(lambda frame: ticks.append(frame.tick))
    await game.run_until(condition=lambda frame: frame.tick == 7)
    assert ticks == list(range(1, 8))
    assert game.history.last == 7
    await game.run_until(tick=9)
    assert game.frame.tick == 9
    game.listen(lambda frame: game.pause() if frame.tick == 12 else None)
    game.pace.speed = None
    await game.run()
    assert (game.frame.tick, game.history.last) == (12, 12)
    game.go_to(2)
    assert (await game.step()).tick == 3


async def waited(pace: Pace) -> float:
    began = virtual_loop().time()
    await pace.wait()
    return virtual_loop().time() - began


async def test_flat_out_a_game_gives_way_for_a_moment_and_is_not_waited_for_later() -> None:
    pace = Pace(FLAT_OUT, VirtualClock())
    assert await waited(pace) == 0
    pace.give_way()
    assert await waited(pace) == pytest.approx(0.03)
    for _ in range(10_000):
        pace.count()
    await pace.wait()
    pace.speed = 40.0
    pace.count()
    assert await waited(pace) == pytest.approx(0.025)


async def test_on_a_busy_machine_ticks_come_in_lots_and_then_more_slowly() -> None:
    for spacing, together, seconds in ((0.0, 1, 0.025), (0.07, 4, 0.1), (0.3, 4, 0.3)):
        pace = Pace(40.0, VirtualClock())
        pace.spacing = spacing
        pace.start()
        assert pace.batch_size == together
        for _ in range(together):
            pace.count()
        assert await waited(pace) == pytest.approx(seconds, abs=0.05)


async def test_speeds_go_from_slow_motion_to_flat_out() -> None:
    pace = Pace(FLAT_OUT, VirtualClock())
    for steps, limit in ((-1, 1.0), (1, None)):
        for _ in range(20):
            pace.shift(steps)
        assert pace.speed == limit


async def test_known_ticks_are_gone_through_again_without_thinking(game: Game) -> None:
    await game.run_until(tick=20)
    first = [game.frame_at(t) for t in range(21)]  # each with the time that it took
    game.go_to(3)
    await game.step()
    await game.run_until(tick=20)
    assert [game.frame_at(t) for t in range(21)] == first
    assert game.history.other_ticks is None
    with pytest.raises(NoSuchTickError, match="no other branch"):
        game.change_branch()
    assert (await game.step()).tick == 21


async def test_another_program_begins_another_branch_and_the_old_one_is_kept(game: Game) -> None:
    await game.run_until(tick=20)
    old = [game.frame_at(t) for t in range(21)]
    game.go_to(5)
    game.use(Program.compile(BACKWARDS))
    await game.run_until(tick=9)
    new = [game.frame_at(t) for t in range(10)]
    assert new[9].after.robots[0].x < old[9].after.robots[0].x
    assert new[9].memories["Ada"] == 9
    with pytest.raises(NoSuchTickError):
        game.frame_at(10)
    assert game.history.other_ticks == range(21)
    divergence = game.history.divergence
    assert divergence is not None
    assert divergence.tick == 6
    differences = [(robot, matter) for matter in ("desire", "position") for robot in ("Ada", "Bo")]
    assert [(one.robot_name, one.matter) for one in divergence.differences] == differences
    assert game.change_branch() == old[9]
    assert game.program.text == COUNTER
    assert [game.frame_at(t) for t in range(21)] == old
    await game.run_until(tick=25)
    assert game.history.other_ticks == range(10)
    assert game.change_branch() == new[9]
    assert game.program.text == BACKWARDS
    assert (await game.step()).after.robots[0].x < new[9].after.robots[0].x


async def test_two_programs_that_do_the_same_do_not_part(game: Game) -> None:
    await game.run_until(tick=10)
    game.go_to(2)
    game.use(Program.compile(COUNTER + "# the same\n"))
    await game.run_until(tick=15)
    assert game.history.other_ticks == range(11)
    assert game.history.divergence is None


async def test_looking_back_past_a_change_of_program_changes_nothing(game: Game) -> None:
    await game.run_until(tick=5)
    game.use(Program.compile(BACKWARDS))
    await game.run_until(tick=12)
    first = [game.frame_at(t) for t in range(13)]
    game.go_to(2)
    await game.run_until(tick=12)
    assert [game.frame_at(t) for t in range(13)] == first
    kinds = [[mark.kind for mark in game.history.marks.marks_at(tick)] for tick in range(13)]
    assert [tick for tick in range(13) if "program" in kinds[tick]] == [6]
    game.restart()
    await game.step()  # under a changed program, which leaves the old branch to compare
    assert (game.history.other_ticks, game.history.last) == (range(13), 1)
    game.change_branch()
    game.go_to(2)
    game.use(game.program)  # the player says: this one, from here on
    assert (await game.step()).after.robots[0].x < first[3].after.robots[0].x


async def test_a_program_that_is_asked_for_goes_on_where_another_took_over(game: Game) -> None:
    await game.run_until(tick=5)
    game.use(Program.compile(BACKWARDS))
    await game.run_until(tick=12)
    game.go_to(3)
    game.use(Program.compile(COUNTER))
    await game.run_until(tick=9)
    places = [game.frame_at(tick).after.robots[0].x for tick in (5, 6, 9)]
    assert places == pytest.approx([45, 46, 49])
    assert game.history.divergence is not None
    assert game.history.divergence.tick == 6


DRIVE = """
Fresh(robot_name:) :- Memory(robot_name:, memory:), memory == "new";
Drive(robot_name:, left: 1, right: 1) :- Sensor(robot_name:), ~Fresh(robot_name:);
Drive(robot_name:, left: 0, right: 0) :- Sensor(robot_name:), Fresh(robot_name:);
Robot(robot_name:, desire: {left_engine: left, right_engine: right}, memory: 1) :-
  Sensor(robot_name:), Drive(robot_name:, left:, right:);
"""


async def test_branches_are_compared_where_they_part_but_not_by_hand(play: Play) -> None:
    game = play(DRIVE)
    await game.run_until(tick=4)
    game.go_to(1)
    game.use(Program.compile("# a comment\n" + DRIVE.replace('"new"', "1")))
    await game.step()
    assert game.history.divergence is not None
    comparison = await compare_proofs(game, game.history.divergence)
    assert comparison is not None
    assert comparison.robot == "Ada"
    changed = {(line[0], line[1:].strip()) for line in comparison.lines}
    assert {("-", "memory == 1"), ("+", 'memory == "new" does not hold')} <= changed
    assert (" ", "Sensor(robot_name:)") in changed
    assert comparison.lines[0] != "@", "nothing is left out before the first line"
    moved = play(DRIVE)
    await moved.run_until(tick=3)
    moved.go_to(1)
    moved.change_level(moved.level, {"Ada": (60.0, 25.0, 0.0)})
    assert moved.history.divergence is not None
    assert await compare_proofs(moved, moved.history.divergence) is None
