"""Every shipped program drives its robots the same way on every Python and every machine.

``ticks.txt`` has a digest of each level under its starter and its references; it was written with
``pytest --update-snapshots tests/levels/test_ticks.py``.
"""

from __future__ import annotations

import hashlib
from dataclasses import astuple
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from logical_robots_tui import Mind, load_level
from logical_robots_tui.game.source import reference_names
from logical_robots_tui.world import World
from tests.levels.playing import LEVELS, shipped_program

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.values import Value

DIGESTS = Path(__file__).with_name("ticks.txt")
TICKS = 300
PLACES = 6  # decimals; the last ones are those of the processor's mathematics
PAIRS = [
    (level.name, program)
    for level in map(load_level, LEVELS)
    for program in (level.starter, *reference_names(level.solution))
    if program
]


def states(level_name: str, program_name: str) -> Iterator[Any]:
    """What the world and the memories are after each tick, until the victory at most."""
    level = load_level(level_name)
    sees = level.visibility
    world = World(level)
    mind = Mind(shipped_program(program_name), memory=sees.memory, sensor=sees.sensor)
    memories: dict[str, Value] = {robot.name: "" for robot in level.robots}
    while world.tick < TICKS and world.won_at is None:
        decisions = mind.think(world.sense(), memories)
        assert all(decision.is_reliable for decision in decisions)
        world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
        memories = {d.robot_name: d.memory for d in decisions}
        state = astuple(world.save())
        assert not state[-1]  # nothing is scored in these levels
        yield rounded([state[:-1], sorted(memories.items())])
    mind.close()


def rounded(value: Any) -> Any:
    """A value with every number of it rounded."""
    if isinstance(value, float):
        return round(value, PLACES) + 0.0  # without a sign of zero
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(inner) for inner in value]
    return value


def written() -> dict[tuple[str, str], str]:
    """The digests in the file, by level and program."""
    lines = map(str.split, DIGESTS.read_text().splitlines()) if DIGESTS.exists() else ()
    return {(level, program): digest for level, program, digest in lines}


@pytest.mark.sampled
@pytest.mark.parametrize(("level", "program"), PAIRS)
def test_the_ticks_are_those_of_every_python(
    level: str, program: str, request: pytest.FixtureRequest
) -> None:
    digest = hashlib.sha256()
    for state in states(level, program):
        digest.update(repr(state).encode())
    found = digest.hexdigest()[:32]
    if request.config.getoption("--update-snapshots"):
        known = {**written(), (level, program): found}
        lines = (
            f"{one} {other} {known[one, other]}\n" for one, other in PAIRS if (one, other) in known
        )
        DIGESTS.write_text("".join(lines))
    assert written()[level, program] == found


def test_every_pair_is_written_down() -> None:
    assert list(written()) == PAIRS
