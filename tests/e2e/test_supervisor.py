"""A game that is stuck, faults or is killed gives the terminal back and says what happened."""

import os
import re
import signal
import subprocess
import sys
import termios
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui import supervisor
from logical_robots_tui.player.drafts import Drafts
from tests.memory_use import memory_use
from tests.processes import run_command
from tests.terminal import Terminal
from tests.waiting import until

GETS_STUCK = """if True:
    import ctypes, itertools, os, sys, threading
    from logical_robots_tui import supervisor
    from logical_robots_tui.processes import lifeline

    how, computed, idle, unwatched = sys.argv.pop(1), *(float(sys.argv.pop(1)) for _ in range(3))
    supervisor._MOST_COMPUTED, supervisor._MOST_IDLE = computed, idle
    lifeline._MAX_COMPUTED = unwatched

    def get_stuck(self=None):
        os.write(1, b"stuck")
        if how == "computes in C":
            all(itertools.repeat(True))
        while how == "computes in Python":
            pass
        if how == "waits in C":
            mutex = ctypes.create_string_buffer(64)
            for _ in range(2):
                ctypes.PyDLL(None).pthread_mutex_lock(mutex)
        lock = threading.Lock()
        for _ in range(2):
            lock.acquire()
"""
WHOLE = """
    from logical_robots_tui.tui.app.app import LogicalRobotsApp
    LogicalRobotsApp.action_interrupt = get_stuck
    sys.exit(supervisor.main())
"""
SMALL = """
    import asyncio, signal, time, tty, types
    supervisor._LOOK_SECONDS, supervisor._TO_END, supervisor._COMPUTED_TO_END = 0.05, 0.2, 0.1
    lifeline._BEAT_SECONDS = 0.05

    def leave_for_an_editor():
        with lifeline.away():
            while time.process_time() < 2 * computed:
                pass
            print("editing", flush=True)
            os.read(0, 1)

    def main():
        tty.setraw(0)
        for number in (signal.SIGHUP, signal.SIGTERM):
            signal.signal(number, lambda *_: sys.exit())
        loop = asyncio.new_event_loop()
        answers = {
            b"!": get_stuck,
            b"E": leave_for_an_editor,
            b"n": lambda: print("tick 1 .", flush=True),
            b"q": loop.stop,
        }
        lifeline.beat(loop)
        loop.add_reader(0, lambda: answers[os.read(0, 1)]())
        print(end="\\x1b[?1049happlied", flush=True)
        loop.run_forever()
        return 0

    sys.modules["logical_robots_tui.cli.main"] = types.SimpleNamespace(main=main)
    sys.exit(supervisor.main())
"""
"""A game of a few keys, which is there in no time, and whose supervisor looks more often."""

NEVER = 1e9
SIZE = (90, 30)

slow = pytest.mark.slow
either_game = pytest.mark.parametrize(
    "game", [SMALL, pytest.param(WHOLE, marks=slow)], ids=["small", "whole"]
)


def playing(
    folder: Path, python: Sequence[str] = ("-m", "logical_robots_tui"), editor: str = "vi"
) -> Terminal:
    command = [sys.executable, *python, "play", "02-open-space", "--data-dir", str(folder)]
    return Terminal(command, size=SIZE, env={"EDITOR": editor}, controls=True)


@contextmanager
def watched(
    game: str, folder: Path, how: str = "waits in C", *, editor: str = "vi", **seconds: float
) -> Iterator[Terminal]:
    """A game that can get stuck; the seconds are what the supervisor, or the kernel, leaves it."""
    limits = [str(seconds.get(limit, NEVER)) for limit in ("computed", "idle", "unwatched")]
    python = ["-c", GETS_STUCK + game, how, *limits]
    with playing(folder, python, editor) as terminal:
        terminal.wait_for("applied")
        yield terminal


def get_stuck(terminal: Terminal, game: str) -> None:
    terminal.send("!" if game == SMALL else "\x03")


def make_interruptible(terminal: Terminal, game: str) -> None:
    """Make the game stuck, and wait until ^C is a signal."""
    get_stuck(terminal, game)
    until(lambda: termios.tcgetattr(terminal.fileno())[3] & termios.ISIG)


def type_hello(terminal: Terminal) -> None:
    terminal.wait_for("applied")
    terminal.send("2hello", sees="hello")


def settings(terminal: Terminal) -> list[object]:
    return list(termios.tcgetattr(terminal.fileno()))


