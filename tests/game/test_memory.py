"""What a game holds is bounded, as the process holds it, whatever the program remembers."""

import os
import sys
from copy import deepcopy
from typing import Any

import orjson
import pytest

from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.mind.limits import MAX_CHARACTER_WEIGHT as HEAVIEST
from logical_robots_tui.mind.limits import weight_of, weight_of_row, weight_of_text
from logical_robots_tui.values import Value
from tests.mind.rows import ROBOT, row
from tests.processes import run_command
from tests.waiting import PATIENCE

MOST = 600 * 1024  # KiB that the whole process may hold, with room for the screen
SCREEN = 60 * 1024  # KiB that the screen needs besides
ADDRESSES = 2 * 1024**3  # bytes, as in restricted mode
PLAYS = """if True:
    import asyncio, re, resource, sys
    from logical_robots_tui import Game, Program, load_level
    from logical_robots_tui.mind import compilation
    level, text, ticks, addresses = sys.argv[1:]
    program = Program.compile(text)
    resource.setrlimit(resource.RLIMIT_AS, (int(addresses),) * 2)
    DROPPING = 8  # ticks after which a game that drops as many as it adds has shown what it takes

    async def play():
        game = Game(load_level(level), program)
        said, ends = set(), int(ticks)
        while game.frame.tick < ends:
            frame = await game.step()
            said |= {n.kind for d in frame.decisions for n in d.notices}
            assert len(frame.decisions) == len(frame.after.robots)
            if game.history.dropped and "dropped" not in said:
                said.add("dropped")
                ends = min(ends, frame.tick + DROPPING)
        game.go_to(game.history.first)
        assert game.frame_at(game.history.last).tick == ends
        await game.close()
        return said

    said = asyncio.run(play())
    status = open("/proc/self/status").read()
    most = re.search(r"VmHWM:\\s+(\\d+)", status)[1]
    print(most, *sorted(kind.replace(" ", "_") for kind in said))
"""
STARVES = """if True:
    import asyncio, re, resource, sys
    from logical_robots_tui import Game, Program, load_level
    from tests.mind.rows import ROBOT
    level, room = sys.argv[1], int(sys.argv[2]) * 1024
    program = Program.compile(ROBOT + "m = sensor.clock;")

    async def play():
        game = Game(load_level(level), program)
        await game.step()
        status = open("/proc/self/status").read()
        size = int(re.search(r"VmSize:\\s+(\\d+)", status)[1]) * 1024
        resource.setrlimit(resource.RLIMIT_AS, (size + room, resource.RLIM_INFINITY))
        try:
            await game.step()
        except MemoryError:
            print("no memory")
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY,) * 2)
        await game.close()

    asyncio.run(play())
"""
HUNGRY = {
    "long texts that change": 'm = Format("%0900000d", sensor.clock)',
    "short enough long texts": 'm = Format("%0400000d", sensor.clock)',
    "empty records": "m = {clock: sensor.clock, list: List{{} :- i in Range(20000)}}",
    "empty lists": "m = {clock: sensor.clock, list: List{[] :- i in Range(20000)}}",
    "many numbers": "m = List{sensor.clock * i / 7 :- i in Range(19000)}",
    "what can't be packed": "m = List{NaturalHash(ToString(sensor.clock * i)) :- i in Range(9000)}",
    "all that was": 'Memory(robot_name:, memory:), m = [memory, Format("%090000d", sensor.clock)]',
}
SHORT_LISTS = 'i in Range(800), m = "[" ++ i ++ Replace(Format("%03000d", 0), "0", ",{}") ++ "]"'
MANY_ROWS = {"many rows": "m in Range(10000)", "many rows of short lists": SHORT_LISTS}
DENSE = (
    "a = List{NaturalHash(ToString(sensor.clock * i)) :- i in Range(19000)}, "
    "b = List{NaturalHash(ToString(7 * sensor.clock + i)) :- i in Range(19000)}, m = {a:, b:}"
)


