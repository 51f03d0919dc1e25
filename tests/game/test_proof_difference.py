"""The first difference of two proofs: a rule, a step or a value, before what follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.game import Game
from logical_robots_tui.game.debugging.proof_difference import (
    Comparison,
    ProofDifference,
    compare_proofs,
    condition_of,
    first_difference,
)
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level, World
from tests.game.playing import Play, hall

DRIVE = """
Fresh(robot_name:) :- Memory(robot_name:, memory:), memory == "new";
Drive(robot_name:, left: 1, right: 1) :- Sensor(robot_name:), ~Fresh(robot_name:);
Drive(robot_name:, left: 0, right: 0) :- Sensor(robot_name:), Fresh(robot_name:);
Robot(robot_name:, desire: {left_engine: left, right_engine: right}, memory: 1) :-
  Sensor(robot_name:), Drive(robot_name:, left:, right:);
"""

NEAREST = """
Nearest(sensor) = Min{ray.distance :- ray in sensor.radar, ray.angle > 0};
Robot(robot_name:, desire: {left_engine: speed, right_engine: 1}, memory: n) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  n = (if memory == "" then 1 else memory + 1),
  speed = (if Nearest(sensor) < 5 then 0 else n / 10);
"""


@pytest.fixture
def level(tmp_path: Path) -> Level:
    return hall(tmp_path)


class Two:
    """Ada thinks twice about what she senses at the start."""

    def __init__(
        self, level: Level, here: str, there: str, *, memories: tuple[Value, Value] = ("", "")
    ) -> None:
        rows = World(level).sense()
        self._minds = [Mind(Program.compile(text)) for text in (here, there)]
        self._explainers = [
            Explainer(mind, "Ada", rows, self._memories(memory))
            for mind, memory in zip(self._minds, memories, strict=True)
        ]
        mine, other = (explainer.proof() for explainer in self._explainers)
        self.found = first_difference(mine, other, here, there)

    @property
    def difference(self) -> ProofDifference:
        assert self.found is not None
        return self.found

    @property
    def texts(self) -> tuple[str | None, str | None]:
        here, there = self.difference.here, self.difference.there
        return here.text if here else None, there.text if there else None

    def condition(self) -> tuple[str, str] | None:
        asked = self.difference.asked
        whys = [each.why(asked) for each in self._explainers]
        found = condition_of(self.difference, *whys)
        return None if found is None else (found[0].text, found[1])

    @staticmethod
    def _memories(memory: Value) -> Mapping[str, Value]:
        return {"Ada": memory, "Bo": ""}


def test_proofs_that_are_the_same_do_not_differ(level: Level) -> None:
    assert Two(level, NEAREST, NEAREST).found is None
    moved = f"# a comment more\n\n{NEAREST}"
    assert Two(level, NEAREST, moved).found is None


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
    lines = DRIVE.splitlines(keepends=True)
    two = Two(level, "".join([*lines[:2], *lines[3:]]), DRIVE)
    assert two.difference.kind == "step"
    assert two.texts == ("Drive(robot_name:, left:, right:)",) * 2
    holds = [node and node.holds for node in (two.difference.here, two.difference.there)]
    assert holds == [False, True]


@pytest.mark.slow
def test_a_rule_in_place_of_another_one_is_no_edited_one(level: Level) -> None:
    lines = DRIVE.splitlines(keepends=True)
    new = "Drive(robot_name:, left: 5, right: 5) :- Sensor(robot_name:, sensor:), sensor.clock < 9;"
    two = Two(level, "".join([*lines[:2], lines[3], f"{new}\n", *lines[4:]]), DRIVE)
    assert two.difference.kind == "rule"
    assert two.texts[0] == new.removesuffix(";")
    assert two.condition() is None


def test_an_edited_rule_is_gone_into_for_the_step_that_differs(level: Level) -> None:
    two = Two(level, NEAREST, NEAREST.replace("n / 10", "n / 5"))
    assert two.difference.kind == "step"
    assert two.difference.asked.predicate == "Robot"
    assert two.texts == tuple(
        f"speed = (if Nearest(sensor) < 5 then 0 else n / {number})" for number in (10, 5)
    )


def test_what_a_function_gives_differs_where_the_function_does(level: Level) -> None:
    two = Two(level, NEAREST, NEAREST.replace("ray.angle > 0", "ray.angle < 0"))
    assert two.difference.asked.predicate == "Nearest"
    assert two.difference.kind == "rule"
    assert two.texts == tuple(
        f"Nearest(sensor) = Min{{ray.distance :- ray in sensor.radar, ray.angle {sign} 0}}"
        for sign in "><"
    )
    assert two.condition() is None


def test_a_column_that_is_edited_is_named(level: Level) -> None:
    two = Two(level, DRIVE, DRIVE.replace("memory: 1", "memory: 2"))
    assert two.difference.kind == "value"
    assert two.texts == ("memory", "memory")
    assert [node and node.values for node in (two.difference.here, two.difference.there)] == [
        (1,),
        (2,),
    ]


def test_where_only_values_differ_the_first_one_that_was_read_is_named(level: Level) -> None:
    two = Two(level, NEAREST, NEAREST, memories=(3, 4))
    assert two.difference.kind == "value"
    assert two.texts == ("memory", "memory")
    assert two.difference.here is not None
    assert (two.difference.here.kind, two.difference.here.values) == ("read", (3,))


def test_a_branch_that_was_not_taken_is_told_by_its_condition(level: Level) -> None:
    two = Two(level, NEAREST, NEAREST.replace("memory + 1", "memory + 1 + 0"), memories=("", ""))
    assert two.texts[0] == 'n = (if memory == "" then 1 else memory + 1)'


def test_a_robot_without_a_row_is_told_by_the_step_that_fails(level: Level) -> None:
    text = """
    Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: 1) :-
      Sensor(robot_name:), Memory(robot_name:, memory:), memory == "go";
    """
    two = Two(level, text, text.replace('"go"', '""'), memories=("", ""))
    assert two.difference.kind == "step"
    assert two.texts == ('memory == "go"', 'memory == ""')
    same = Two(level, text, text, memories=("go", "halt"))
    assert same.difference.asked.predicate == "Robot"


async def played(level: Level, here: str, there: str) -> Comparison | None:
    """Four ticks under one program, from the second on anew under another."""
    game = Game(level, Program.compile(there))
    try:
        for _ in range(4):
            await game.step()
        game.go_to(1)
        game.use(Program.compile(here))
        await game.step()
        assert game.history.divergence is not None
        return await compare_proofs(game, game.history.divergence)
    finally:
        await game.close()


async def test_the_branches_of_a_game_are_compared_where_they_part(level: Level) -> None:
    found = await played(level, DRIVE.replace('"new"', "1"), DRIVE)
    assert found is not None
    assert found.robot == "Ada"
    assert found.differing is not None
    assert found.differing.asked.predicate == "Drive"
    assert found.condition is not None
    assert (found.condition[0].text, found.condition[1]) == ("~Fresh(robot_name:)", "there")


async def test_a_robot_put_elsewhere_by_hand_has_no_derivation_that_differs(
    level: Level, play: Play
) -> None:
    game = play(DRIVE, level)
    for _ in range(3):
        await game.step()
    game.go_to(1)
    game.change_level(level, {"Ada": (60.0, 25.0, 0.0)})
    assert game.history.divergence is not None
    assert await compare_proofs(game, game.history.divergence) is None


WALLS = """
Ahead(ray) :- Abs(ray.angle) < 0.5;
WayAhead(radar) = Min{ray.distance :- ray in radar, Ahead(ray)};
Close(robot_name:, at: ray.angle) :- Sensor(robot_name:, sensor:), ray in sensor.radar, Ahead(ray);
Robot(robot_name:, desire: {left_engine: WayAhead(sensor.radar), right_engine: n}, memory: 1) :-
  Sensor(robot_name:, sensor:), n = Sum{1 :- Close(robot_name:, at:)};
"""


def test_what_decides_an_aggregate_is_gone_into_before_its_value_counts(level: Level) -> None:
    two = Two(level, WALLS, WALLS.replace("< 0.5", "< 1.5"))
    assert two.difference.kind == "rule"
    assert two.difference.asked.predicate == "Ahead"
    assert two.texts == ("Ahead(ray) :- Abs(ray.angle) < 0.5", "Ahead(ray) :- Abs(ray.angle) < 1.5")


@pytest.mark.slow
def test_what_only_one_aggregate_goes_over_is_told_by_its_new_rule(level: Level) -> None:
    text = """
    Near(robot_name:, d: 7) :- Sensor(robot_name:), Memory(robot_name:, memory:), memory == "x";
    Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: s) :-
      Sensor(robot_name:), s = Sum{d :- Near(robot_name:, d:)};
    """
    two = Two(level, text, text.replace('"x"', '""'))
    assert two.difference.kind == "rule"
    assert two.difference.asked.predicate == "Near"
    assert two.texts[0] is None
