"""Going back and taking another way: branches that are kept, left and switched to."""

import pytest

from logical_robots_tui.game import Game, NoSuchTickError
from logical_robots_tui.mind import Program
from tests.game.playing import BACKWARDS, COUNTER


async def test_known_ticks_are_gone_through_again_without_thinking(game: Game) -> None:
    await game.run_until(tick=20)
    first = [game.frame_at(t) for t in range(21)]  # each with the time that it took
    game.go_to(3)
    await game.step()
    await game.run_until(tick=20)
    assert [game.frame_at(t) for t in range(21)] == first
    assert game.history.other is None
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
    assert game.history.other == range(21)
    divergence = game.history.divergence
    assert divergence is not None
    assert divergence.tick == 6
    differences = [(robot, matter) for matter in ("desire", "position") for robot in ("Ada", "Bo")]
    assert [(one.robot_name, one.matter) for one in divergence.differences] == differences
    assert game.change_branch() == old[9]
    assert game.program.text == COUNTER
    assert [game.frame_at(t) for t in range(21)] == old
    await game.run_until(tick=25)
    assert game.history.other == range(10)
    assert game.change_branch() == new[9]
    assert game.program.text == BACKWARDS
    assert (await game.step()).after.robots[0].x < new[9].after.robots[0].x


async def test_two_programs_that_do_the_same_do_not_part(game: Game) -> None:
    await game.run_until(tick=10)
    game.go_to(2)
    game.use(Program.compile(COUNTER + "# the same\n"))
    await game.run_until(tick=15)
    assert game.history.other == range(11)
    assert game.history.divergence is None


async def test_looking_back_past_a_change_of_program_changes_nothing(game: Game) -> None:
    await game.run_until(tick=5)
    game.use(Program.compile(BACKWARDS))
    await game.run_until(tick=12)
    first = [game.frame_at(t) for t in range(13)]
    game.go_to(2)
    await game.run_until(tick=12)
    assert [game.frame_at(t) for t in range(13)] == first
    kinds = [[mark.kind for mark in game.history.marks.at(tick)] for tick in range(13)]
    assert [tick for tick in range(13) if "program" in kinds[tick]] == [6]
    game.restart()
    await game.step()  # under a changed program, which leaves the old branch to compare
    assert (game.history.other, game.history.last) == (range(13), 1)
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


async def test_what_happened_is_marked_in_its_tick(game: Game) -> None:
    await game.run()
    marks = game.history.marks
    won_at = game.won_at
    assert won_at is not None
    marked = [(mark.kind, mark.names) for mark in marks.at(won_at)]
    assert marked == [("victory", ()), ("memory", ("Ada", "Bo"))]
    assert marks.nearest(0, 1, ["victory"], None) == won_at
    assert marks.nearest(won_at, 1, ["victory"], None) is None
    assert marks.nearest(won_at, -1, ["victory"], "Bo") == won_at - 1
    assert marks.nearest(won_at, -1, ["victory"], None) is None