def played(
    level: str, text: str, ticks: int, addresses: int = ADDRESSES, patience: float = 10 * PATIENCE
) -> tuple[int, set[str]]:
    """The most KiB that a game held, and the kinds of notices that it gave.

    The game ends after so many ticks, or a few after its history began to drop the oldest ones.
    """
    command = [sys.executable, "-c", PLAYS, level, text, ticks, addresses]
    done = run_command(command, timeout=patience)
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    most, *kinds = done.stdout.split()
    return int(most), set(kinds)


@pytest.mark.slow
@pytest.mark.parametrize("what", HUNGRY)
def test_one_robot_s_memories_stay_within_bounds(what: str) -> None:
    most, _ = played("01-first-steps", ROBOT + HUNGRY[what] + ";", 130)
    assert most < MOST - SCREEN


@pytest.mark.proof
def test_one_robot_fills_the_history_and_the_oldest_ticks_are_dropped() -> None:
    most, kinds = played("01-first-steps", ROBOT + DENSE + ";", 2000)
    assert kinds == {"dropped"}
    assert most < MOST - SCREEN


def in_a_crowd(name: str) -> Any:
    return pytest.param(name, marks=[pytest.mark.proof] * (not name.startswith("long")))


@pytest.mark.slow
@pytest.mark.parametrize("what", [*map(in_a_crowd, HUNGRY | MANY_ROWS)])
def test_the_memories_of_a_hundred_stay_within_bounds(what: str) -> None:
    ticks = 25 if what == "what can't be packed" else 10
    most, kinds = played("13-swarm", ROBOT + (HUNGRY | MANY_ROWS)[what] + ";", ticks)
    assert most < MOST - SCREEN
    assert kinds <= {"no_memory", "failed", "several_rows", "dropped"}
    assert ("dropped" in kinds) == (what == "what can't be packed")


def test_without_room_a_thought_is_a_notice_and_the_game_goes_on() -> None:
    _, kinds = played("01-first-steps", ROBOT + "m = sensor.clock;", 40, 420 * 1024**2)
    assert kinds == {"no_room"}


ROOMS = (("01-first-steps", 20_000), ("13-swarm", 200))
MORE = [pytest.param(*room, marks=pytest.mark.slow) for room in ROOMS]


@pytest.mark.parametrize(("level", "room"), [("01-first-steps", 50), *MORE])
def test_without_room_to_sense_a_game_ends_with_an_exception_no_crash(
    level: str, room: int
) -> None:
    arena = {"MALLOC_ARENA_MAX": "1"}  # no room is left in other ones
    done = run_command([sys.executable, "-c", STARVES, level, room], env=os.environ | arena)
    assert (done.returncode, done.stdout) == (0, "no memory\n"), done.stderr[-2000:]


SHAPES: tuple[Value, ...] = ({}, [], {"a": 1}, {"": 1}, 1.5, [[[[[1]]]]], "ä" * 10, 1, [1])


def test_what_text_says_of_objects_is_never_too_little() -> None:
    values: list[Value] = [[deepcopy(shape) for _ in range(5000)] for shape in SHAPES]
    for value in (*values, "x" * 100_000, [1]):
        text = orjson.dumps(value).decode()
        weight = weight_of(value, 10**9)
        assert weight < weight_of_row(["Ada", text])
        assert weight <= min(weight_of_text(text), len(text) * HEAVIEST)
        assert len(text) < 1000 or weight_of(value, 1000) > 1000


def test_a_memory_too_heavy_as_objects_is_told_and_the_old_one_kept() -> None:
    program = Program.compile(ROBOT + "m = List{{} :- i in Range(9000)};")
    mind = Mind(program, limits=Limits(memory_weight=500_000))
    (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
    mind.close()
    (notice,) = decision.notices
    assert (decision.memory, notice.kind) == ("kept", "no memory")
    assert "more than the 500,000 bytes" in notice.message
    assert decision.is_reliable
