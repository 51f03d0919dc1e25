"""The first difference of two proofs: a rule, a step or a value, before what follows from it."""

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.game.debugging.proof_difference import (
    ProofDifference,
    compare_proofs,
    condition_of,
    first_difference,
)
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level, World
from tests.game.playing import Play

DRIVE = """
Fresh(robot_name:) :- Memory(robot_name:, memory:), memory == "new";
Drive(robot_name:, left: 1, right: 1) :- Sensor(robot_name:), ~Fresh(robot_name:);
Drive(robot_name:, left: 0, right: 0) :- Sensor(robot_name:), Fresh(robot_name:);
Robot(robot_name:, desire: {left_engine: left, right_engine: right}, memory: 1) :-
  Sensor(robot_name:), Drive(robot_name:, left:, right:);
"""
DRIVE_RULES = DRIVE.splitlines(keepends=True)
NEW_RULE = "Drive(robot_name:, left: 5, right: 5) :- Sensor(robot_name:, sensor:), sensor.clock < 9"
NEAREST = """
Nearest(sensor) = Min{ray.distance :- ray in sensor.radar, ray.angle > 0};
Robot(robot_name:, desire: {left_engine: speed, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1),
  speed = (if Nearest(sensor) < 5 then 0 else n / 10);
"""
WALLS = """
Ahead(ray) :- Abs(ray.angle) < 0.5;
WayAhead(radar) = Min{ray.distance :- ray in radar, Ahead(ray)};
Close(robot_name:, at: ray.angle) :- Sensor(robot_name:, sensor:), ray in sensor.radar, Ahead(ray);
Robot(robot_name:, desire: {left_engine: WayAhead(sensor.radar), right_engine: n}, memory: 1) :-
  Sensor(robot_name:, sensor:), n = Sum{1 :- Close(robot_name:, at:)};
"""
NEAR = """
Near(robot_name:, d: 7) :- Sensor(robot_name:), Memory(robot_name:, memory:), memory == "x";
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: s) :-
  Sensor(robot_name:), s = Sum{d :- Near(robot_name:, d:)};
"""
GO = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: 1) :-
  Sensor(robot_name:), Memory(robot_name:, memory:), memory == "go";