def texts(folder: Path) -> list[str]:
    """What the next session would find, as soon as this one has ended."""
    with closing(Drafts(folder / "drafts")) as drafts:
        until(lambda: drafts.adopt("program"))
        kept = drafts.adopt("program")
    return ["hello" if "hello" in draft.text else draft.text for draft in kept]


def is_put_back(terminal: Terminal) -> bool:
    return terminal.everything.rpartition("\x1b[?1049l")[2].startswith("\x1b[0m\x1b[?7h\x1b[?25h")


@pytest.mark.parametrize(
    ("game", "how", "seconds"),
    [
        pytest.param(SMALL, "computes in C", {"computed": 0.2}, id="small, in C"),
        pytest.param(WHOLE, "waits in C", {"idle": 2.0}, id="idle in C"),
        pytest.param(WHOLE, "waits in a lock", {"idle": 2.0}, id="in a lock", marks=slow),
        pytest.param(WHOLE, "computes in C", {"computed": 1.0}, id="in C", marks=slow),
        pytest.param(WHOLE, "computes in Python", {"computed": 1.0}, id="in Python", marks=slow),
    ],
)
def test_a_stuck_game_is_ended_and_says_so(
    tmp_path: Path, game: str, how: str, seconds: dict[str, Any]
) -> None:
    with playing(tmp_path, ["-c", "pass"]) as shell:
        before = settings(shell)
    with watched(game, tmp_path, how, **seconds) as terminal:
        assert settings(terminal) != before
        if game == WHOLE:
            type_hello(terminal)
            until(lambda: list((tmp_path / "drafts").glob("*.json")))
        get_stuck(terminal, game)
        assert (terminal.finish(), settings(terminal)) == (70, before)
        assert is_put_back(terminal)
        assert "The game was stuck and was ended. Unsaved text is kept." in terminal.everything
    assert game == SMALL or texts(tmp_path) == ["hello"]


@either_game
def test_three_interrupts_end_a_stuck_game_at_once(tmp_path: Path, game: str) -> None:
    with watched(game, tmp_path) as terminal:
        make_interruptible(terminal, game)
        until(lambda: interrupts(terminal))
        assert terminal.finish() == 70
        assert is_put_back(terminal)
        assert "The game was stuck and was interrupted" in terminal.everything


def interrupts(terminal: Terminal) -> bool:
    """Press ^C once more; whether the command has ended."""
    terminal.send("\x03")
    return terminal.process.poll() is not None


@either_game
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_command_even_if_the_game_is_stuck(
    tmp_path: Path, number: signal.Signals, game: str
) -> None:
    with watched(game, tmp_path) as terminal:
        make_interruptible(terminal, game)
        terminal.process.send_signal(number)
        assert terminal.finish() == 128 + number
        assert is_put_back(terminal)


@contextmanager
def starved(process: int) -> Iterator[None]:
    """Leave a process a small share of one processor, with all that it starts."""
    place = {min(os.sched_getaffinity(0))}
    for thread in Path(f"/proc/{process}/task").iterdir():
        os.sched_setaffinity(int(thread.name), place)
    loop = ["taskset", "-c", str(min(place)), "sh", "-c", "while :; do :; done"]
    with ExitStack() as later:
        for _ in range(10):
            later.callback(later.enter_context(subprocess.Popen(loop, start_new_session=True)).kill)
        yield


@slow
def test_a_game_without_a_processor_keeps_the_text(tmp_path: Path) -> None:
    with playing(tmp_path) as terminal:
        terminal.wait_for("applied")
        with starved(terminal.game):
            type_hello(terminal)
            terminal.process.send_signal(signal.SIGHUP)
            assert terminal.finish() == 128 + signal.SIGHUP
        assert not is_put_back(terminal), "the game did not put the terminal back before it ended"
        assert terminal.everything.count("\x1b[<u") == 1
    assert texts(tmp_path) == ["hello"]


@pytest.mark.parametrize(
    ("game", "number", "said"),
    [
        (SMALL, signal.SIGSEGV, "was ended by SIGSEGV, a fault in compiled code"),
        (SMALL, signal.SIGKILL, "was ended by SIGKILL, perhaps because memory ran out"),
        pytest.param(WHOLE, signal.SIGSEGV, "was ended by SIGSEGV", marks=slow),
    ],
    ids=["fault", "kill", "fault of the whole game"],
)
def test_the_end_is_told(tmp_path: Path, game: str, number: signal.Signals, said: str) -> None:
    with playing(tmp_path, ["-c", "pass"]) as shell:
        before = settings(shell)
    with watched(game, tmp_path) as terminal:
        os.kill(terminal.game, number)
        assert terminal.finish() == 128 + number
        assert said in terminal.everything
        assert settings(terminal) == before


