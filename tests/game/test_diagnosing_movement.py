"""Diagnosis of robots that make no progress: what they did, and which lines made them."""

import pytest

from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import HALL
from tests.game.test_diagnosing import diagnosed, kinds, the

NO_DOOR = read_native(HALL.split("[[areas]]")[0], "no door", "")


async def test_who_stands_still_goes_round_or_pushes_against_a_wall_is_told_of() -> None:
    for left, right, kind, words in (
        (0, 0, "still", "Ada stood still from tick 1 to 300"),
        (1, -1, "circle", "Ada goes round in a circle of"),
        (1, 1, "blocked", "Ada was blocked from tick"),
    ):
        text = f"""Go() =
  {{left_engine: {left}, right_engine: {right}}};
Robot(robot_name:, desire: Go(),
  memory: "") :- Sensor(robot_name:);"""
        finding, span = the(await diagnosed(NO_DOOR, text, 300), kind)
        assert finding.message.startswith(words)
        assert span.line == 3
        assert {span.line for span in finding.others} <= {1, 2}


async def test_who_has_just_got_stuck_is_not_on_its_way() -> None:
    text = "Robot(robot_name:, desire: {left_engine: E, right_engine: E}) :- Sensor(robot_name:);"
    for engine, is_on_way in (("0.1", True), ("1", False)):
        told = kinds(await diagnosed(NO_DOOR, text.replace("E", engine), 200))
        assert ("unfinished" in told, "blocked" in told) == (is_on_way, False)


VARIANTS = [pytest.param(*case, marks=pytest.mark.slow) for case in ((1, "blocked"), (2, "still"))]


@pytest.mark.parametrize(("last", "kind"), [(0, "circle"), *VARIANTS])
async def test_of_several_rows_the_rule_whose_row_counts_is_told_of(last: int, kind: str) -> None:
    rules = [
        'Robot(robot_name:, memory: "", desire:) :- Sensor(robot_name:),\n'
        f"  desire = {{left_engine: {left}, right_engine: {right}}};"
        for left, right in ((1, -1), (1, 1), (0, 0))
    ]
    rules.append(rules.pop(last))
    _, span = the(await diagnosed(NO_DOOR, "\n".join(rules), 300), kind)
    assert span.line == 6


COPIES = """Near(ray) :- ray.distance < 0;
Far(ray) :- ray.distance > 0;
Stop() = {left_engine: 0, right_engine: 0};
Go() = {left_engine: 0.1, right_engine: 0.1};
Worker(robot_name:, desire:) :-
  Sensor(robot_name:, sensor:), seen = Max{1 :- ray in sensor.radar, Near(ray)},
  desire = (if seen is not null
    then Stop()
    else Go());
Sleeper := Worker(Near: Far);
Robot(robot_name: "Ada", desire:, memory: "") :- Sleeper(robot_name: "Ada", desire:);
Robot(robot_name: "Bo", desire:, memory: "") :- Worker(robot_name: "Bo", desire:);
"""


async def test_who_stands_still_does_so_by_the_rule_that_gave_its_row_copied_or_not() -> None:
    finding, span = the(await diagnosed(NO_DOOR, COPIES, 300), "still")
    assert (finding.robot, span.line, span.text) == ("Ada", 8, "Stop()")


STATES = """Plan(state: "wait", limit: 9000, next: "go");
Plan(state: "go", limit: 9000, next: "wait");
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {state:, name:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  Plan(state: now, limit:, next:), now == Coalesce(memory.state, "wait"),
  name = Coalesce(memory.name, robot_name),
  state = (if sensor.clock > limit then next else now);
"""


async def test_who_makes_no_progress_in_a_state_is_told_of_where_the_state_is_set() -> None:
    diagnosis = await diagnosed(NO_DOOR, STATES, 300)
    assert kinds(diagnosis).count("unchanged") == 1
    finding, span = the(diagnosis, "unchanged")
    assert finding.message == 'Ada\'s memory.state stayed "wait" from tick 1 to 300.'
    assert span.line == 7
    assert 5 in {span.line for span in finding.others}
