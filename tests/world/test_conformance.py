"""The world does what the web platform was recorded to do."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.values import Desire, SensorRow
from logical_robots_tui.world import AreaState, RobotState, World, WorldState, load_level

from .records import OBJECT_CODES, TRACES, Trace, read_trace, scripted_desires

TOLERANCE = 1e-6
ONE_OF_EACH_LEVEL = [
    pytest.param(path, id=path.stem, marks=[pytest.mark.slow] * (number % 2 != number // 2 % 2))
    for number, path in enumerate(TRACES)
]
"""Traces of which the quick choice has one of a level, of one script and the other by turns."""


def near(found: float, recorded: float) -> bool:
    """What `pytest.approx` says, in a tenth of its time."""
    return abs(found - recorded) <= TOLERANCE


def test_all_traces_are_there() -> None:
    assert len(TRACES) == 22


@pytest.mark.parametrize("path", ONE_OF_EACH_LEVEL)
def test_a_free_run_follows_the_trace_from_start_to_end(path: Path) -> None:
    trace = read_trace(path)
    world = World(load_level(trace.level_path))
    _check_state(world, trace.start)
    events: list[list[Any]] = []
    for tick in range(1, trace.header["ticks"] + 1):
        before = world.save()
        rows = world.sense()
        desires = scripted_desires(trace.header["script"], tick, rows)
        world.act(desires)
        events += _events(before, world.save())
        if tick in trace.ticks:
            _check_senses(rows, desires, trace, trace.ticks[tick])
            _check_state(world, trace.ticks[tick])
    assert sorted(map(str, events)) == sorted(map(str, trace.events))
    assert len(trace.ticks) > 80


@pytest.mark.parametrize("path", TRACES, ids=lambda path: path.stem)
def test_every_recorded_tick_follows_from_the_recorded_one_before(path: Path) -> None:
    trace = read_trace(path)
    world = World(load_level(trace.level_path))
    before = trace.start
    for tick in range(1, 13):
        after = trace.ticks[tick]
        world.restore(_recorded_state(before, trace))
        rows = world.sense()
        desires = scripted_desires(trace.header["script"], tick, rows)
        _check_senses(rows, desires, trace, after)
        world.act(desires)
        _check_state(world, after)
        before = after


def _recorded_state(record: dict[str, Any], trace: Trace) -> WorldState:
    names = trace.header["robots"]
    return WorldState(
        tick=record["t"],
        robots=tuple(
            RobotState(name, robot["x"], robot["y"], robot["a"], robot["b"])
            for name, robot in zip(names, record["robots"], strict=True)
        ),
        areas=tuple(
            AreaState(name, bool(area["on"]), tuple(names[i] for i in area["in"]))
            for name, area in zip(trace.header["areas"], record["areas"], strict=True)
        ),
        won_at=record["t"] if record["won"] else None,
    )


def _check_state(world: World, record: dict[str, Any]) -> None:
    assert world.tick == record["t"]
    for state, robot in zip(world.robots, record["robots"], strict=True):
        assert near(state.x, robot["x"])
        assert near(state.y, robot["y"])
        assert near(math.remainder(state.angle - robot["a"], math.tau), 0)
        assert near(state.battery_level, robot["b"])
    names = [robot.name for robot in world.robots]
    seen_areas = [
        {"on": int(area.active), "in": [names.index(visitor) for visitor in area.visitors]}
        for area in world.areas
    ]
    assert seen_areas == record["areas"]
    assert world.won == bool(record["won"])


def _check_senses(
    rows: list[SensorRow], desires: Mapping[str, Desire], trace: Trace, record: dict[str, Any]
) -> None:
    labels = trace.header["labels"]
    assert [row["robot_name"] for row in rows] == trace.header["robots"]
    for row, robot in zip(rows, record["robots"], strict=True):
        sensor = row["sensor"]
        assert sensor["clock"] == record["t"]
        assert sensor["forward_distance"] == robot["fd"]
        assert sensor["forward_object"] == OBJECT_CODES[robot["fo"]]
        assert sensor["forward_label"] == labels[robot["fl"]]
        assert [ray["distance"] for ray in sensor["radar"]] == robot["rd"]
        assert [ray["object"] for ray in sensor["radar"]] == [OBJECT_CODES[c] for c in robot["ro"]]
        assert [ray["label"] for ray in sensor["radar"]] == [labels[i] for i in robot["rl"]]
        assert near(sensor["self"]["battery_level"], robot["sb"])
        desire = desires[row["robot_name"]]
        assert near(desire.left_engine, robot["dl"])
        assert near(desire.right_engine, robot["dr"])


def _events(before: WorldState, after: WorldState) -> list[list[Any]]:
    events: list[list[Any]] = []
    names = [robot.name for robot in after.robots]
    for i, (old, new) in enumerate(zip(before.areas, after.areas, strict=True)):
        if old.active != new.active:
            events.append([after.tick, "on" if new.active else "off", i])
        for robot, name in enumerate(names):
            if (name in new.visitors) != (name in old.visitors):
                events.append([after.tick, "enter" if name in new.visitors else "leave", i, robot])
    if before.won_at is None and after.won_at is not None:
        events.append([after.won_at, "won"])
    return events
