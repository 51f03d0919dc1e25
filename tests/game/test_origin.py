"""Where a value in a memory comes from: the tick and the rule that made it, and what from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.game import Game, Link, Run, origin_in_game, origin_in_run, read_path
from logical_robots_tui.game.debugging.pins import path_text
from logical_robots_tui.mind import Program, QueryError
from tests.game.playing import hall

if TYPE_CHECKING:
    from pathlib import Path

    from logical_robots_tui.world import Level

PHASES = """
Start(robot_name:) :- Memory(robot_name:, memory:), memory == "";
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {plan:, seen:, kept:}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  plan = (if sensor.clock == 4 then {phase: "fetch", since: sensor.clock}
          else if sensor.clock < 4 then {phase: "look", since: 0}
          else memory.plan),
  seen = (if sensor.clock in [2, 6] then Coalesce(memory.seen, 0) + 1 else memory.seen),
  kept = memory.kept;
"""


@pytest.fixture
def level(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Level:
    monkeypatch.setenv("LOGICAL_ROBOTS_CACHE_DIR", str(tmp_path / "cache"))
    return hall(tmp_path)


async def links(level: Level, value: str, tick: int = 9, text: str = PHASES) -> tuple[Link, ...]:
    run = Run(level, Program.compile(text))
    try:
        robot = level.robots[0].name
        return (await origin_in_run(run, robot, read_path(value), tick)).links
    finally:
        await run.close()


async def test_ticks_that_only_kept_a_value_are_passed_over(level: Level) -> None:
    (link,) = await links(level, "memory.plan.phase")
    assert (link.value, link.tick, link.until) == ("fetch", 4, 9)
    assert link.span is not None
    assert link.span.text == '"fetch"'
    assert link.span.line == 5


async def test_what_a_value_was_made_from_is_followed_in_turn(level: Level) -> None:
    second, first = await links(level, "memory.seen")
    assert (second.value, second.tick, second.before) == (2, 6, (1,))
    assert (first.value, first.tick, first.until) == (1, 2, 5)


async def test_a_value_that_comes_from_a_sensor_names_the_field(level: Level) -> None:
    (link,) = await links(level, "memory.plan.since")
    assert [(r.what, path_text(r.path, "sensor"), r.value) for r in link.reads] == [
        ("sensor", "sensor.clock", 4)
    ]


async def test_a_value_that_nobody_ever_wrote_has_been_there_since_the_start(level: Level) -> None:
    (link,) = await links(level, "memory.kept")
    assert (link.value, link.tick) == (None, 1)


async def test_an_element_of_a_list_is_followed_to_the_tick_that_added_it(level: Level) -> None:
    text = """
    Item(x:) :- Memory(memory:), x in TryCast(memory, {all: [Num]}).all;
    Item(x: sensor.clock) :- Sensor(sensor:), sensor.clock in [2, 5];
    Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {all:}) :-
      Sensor(robot_name:), all = Set{x :- Item(x:)};
    """
    (link,) = await links(level, "memory.all[1]", text=text)
    assert (link.value, link.tick, link.until) == (5, 5, 9)
    assert link.rule is not None
    assert link.rule.line == 3


async def test_a_game_is_asked_with_the_program_that_decided(level: Level) -> None:
    game = Game(level, Program.compile(PHASES))
    try:
        for _ in range(6):
            await game.step()
        game.use(Program.compile(PHASES.replace("fetch", "other")))
        for _ in range(3):
            await game.step()
        origin = await origin_in_game(game, level.robots[0].name, read_path("memory.plan.phase"))
        (link,) = origin.links
        assert (link.value, link.tick) == ("fetch", 4)
    finally:
        await game.close()


async def test_a_part_that_is_not_there_is_named(level: Level) -> None:
    with pytest.raises(QueryError, match="plan has no part at"):
        await links(level, "memory.plan.at")


@pytest.mark.parametrize("text", ["plan", "memory.", "memory[x]", "memory.a..b", ""])
def test_what_names_no_part_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is not a part of a memory"):
        read_path(text)


def test_the_path_of_a_part_can_be_written_and_read() -> None:
    assert read_path("memory.plan.seen[2].at") == ("plan", "seen", 2, "at")
    assert path_text(("plan", "seen", 2, "at")) == "memory.plan.seen[2].at"
    assert read_path("memory") == ()