def test_a_game_whose_small_supervisor_is_killed_keeps_the_text_and_ends(tmp_path: Path) -> None:
    with playing(tmp_path) as terminal:
        type_hello(terminal)
        game = terminal.game
        assert memory_use(terminal.process.pid) < 12 * 1024**2
        terminal.process.kill()
        terminal.finish()
        until(lambda: not Path(f"/proc/{game}").exists())
    assert texts(tmp_path) == ["hello"]


@either_game
def test_a_stuck_game_whose_supervisor_is_killed_ends_as_well(tmp_path: Path, game: str) -> None:
    seconds = 0.2 if game == SMALL else 3.0
    with watched(game, tmp_path, "computes in C", unwatched=seconds) as terminal:
        process = terminal.game
        get_stuck(terminal, game)
        terminal.wait_for("stuck")
        terminal.process.kill()
        until(lambda: not Path(f"/proc/{process}").exists())


@either_game
def test_a_stopped_game_is_not_stuck(tmp_path: Path, game: str) -> None:
    with watched(game, tmp_path, computed=5.0, idle=3.0) as terminal:
        os.kill(terminal.game, signal.SIGSTOP)
        until(lambda: state(terminal.process.pid) == "T")
        terminal.process.send_signal(signal.SIGCONT)
        until(lambda: state(terminal.game) == "S" and state(terminal.process.pid) == "S")
        step_and_quit(terminal, "n")


def step_and_quit(terminal: Terminal, keys: str) -> None:
    terminal.send(keys, sees="tick 1 ")
    terminal.send("q")
    assert terminal.finish() == 0


def state(process: int) -> str:
    return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]


def test_another_program_in_the_terminal_is_not_taken_for_a_stuck_game(tmp_path: Path) -> None:
    with watched(SMALL, tmp_path, computed=0.2) as terminal:
        terminal.send("E", sees="editing")
        looks_before = looks(terminal.process.pid)
        until(lambda: looks(terminal.process.pid) > looks_before + 2)
        step_and_quit(terminal, " n")


def looks(supervisor: int) -> int:
    """How often a supervisor has waited for signals until it looked after the game."""
    status = Path(f"/proc/{supervisor}/status").read_text()
    return int(re.findall(r"^voluntary_ctxt_switches:\s+(\d+)", status, re.MULTILINE)[0])


@slow
def test_an_editor_in_the_terminal_is_not_taken_for_a_stuck_game(tmp_path: Path) -> None:
    editor = tmp_path / "editor"
    editor.write_text("#!/bin/sh\nsleep 6\necho '# edited' >> $1\n")
    editor.chmod(0o755)
    with watched(WHOLE, tmp_path, computed=5.0, idle=3.0, editor=str(editor)) as terminal:
        terminal.send("E", sees="open-space-starter*")
        terminal.send("q")
        assert terminal.finish() == 0


COMPUTES_IN_C = """if True:
    import itertools, sys
    from logical_robots_tui import supervisor
    from logical_robots_tui.mind.sqlite import texts
    from logical_robots_tui.processes import lifeline

    lifeline.MOST_IN_A_CALL = 0.5
    texts.upper = lambda text: all(itertools.repeat(True))
    sys.exit(supervisor.main())
"""
SHOUTS = """
Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: Upper("a")) :-
  Sensor(robot_name:);
"""


@pytest.mark.parametrize(
    "words",
    [
        "run LEVEL PROGRAM --ticks 9",
        pytest.param("query LEVEL PROGRAM --tick 1 Robot", marks=pytest.mark.slow),
        pytest.param("why LEVEL PROGRAM --tick 1 --robot Ada", marks=pytest.mark.slow),
        pytest.param("replay record LEVEL PROGRAM -o x.replay --ticks 9", marks=pytest.mark.slow),
    ],
)
def test_a_call_without_end_is_ended_and_blamed_on_the_program(words: str, tmp_path: Path) -> None:
    program = tmp_path / "shouts.l"
    program.write_text(SHOUTS, "utf-8")
    line = words.replace("LEVEL", "01-first-steps").replace("PROGRAM", str(program))
    done = run_command([sys.executable, "-c", COMPUTES_IN_C, *line.split()], cwd=tmp_path)
    assert done.returncode == supervisor.STUCK
    assert done.stderr.startswith(f"logical-robots: {line}: The program computed for 15 s")
