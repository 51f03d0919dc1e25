"""Proofs of one decision in two branches, line by line."""

from logical_robots_tui.game.debugging.proof_difference import compare_proofs
from logical_robots_tui.mind import Program
from tests.game.playing import Play

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
