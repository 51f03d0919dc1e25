"""Every shipped program drives its robots the same way on every Python and every machine.

``ticks.txt`` says it of each level under its starter and its references; it was written with
``pytest --update-snapshots tests/levels/test_ticks.py``. A run begins with a line of level,
program, ticks and a digest of all that is compared. The rows below it tell where the difference is
if there is one: a row for each field of a robot, of all areas and of the world has a character for
every `WINDOW` ticks, the beginning of a digest of the values in them; or the value itself, after
``=``, if it never changes. Of more than `MOST_ROBOTS` robots the others share their rows.
"""

import base64
import hashlib
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from logical_robots_tui import Mind
from logical_robots_tui.game.source import reference_names
from logical_robots_tui.values import Value
from logical_robots_tui.world import World
from tests.levels.playing import LEVELS, is_small, load_level, shipped_program, slow

FILE = Path(__file__).with_name("ticks.txt")
TICKS = 200
THOUGHTS = 6_000  # of a swarm, for which that is fewer ticks
WINDOW = 5
PLACES = 6  # decimals; the last ones are those of the processor's mathematics
MOST_ROBOTS, LONGEST = 8, 30
MOVES = ("x", "y", "angle", "left_engine", "right_engine", "blocked")
OF_ROBOT = (*MOVES, "battery_level", "dead")
OF_AREA = ("active", "visitors")
PAIRS = [
    (level.name, program)
    for level in map(load_level, LEVELS)
    for program in (level.starter, *reference_names(level.solution))
    if program
]
SEVERAL = LEVELS[3]  # from this level on there are several robots


def states(level_name: str, program_name: str, ticks: int = TICKS) -> Iterator[dict[str, Any]]:
    """The values of each field after each tick, until the victory at most."""
    level = load_level(level_name)
    ticks = min(ticks, THOUGHTS // len(level.robots))
    world = World(level)
    mind = Mind.for_level(shipped_program(program_name), level)
    memories: dict[str, Value] = {robot.name: "" for robot in level.robots}
    while world.tick < ticks and world.won_at is None:
        decisions = mind.think(world.sense(), memories)
        assert all(decision.is_reliable for decision in decisions)
        world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
        memories = {d.robot_name: d.memory for d in decisions}
        state = world.save()
        assert not state.tallies  # nothing is scored in these levels
        fields: dict[str, Any] = {"world won_at": state.won_at}
        for place, robot in enumerate(state.robots):
            name = robot.name if place < MOST_ROBOTS else "others"
            for field in OF_ROBOT:
                fields.setdefault(f"{name} {field}", []).append(rounded(getattr(robot, field)))
            fields.setdefault(f"{name} memory", []).append(rounded(memories[robot.name]))
        for field in OF_AREA:
            fields[f"areas {field}"] = [rounded(getattr(area, field)) for area in state.areas]
        yield fields
    mind.close()


def rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, PLACES) + 0.0  # without a sign of zero
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(inner) for inner in value]
    return value


class Ticks(NamedTuple):
    ticks: int
    digest: str
    rows: dict[str, str]
    """By field, such as "Ada x"."""


def ticks_of(run: list[dict[str, Any]]) -> Ticks:
    digest = hashlib.sha256(repr(run).encode()).hexdigest()[:32]
    rows = {field: row([repr(state[field]) for state in run]) for field in run[0]}
    return Ticks(len(run), digest, rows)


def row(texts: list[str]) -> str:
    if len(set(texts)) == 1 and len(texts[0]) < LONGEST and texts[0].isprintable():
        return f"= {texts[0]}"
    return in_windows(texts)


def in_windows(texts: list[str]) -> str:
    """A character for the values in each window."""
    windows = ["\n".join(texts[at : at + WINDOW]) for at in range(0, len(texts), WINDOW)]
    digests = [hashlib.sha256(window.encode()).digest() for window in windows]
    return "".join(base64.b64encode(digest)[:1].decode() for digest in digests)


def first_difference(expected: Ticks, found: Ticks) -> str:
    """The ticks in which a run is not as it was, and the fields that differ in them."""
    places: dict[str, int] = {}
    for field in expected.rows | found.rows:
        one, other = (
            in_windows([text[2:]] * run.ticks) if text.startswith("= ") else text
            for run in (expected, found)
            for text in [run.rows.get(field, "")]
        )
        pairs = enumerate(zip_longest(one, other))
        places[field] = next((at for at, (a, b) in pairs if a != b), TICKS)
    at = min(places.values())
    fields = ", ".join(field for field, place in places.items() if place == at)
    return f"ticks {at * WINDOW + 1} to {(at + 1) * WINDOW}: {fields}"


def written() -> dict[tuple[str, str], Ticks]:
    runs: dict[tuple[str, str], Ticks] = {}
    rows: dict[str, str] = {}
    for line in FILE.read_text("utf-8").splitlines() if FILE.exists() else ():
        if line.startswith(" "):
            field, _, values = line.strip().partition(": ")
            rows[field] = values
        else:
            level, program, ticks, digest = line.split()
            rows = {}
            runs[level, program] = Ticks(int(ticks), digest, rows)
    return runs


def write(runs: dict[tuple[str, str], Ticks]) -> None:
    lines = []
    for pair in PAIRS:
        if pair in runs:
            ticks, digest, rows = runs[pair]
            lines += [f"{' '.join(pair)} {ticks} {digest}", *(f" {f}: {rows[f]}" for f in rows)]
    FILE.write_text("".join(f"{line}\n" for line in lines), "utf-8")


@pytest.mark.parametrize(
    ("level", "program"),
    [
        pytest.param(*pair, marks=slow(pair[0] >= SEVERAL or not is_small(pair[1])))
        for pair in PAIRS
    ],
)
def test_the_ticks_are_those_of_every_python(
    level: str, program: str, request: pytest.FixtureRequest
) -> None:
    found = ticks_of(list(states(level, program)))
    if request.config.getoption("--update-snapshots"):
        write({**written(), (level, program): found})
    expected = written()[level, program]
    assert found.digest == expected.digest, first_difference(expected, found)


def test_every_pair_is_written_down_and_the_file_is_not_long() -> None:
    assert list(written()) == PAIRS
    assert FILE.stat().st_size < 150_000


def test_a_difference_is_told_by_its_robot_tick_and_field() -> None:
    pair = PAIRS[0]
    run, expected = list(states(*pair, ticks=23)), written()[pair]
    short = ticks_of(run)
    assert short.rows.keys() == expected.rows.keys()
    for tick, field, value, told in (
        (7, "Ada x", [1.5], "ticks 6 to 10: Ada x"),
        (21, "Ada dead", [True], "ticks 21 to 25: Ada dead"),
        (23, "world won_at", 23, "ticks 21 to 25: world won_at"),
    ):
        changed = [
            {**state, field: value} if at >= tick else state for at, state in enumerate(run, 1)
        ]
        assert first_difference(short, ticks_of(changed)) == told
    assert first_difference(short, ticks_of(run[:12])).startswith("ticks 11 to 15: ")
