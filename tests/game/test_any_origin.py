"""Origins in any state machine: the tick of the last change, and nothing that is not true."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.explain.why.explanation import Subject, part_of
from logical_robots_tui.game import Link, origin_in_run
from logical_robots_tui.mind import QueryError
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level
from tests.game.playing import hall
from tests.game.test_run import opened

TICKS = 24


@st.composite
def machines(draw: Callable[..., Any]) -> str:
    """A program whose memory has four fields, each made in a way of its own."""

    def number(low: int, high: int) -> int:
        return int(draw(st.integers(low, high)))

    def field(name: str) -> str:
        other = f"f{number(0, 3)}"
        mine, k = f"memory.{name}", number(1, TICKS)
        options = [
            f"(if sensor.clock == {k} then {number(0, 3)} else {mine})",
            f"Greatest(Coalesce({mine}, {k}) - 1, 0)",
            f"(if Mod(sensor.clock, {k}) == 0 then Coalesce({mine}, 0) + 1 else {mine})",
            f"(if sensor.clock > {k} then Coalesce(memory.{other}, 0) + 1 else 5)",
            f"Step(Coalesce({mine}, 0))",
            f"Coalesce({mine}, 0) / 2 + sensor.clock",
            f"(if Mod(sensor.clock, {k}) == 0 then next else now)",
            f"Max{{m.{other} :- Memory(memory: m)}}",
            f"Heard(robot_name, {number(0, 3)})",
            f"memory.{other}",
        ]
        return options[number(0, len(options) - 1)]

    fields = ", ".join(f"f{n} = {field(f'f{n}')}" for n in range(4))
    chosen = f"f{number(0, 3)}"
    return f"""
@Visible(Memory, "all");
Plan(phase: 0, next: 1); Plan(phase: 1, next: 2); Plan(phase: 2, next: 2); Plan(phase: 2, next: 3);
Step(x) = (if x > 2 then 0 else x + 1);
Heard(name, least) = Min{{m.{chosen} :- Memory(robot_name: who, memory: m), who != name,
  m.{chosen} >= least}};
Robot(robot_name:, desire: {{left_engine: 0, right_engine: 0}}, memory: {{f0:, f1:, f2:, f3:}}) :-
  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),
  Plan(phase: now, next:), now == Coalesce(memory.{chosen}, 0),
  {fields};
"""


def part(memory: Value, path: Any) -> object:
    try:
        return part_of(memory, path)
    except QueryError:
        return KeyError


@settings(max_examples=3 if settings().max_examples < 20 else 20, deadline=None)
@given(machines(), st.data())
def test_the_tick_is_that_of_the_last_change_and_all_else_is_true(text: str, data: Any) -> None:
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setenv("LOGICAL_ROBOTS_CACHE_DIR", folder)
        asyncio.run(_check(hall(Path(folder)), text, data))


async def _check(level: Level, text: str, data: Any) -> None:
    names = [robot.name for robot in level.robots]
    async with opened(level, text) as run:
        frames = [it async for it in run.map_ticks(0, TICKS, lambda frame, _mind, _stop: frame)]
        for _ in range(4):
            name, field = data.draw(st.sampled_from(names)), data.draw(st.integers(0, 3))
            tick = data.draw(st.integers(1, TICKS))
            path = (f"f{field}",)
            values = [part(frame.memories[name], path) for frame in frames]
            if values[tick] is KeyError:
                continue
            origin = await origin_in_run(run, name, Subject(path=path), tick)
            changes = [at for at in range(1, tick + 1) if values[at] != values[at - 1]]
            assert origin.links[0].tick == max(changes)
            for link in origin.links:
                _check_link(link, [frame.memories for frame in frames])


def _check_link(link: Link, memories: list[Any]) -> None:
    assert link.problem == ""
    if link.path is not None:
        values = [part(each[link.robot], link.path) for each in memories]
        assert {*values[link.tick : link.until + 1]} == {link.value}
        assert link.source is None or values[link.tick - 1] != link.value
        if (steps := link.steps) is not None:
            assert values[steps.since - 1] == steps.begin
            pairs = [(values[t], values[t - 1]) for t in range(steps.since, link.tick + 1)]
            assert sum(now != before for now, before in pairs) == steps.times
            if steps.increment is not None:
                by = [now - before for now, before in pairs if now != before]  # type: ignore[operator]  # numbers
                assert by == pytest.approx([steps.increment] * steps.times)
    for each in link.inputs:
        if each.read is not None and each.read.kind == "memory":
            before = memories[link.tick - 1][each.read.robot]
            assert part(before, each.read.path) in (each.value, KeyError)
