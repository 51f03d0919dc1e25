"""No clock decides what robots do: a run on a busy machine is the run on an idle one."""

import signal
import subprocess
import sys
from contextlib import suppress

import pytest

from logical_robots_tui import Program, list_levels, load_level
from logical_robots_tui.game.measuring import LateError, play_through
from logical_robots_tui.world.levels.native import read_native
from tests.game.playing import Play
from tests.short import AHEAD, LEVEL

DIGEST = """if True:
    import asyncio, hashlib, sys
    from logical_robots_tui import Game, Program, load_level
    from logical_robots_tui.game import load_program

    async def digest(name, ticks):
        level = load_level(name)
        game = Game(level, Program.compile(load_program(level.solution).text))
        found = hashlib.sha256()
        while game.frame.tick < ticks and game.won_at is None:
            frame = await game.step()
            found.update(repr((frame.after, frame.decisions, frame.memories)).encode())
        await game.close()
        return found.hexdigest(), game.frame.tick

    for name in sys.argv[2:]:
        print(name, *asyncio.run(digest(name, int(sys.argv[1]))), flush=True)
"""
ON, OFF = 0.005, 0.045  # seconds


def told(ticks: int, *names: str, starved: bool = False) -> str:
    """What the ticks of levels come to, in a process that may have a tenth of a processor."""
    command = [sys.executable, "-c", DIGEST, str(ticks), *names]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        first = process.stdout.readline()  # compiled and under way
        while starved and process.poll() is None:
            for sign, seconds in ((signal.SIGSTOP, OFF), (signal.SIGCONT, ON)):
                process.send_signal(sign)
                with suppress(subprocess.TimeoutExpired):
                    process.wait(seconds)
        return first + process.stdout.read()


@pytest.mark.proof
@pytest.mark.parametrize("name", [name for name in list_levels() if load_level(name).solution])
def test_with_a_tenth_of_a_processor_a_shipped_pair_plays_the_same(name: str) -> None:
    first = "01-first-steps"
    assert told(1000, first, name, starved=True) == told(1000, first, name)


@pytest.mark.slow
def test_with_a_tenth_of_a_processor_a_run_is_the_same() -> None:
    names = ("01-first-steps", "01-first-steps")  # the first one is compiled before it starves
    assert told(60, *names, starved=True) == told(60, *names)


@pytest.mark.usefixtures("late")
async def test_from_the_tick_in_which_a_clock_ended_a_thought_none_is_reliable(play: Play) -> None:
    game = play(AHEAD, read_native(LEVEL, "short", ""))
    frame = await game.run_until(tick=5)
    assert frame.is_reliable
    history = game.history
    assert [history.is_reliable_up_to(tick) for tick in range(6)] == [True] * 3 + [False] * 3
    game.go_to(2)
    game.forget_future()
    assert history.is_reliable_up_to(2)


@pytest.mark.usefixtures("late")
def test_no_measure_is_taken_from_a_run_in_which_the_clock_ended_a_thought() -> None:
    with pytest.raises(LateError):
        play_through(read_native(LEVEL, "short", ""), Program.compile(AHEAD), 100)
