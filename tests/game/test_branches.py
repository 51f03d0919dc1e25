"""Going back and taking another way: branches that are kept, left and switched to."""

import pytest

from logical_robots_tui.game import Game, NoSuchTickError
from logical_robots_tui.mind import Program
from tests.game.playing import BACKWARDS, COUNTER, Play


async def test_ticks_that_are_known_are_gone_through_again_without_thinking(
    hall_game: Game,
) -> None:
    await hall_game.run_until(tick=20)
    first = [hall_game.frame_at(t) for t in range(21)]  # each with the time that it took
    hall_game.go_to(3)
    await hall_game.step()
    await hall_game.run_until(tick=20)
    assert [hall_game.frame_at(t) for t in range(21)] == first
    assert hall_game.history.other is None
    with pytest.raises(NoSuchTickError, match="no other branch"):
        hall_game.change_branch()
    assert (await hall_game.step()).tick == 21


async def test_another_program_begins_another_branch_and_the_old_one_is_kept(
    hall_game: Game,
) -> None:
    await hall_game.run_until(tick=20)
    old = [hall_game.frame_at(t) for t in range(21)]
    hall_game.go_to(5)
    hall_game.use(Program.compile(BACKWARDS))
    await hall_game.run_until(tick=9)
    new = [hall_game.frame_at(t) for t in range(10)]
    assert new[9].after.robots[0].x < old[9].after.robots[0].x
    assert new[9].memories["Ada"] == 9
    with pytest.raises(NoSuchTickError):
        hall_game.frame_at(10)
    assert hall_game.history.other == range(21)
    found = hall_game.history.divergence
    assert found is not None
    assert found.tick == 6
    assert [(each.robot_name, each.matter) for each in found.differences] == [
        ("Ada", "desire"),
        ("Bo", "desire"),
        ("Ada", "position"),
        ("Bo", "position"),
    ]
    assert hall_game.change_branch() == old[9]
    assert hall_game.program.text == COUNTER
    assert [hall_game.frame_at(t) for t in range(21)] == old
    await hall_game.run_until(tick=25)
    assert hall_game.history.other == range(10)
    assert hall_game.change_branch() == new[9]
    assert hall_game.program.text == BACKWARDS
    assert (await hall_game.step()).after.robots[0].x < new[9].after.robots[0].x


async def test_two_programs_that_do_the_same_do_not_part(hall_game: Game) -> None:
    await hall_game.run_until(tick=10)
    hall_game.go_to(2)
    hall_game.use(Program.compile(COUNTER + "# the same\n"))
    await hall_game.run_until(tick=15)
    assert hall_game.history.other == range(11)
    assert hall_game.history.divergence is None


async def test_looking_back_past_a_change_of_program_changes_nothing(hall_game: Game) -> None:
    await hall_game.run_until(tick=5)
    hall_game.use(Program.compile(BACKWARDS))
    await hall_game.run_until(tick=12)
    first = [hall_game.frame_at(t) for t in range(13)]
    hall_game.go_to(2)
    await hall_game.run_until(tick=12)
    assert [hall_game.frame_at(t) for t in range(13)] == first
    assert [tick for tick in range(13) if has_changed_program(hall_game, tick)] == [6]
    hall_game.go_to(2)
    hall_game.use(hall_game.program)  # the player says: this one, from here on
    assert (await hall_game.step()).after.robots[0].x < first[3].after.robots[0].x


async def test_a_program_that_is_asked_for_goes_on_where_another_one_took_over(
    hall_game: Game,
) -> None:
    await hall_game.run_until(tick=5)
    hall_game.use(Program.compile(BACKWARDS))
    await hall_game.run_until(tick=12)
    hall_game.go_to(3)
    hall_game.use(Program.compile(COUNTER))
    await hall_game.run_until(tick=9)
    assert [hall_game.frame_at(t).after.robots[0].x for t in (5, 6, 9)] == pytest.approx(
        [45, 46, 49]
    )
    assert hall_game.history.divergence is not None
    assert hall_game.history.divergence.tick == 6


async def test_restarting_under_a_changed_program_leaves_the_old_branch_to_compare(
    hall_game: Game,
) -> None:
    await hall_game.run_until(tick=5)
    hall_game.use(Program.compile(BACKWARDS))
    await hall_game.run_until(tick=12)
    hall_game.restart()
    await hall_game.step()
    assert hall_game.history.other == range(13)
    assert hall_game.history.last == 1


async def test_restarting_beyond_history_begins_anew(play: Play) -> None:
    short = play(history=5)
    await short.run_until(tick=12)
    assert short.restart().tick == 0
    assert (short.history.first, short.history.last) == (0, 0)
    assert (await short.step()).tick == 1


async def test_what_happened_is_marked_in_its_tick(hall_game: Game) -> None:
    await hall_game.run()
    marks = hall_game.history.marks
    won_at = hall_game.won_at
    assert won_at is not None
    assert [(mark.kind, mark.names) for mark in marks.at(won_at)] == [
        ("victory", ()),
        ("memory", ("Ada", "Bo")),
    ]
    assert marks.nearest(0, 1, ["victory"], None) == won_at
    assert marks.nearest(won_at, 1, ["victory"], None) is None
    assert marks.nearest(won_at, -1, ["victory"], "Bo") == won_at - 1
    assert marks.nearest(won_at, -1, ["victory"], None) is None


def has_changed_program(played: Game, tick: int) -> bool:
    return any(mark.kind == "program" for mark in played.history.marks.at(tick))