"""


class Two:
    """Ada thinks twice about what she senses at the start."""

    def __init__(
        self, level: Level, here: str, there: str, *, memories: tuple[Value, Value] = ("", "")
    ) -> None:
        rows = World(level).sense()
        minds = [Mind(Program.compile(text)) for text in (here, there)]
        self._explainers = [
            Explainer(mind, "Ada", rows, {"Ada": memory, "Bo": ""})
            for mind, memory in zip(minds, memories, strict=True)
        ]
        mine, other = (explainer.proof() for explainer in self._explainers)
        self.first = first_difference(mine, other, here, there)

    @property
    def difference(self) -> ProofDifference:
        assert self.first is not None
        return self.first

    @property
    def texts(self) -> tuple[str | None, str | None]:
        here, there = self.difference.here, self.difference.there
        return here.text if here else None, there.text if there else None

    def condition(self) -> tuple[str, str] | None:
        whys = [explainer.why(self.difference.asked) for explainer in self._explainers]
        condition = condition_of(self.difference, *whys)
        return condition and (condition[0].text, condition[1])


def test_proofs_that_are_the_same_do_not_differ(level: Level) -> None:
    assert Two(level, NEAREST, f"# a comment more\n\n{NEAREST}").first is None


def test_another_rule_is_named_with_the_condition_that_chose_it(level: Level) -> None:
    other = DRIVE.replace('"new"', '""')
    two = Two(level, other, DRIVE)
    assert two.difference.kind == "rule"
    assert two.difference.asked.predicate == "Drive"
    assert two.difference.asked.given == {"robot_name": "Ada"}
    assert two.texts == (
        "Drive(robot_name:, left: 0, right: 0) :- Sensor(robot_name:), Fresh(robot_name:)",
        "Drive(robot_name:, left: 1, right: 1) :- Sensor(robot_name:), ~Fresh(robot_name:)",
    )
    assert two.condition() == ("~Fresh(robot_name:)", "there")
    assert Two(level, DRIVE, other).condition() == ("Fresh(robot_name:)", "there")


@pytest.mark.slow
def test_where_a_rule_is_lacking_the_call_that_finds_nothing_is_named(level: Level) -> None:
    two = Two(level, "".join([*DRIVE_RULES[:2], *DRIVE_RULES[3:]]), DRIVE)
    assert two.difference.kind == "step"
    assert two.texts == ("Drive(robot_name:, left:, right:)",) * 2
    holds = [node and node.holds for node in (two.difference.here, two.difference.there)]
    assert holds == [False, True]


@pytest.mark.slow
def test_a_rule_in_place_of_another_one_is_no_edited_one(level: Level) -> None:
    rules = [*DRIVE_RULES[:2], DRIVE_RULES[3], f"{NEW_RULE};\n", *DRIVE_RULES[4:]]
    two = Two(level, "".join(rules), DRIVE)
    assert two.difference.kind == "rule"
    assert two.texts[0] == NEW_RULE
    assert two.condition() is None


SPEED = "speed = (if Nearest(sensor) < 5 then 0 else n / 10)"
AHEAD = "Ahead(ray) :- Abs(ray.angle) < 0.5"
EDITED = {
    "the step of an edited rule": (NEAREST, "n / 10", "n / 5", "step", "Robot", SPEED),
    "a function": (NEAREST, "angle > 0", "angle < 0", "rule", "Nearest", NEAREST.split(";")[0]),
    "what decides an aggregate": (WALLS, "< 0.5", "< 1.5", "rule", "Ahead", AHEAD),
    "without a row": (GO, '"go"', '""', "step", "Robot", 'memory == "go"'),
}


@pytest.mark.parametrize("edit", EDITED.values(), ids=EDITED)
def test_edits_are_gone_into_down_to_where_they_differ(level: Level, edit: tuple[str, ...]) -> None:
    program, old, new, kind, predicate, text = edit
    two = Two(level, program, program.replace(old, new))
    assert (two.difference.kind, two.difference.asked.predicate) == (kind, predicate)
    assert two.texts == (text.strip(), text.strip().replace(old, new))
    assert predicate != "Nearest" or two.condition() is None


def test_a_value_that_differs_is_named(level: Level) -> None:
    edited = Two(level, DRIVE, DRIVE.replace("memory: 1", "memory: 2"))
    read = Two(level, NEAREST, NEAREST, memories=(3, 4))
    for two, values in ((edited, (1, 2)), (read, (3, 4))):
        assert two.difference.kind == "value"
        assert two.texts == ("memory", "memory")
        nodes = [node for node in (two.difference.here, two.difference.there) if node]
        assert [node.values for node in nodes] == [(value,) for value in values]
        assert (nodes[0].kind == "read") == (two is read)


def test_a_branch_that_was_not_taken_is_told_by_its_condition(level: Level) -> None:
    two = Two(level, NEAREST, NEAREST.replace("memory + 1", "memory + 1 + 0"))
    assert two.texts[0] == 'n = (if memory == "" then 1 else memory + 1)'


def test_a_robot_without_a_row_differs_by_what_it_remembers(level: Level) -> None:
    assert Two(level, GO, GO, memories=("go", "halt")).difference.asked.predicate == "Robot"


@pytest.mark.slow
def test_what_only_one_aggregate_goes_over_is_told_by_its_new_rule(level: Level) -> None:
    two = Two(level, NEAR, NEAR.replace('"x"', '""'))
    assert (two.difference.kind, two.difference.asked.predicate) == ("rule", "Near")
    assert two.texts[0] is None


async def test_branches_are_compared_where_they_part_but_not_by_hand(play: Play) -> None:
    game = play(DRIVE)
    await game.run_until(tick=4)
    game.go_to(1)
    game.use(Program.compile(DRIVE.replace('"new"', "1")))
    await game.step()
    assert game.history.divergence is not None
    comparison = await compare_proofs(game, game.history.divergence)
    assert comparison is not None
    assert comparison.robot == "Ada"
    assert comparison.differing is not None
    assert comparison.differing.asked.predicate == "Drive"
    assert comparison.condition is not None
    assert comparison.condition[0].text == "~Fresh(robot_name:)"
    assert comparison.condition[1] == "there"
    moved = play(DRIVE)
    await moved.run_until(tick=3)
    moved.go_to(1)
    moved.change_level(moved.level, {"Ada": (60.0, 25.0, 0.0)})
    assert moved.history.divergence is not None
    assert await compare_proofs(moved, moved.history.divergence) is None
