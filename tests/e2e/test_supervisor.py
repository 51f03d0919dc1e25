"""A game that is stuck, faults or is killed gives the terminal back and says what happened."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import termios
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.player.drafts import Drafts
from tests.memory_use import memory_use
from tests.terminal import Terminal
from tests.waiting import until

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

GETS_STUCK = """
import sys, threading
from logical_robots_tui import supervisor
from logical_robots_tui.processes import lifeline
from logical_robots_tui.tui.app.app import LogicalRobotsApp
how, computed, idle = sys.argv.pop(1), float(sys.argv.pop(1)), float(sys.argv.pop(1))
def get_stuck(self):
    if how == "in C":
        str(10**10**9)
    while how == "in Python":
        pass
    lock = threading.Lock()
    lock.acquire()
    lock.acquire()
LogicalRobotsApp.action_interrupt = get_stuck
supervisor._MOST_COMPUTED, supervisor._MOST_IDLE = computed, idle
lifeline._MOST_COMPUTED = 5.0
sys.exit(supervisor.main())
"""
NEVER = 1e9
SIZE = (100, 30)


def playing(
    folder: Path, python: Sequence[str] = ("-m", "logical_robots_tui"), editor: str = "vi"
) -> Terminal:
    command = [sys.executable, *python, "play", "02-open-space", "--data-dir", str(folder)]
    return Terminal(command, size=SIZE, env={"EDITOR": editor}, controls=True)


def getting_stuck(
    folder: Path, how: str, *, computed: float = NEVER, idle: float = NEVER, editor: str = "vi"
) -> Terminal:
    return playing(folder, ["-c", GETS_STUCK, how, str(computed), str(idle)], editor)


def type_hello(terminal: Terminal) -> None:
    terminal.wait_for("applied")
    terminal.send("2hello")
    terminal.wait_for("hello")


def settings(terminal: Terminal) -> list[object]:
    return list(termios.tcgetattr(terminal.fileno()))


def texts(folder: Path) -> list[str]:
    """What the next session would find, as soon as this one has ended."""
    drafts = Drafts(folder / "drafts")
    until(lambda: drafts.adopt("program"))
    found = drafts.adopt("program")
    drafts.close()
    return ["hello" if "hello" in draft.text else draft.text for draft in found]


def is_put_back(terminal: Terminal) -> bool:
    return terminal.everything.rpartition("\x1b[?1049l")[2].startswith("\x1b[0m\x1b[?7h\x1b[?25h")


@pytest.mark.parametrize("how", ["in C", "in Python", "in a lock"])
def test_a_stuck_game_is_ended_and_says_so(tmp_path: Path, how: str) -> None:
    idle = 2.0 if how == "in a lock" else NEVER
    with getting_stuck(tmp_path, how, computed=1.0, idle=idle) as terminal:
        before = settings(terminal)
        type_hello(terminal)
        assert settings(terminal) != before
        until(lambda: list((tmp_path / "drafts").glob("*.json")))
        terminal.send("\x03")
        assert terminal.finish() == 70
        assert settings(terminal) == before
        assert is_put_back(terminal)
        assert "The game was stuck and was ended. Unsaved text is kept." in terminal.everything
    assert texts(tmp_path) == ["hello"]


def test_three_interrupts_end_a_stuck_game_at_once(tmp_path: Path) -> None:
    with getting_stuck(tmp_path, "in C") as terminal:
        type_hello(terminal)
        terminal.send("\x03")
        until(lambda: termios.tcgetattr(terminal.fileno())[3] & termios.ISIG)
        until(lambda: interrupts(terminal))
        assert terminal.finish() == 70
        assert is_put_back(terminal)
        assert "The game was stuck and was interrupted" in terminal.everything


def interrupts(terminal: Terminal) -> bool:
    """Press ^C once more; whether the command has ended."""
    terminal.send("\x03")
    return terminal.process.poll() is not None


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_command_even_if_the_game_is_stuck(
    tmp_path: Path, number: signal.Signals
) -> None:
    with getting_stuck(tmp_path, "in C") as terminal:
        type_hello(terminal)
        terminal.send("\x03")
        until(lambda: termios.tcgetattr(terminal.fileno())[3] & termios.ISIG)
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
        for _ in range(20):
            later.callback(later.enter_context(subprocess.Popen(loop, start_new_session=True)).kill)
        yield


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_game_without_a_processor_has_time_to_keep_the_text(
    tmp_path: Path, number: signal.Signals
) -> None:
    with playing(tmp_path) as terminal:
        terminal.wait_for("applied")
        with starved(terminal.game):
            type_hello(terminal)
            terminal.process.send_signal(number)
            assert terminal.finish() == 128 + number
        by_both = terminal.everything.count("\x1b[?1049l")
        assert by_both == 2, "the game did not put the terminal back before it ended"
    assert texts(tmp_path) == ["hello"]


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (signal.SIGSEGV, "was ended by SIGSEGV, a fault in compiled code"),
        (signal.SIGKILL, "was ended by SIGKILL, perhaps because memory ran out"),
    ],
)
def test_what_ended_a_game_is_said(tmp_path: Path, number: signal.Signals, said: str) -> None:
    with playing(tmp_path) as terminal:
        before = settings(terminal)
        terminal.wait_for("applied")
        os.kill(terminal.game, number)
        assert terminal.finish() == 128 + number
        assert said in terminal.everything
        assert settings(terminal) == before


def test_a_game_whose_supervisor_is_killed_keeps_the_text_and_ends(tmp_path: Path) -> None:
    with playing(tmp_path) as terminal:
        type_hello(terminal)
        game = terminal.game
        terminal.process.kill()
        until(lambda: not Path(f"/proc/{game}").exists())
    assert texts(tmp_path) == ["hello"]


def test_a_stuck_game_whose_supervisor_is_killed_ends_as_well(tmp_path: Path) -> None:
    with getting_stuck(tmp_path, "in C") as terminal:
        terminal.wait_for("applied")
        game = terminal.game
        terminal.send("\x03")
        until(lambda: termios.tcgetattr(terminal.fileno())[3] & termios.ISIG)
        terminal.process.kill()
        until(lambda: not Path(f"/proc/{game}").exists())


def test_a_stopped_game_is_not_stuck(tmp_path: Path) -> None:
    with getting_stuck(tmp_path, "in C", computed=5.0, idle=3.0) as terminal:
        terminal.wait_for("applied")
        os.kill(terminal.game, signal.SIGSTOP)
        until(lambda: state(terminal.process.pid) == "T")
        terminal.process.send_signal(signal.SIGCONT)
        until(lambda: state(terminal.game) == "S" and state(terminal.process.pid) == "S")
        terminal.send("n")
        terminal.wait_for("tick 1 ")
        terminal.send("q")
        assert terminal.finish() == 0


def state(process: int) -> str:
    return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]


def test_another_program_in_the_terminal_is_not_taken_for_a_stuck_game(tmp_path: Path) -> None:
    editor = tmp_path / "editor"
    editor.write_text("#!/bin/sh\nsleep 6\necho '# edited' >> $1\n")
    editor.chmod(0o755)
    with getting_stuck(tmp_path, "in C", computed=5.0, idle=3.0, editor=str(editor)) as terminal:
        terminal.wait_for("applied")
        terminal.send("E")
        terminal.wait_for("open-space-starter*")
        terminal.send("q")
        assert terminal.finish() == 0


def test_the_supervisor_is_small(tmp_path: Path) -> None:
    with playing(tmp_path) as terminal:
        terminal.wait_for("applied")
        assert memory_use(terminal.process.pid) < 12 * 1024**2
        terminal.send("q")
        assert terminal.finish() == 0
