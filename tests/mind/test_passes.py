"""Each pass that rewrites queries may be left out: robots decide the same."""

from collections.abc import Collection, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.mind.compiling.compiler import compile_text
from logical_robots_tui.mind.tuning import sql, tune_all
from logical_robots_tui.mind.tuning.passes import PASSES
from logical_robots_tui.values import SensorRow, Value
from logical_robots_tui.world import World, list_levels, load_level
from tests.mind.differential.comparing import MEMORIES, ROWS
from tests.mind.differential.corpus import BATCHES, CASES, Case, in_one
from tests.mind.differential.whole_programs import MOMENTS, PROGRAMS
from tests.mind.rows import ROBOT, nearly_same, slow

Moment = tuple[Sequence[SensorRow], Mapping[str, Value]]

PAGE = Path(__file__).parents[2] / "docs" / "speed.md"

OPTIONAL = [step.name for step in PASSES if not step.required]
LEFT_OUT: list[Collection[str]] = [*({name} for name in OPTIONAL), OPTIONAL]
"""Each pass alone, and all of them together."""

LEVELS = {
    name: level.name
    for level in map(load_level, list_levels())
    for name in (level.starter, level.solution)
}
TICKS = (1, 9, 30)
LARGE_ARE_SLOW = [
    slow(name) if len(load_program(name).text) > 1_500 else name
    for name in list_programs()
    if not name.endswith("-starter")  # has much of what its solution has
]


@cache
def in_its_level(name: str) -> tuple[Program, list[Moment], dict[str, Any]]:
    """A shipped program, some moments of it in its level, and who sees what there."""
    level = load_level(LEVELS.get(name, "02-open-space"))
    visible = asdict(level.visibility)
    program = Program.compile(load_program(name).text)
    world = World(level)
    memories: dict[str, Value] = {}
    moments: list[Moment] = []
    with closing(Mind(program, **visible)) as mind:
        for tick in range(1, max(TICKS) + 1):
            rows = world.sense()
            if tick in TICKS:
                moments.append((rows, memories))
            decisions = mind.think(rows, memories)
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
    return program, moments, visible


def decided(program: Program, moments: list[Moment], **options: Any) -> list[Any]:
    with closing(Mind(program, **options)) as mind:
        return [
            [asdict(replace(decision, weight=0)) for decision in mind.think(rows, memories)]
            for rows, memories in moments
        ]


def check(
    program: Program, moments: list[Moment], sets: list[Collection[str]], **visible: Any
) -> None:
    """Compare decisions without passes with those of the SQL as it was generated."""
    expected = decided(program, moments, plain=True, **visible)
    for without in sets:
        tuned = tune_all({"Robot": program.statements["Robot"]}, without=without)
        assert ("Robot" in tuned) == ("Robot" in program.tuned)
        left = replace(program, tuned=tuned)
        assert nearly_same(decided(left, moments, **visible), expected), f"without {without}"


def test_each_pass_has_a_name_of_its_own_and_is_documented() -> None:
    assert len({step.name for step in PASSES}) == len(PASSES)
    for each in PASSES:
        assert f"`{each.name}`" in PAGE.read_text(encoding="utf-8")


@pytest.mark.sampled
@pytest.mark.parametrize("name", LARGE_ARE_SLOW)
def test_trees_are_those_of_their_statements_and_some_passes_may_be_left_out(name: str) -> None:
    compiled, trees = compile_text(load_program(name).text)
    assert compiled.statements["Robot"] in trees
    for statement, tree in trees.items():
        assert sql.parse(statement) == tree
    program, moments, visible = in_its_level(name)
    check(program, moments, LEFT_OUT[list_programs().index(name) % 10 :: 10], **visible)


@pytest.mark.proof
@pytest.mark.parametrize("name", list_programs())
def test_a_shipped_program_decides_the_same_without_any_pass(name: str) -> None:
    program, moments, visible = in_its_level(name)
    check(program, moments, LEFT_OUT, **visible)


def in_a_record(batch: list[Case]) -> tuple[str, str]:
    rules, calls = in_one(batch)
    return rules, f"{{{', '.join(map('{}: {}'.format, calls, calls.values()))}}}"


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("rules", "value"),
    [
        *(in_a_record(batch[::3]) for batch in BATCHES[::4]),
        *(pytest.param(*case[1:], marks=pytest.mark.proof) for case in CASES),
    ],
    ids=range(len(BATCHES[::4]) + len(CASES)),
)
def test_constructs_mean_the_same_without_any_pass(rules: str, value: str) -> None:
    text = f"{rules}\n{ROBOT}Memory(robot_name:, memory:), m = ({value});"
    check(Program.compile(text), [(ROWS, MEMORIES)], LEFT_OUT)


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("title", "sets"),
    [
        *((title, LEFT_OUT[n % 10 :: 10]) for n, title in enumerate([*PROGRAMS][::10])),
        *(pytest.param(title, LEFT_OUT, marks=pytest.mark.proof) for title in PROGRAMS),
    ],
)
def test_a_whole_program_decides_without_passes(title: str, sets: list[Collection[str]]) -> None:
    moments: list[Moment] = [(moment["rows"], MEMORIES) for moment in MOMENTS[::3]]
    check(Program.compile(PROGRAMS[title]), moments, sets, memory="all")
