"""A real terminal that sends junk, claims to be huge, falls silent or goes: the game copes."""

import os
import re
import select
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic
from typing import TypeAlias

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.memory_use import memory_use
from tests.terminal import Terminal
from tests.waiting import PATIENCE, until

FLOODS = {
    "keys beyond Unicode": b"\x1b[1114112u\x1b[99999999999u\x1b[97;1:9;1114112u",
    "a number without end": b"\x1b[" + b"1" * 5_000_000,
    "a paste of six million letters": b"\x1b[200~" + b"x" * 6_000_000 + b"\x1b[201~",
    "answers that nobody asked for": b"\x1b[1;1R" * 200_000,
    "what is no UTF-8": b"\xff\xfe\xc3" * 200_000,
    "keys": b"[]{}" * 200_000,
}


def play(tmp_path: Path, *options: str, code: str = "") -> list[str]:
    start = ["-c", code] if code else ["-m", "logical_robots_tui"]
    folder = ["--data-dir", str(tmp_path)]
    return [sys.executable, *start, "play", "01-first-steps", *options, *folder]


def flood(terminal: Terminal, data: bytes) -> None:
    fileno = terminal.fileno()
    os.set_blocking(fileno, False)
    deadline = monotonic() + PATIENCE
    while data:
        assert monotonic() < deadline, f"{len(data):,} bytes are left"
        assert terminal.process.poll() is None
        readable, writable, _ = select.select([fileno], [fileno], [], 1)
        if readable:
            os.read(fileno, 65536)
        if writable:
            data = data[os.write(fileno, data[:65536]) :]
    os.set_blocking(fileno, True)


@pytest.mark.sampled
@pytest.mark.parametrize("what", FLOODS)
def test_after_a_flood_a_key_is_answered_and_no_memory_is_lost(what: str, tmp_path: Path) -> None:
    with Terminal(play(tmp_path, "--restricted")) as terminal:
        terminal.wait_for("· applied")
        before = memory_use(terminal.game)
        flood(terminal, FLOODS[what])
        # What is typed before all of the flood has been read is dropped with it.
        terminal.press_until("\x1bn", lambda: re.search(r"tick [1-9]", terminal.text))
        assert memory_use(terminal.game) - before < 50 * 1024**2
        assert terminal.process.poll() is None


@pytest.mark.slow
def test_of_a_huge_terminal_so_much_is_drawn_and_the_player_is_told(tmp_path: Path) -> None:
    with Terminal(play(tmp_path)) as terminal:
        terminal.wait_for("· applied")
        begun = terminal.traffic
        terminal.resize(10_000, 10_000)
        deadline = monotonic() + PATIENCE
        while not terminal.has_received("Only 1000 columns", begun):
            terminal.read_for(0.2)
            assert memory_use(terminal.game) < 600 * 1024**2
            assert monotonic() < deadline
        terminal.resize(100, 40)
        assert terminal.process.poll() is None
        assert memory_use(terminal.game) < 600 * 1024**2


FAILS = """if True:
    import sys
    from logical_robots_tui.cli.main import main
    from logical_robots_tui.tui.terminal import driver

    def take(*_):
        raise LookupError("made by a test")

    driver.InputFilter.take = take
    sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
def test_a_mistake_of_ours_in_the_thread_that_reads_ends_the_game_in_order(tmp_path: Path) -> None:
    home = {"HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state")}
    with Terminal(play(tmp_path, code=FAILS), env=home) as terminal:
        terminal.wait_to_receive("\x1b[?1049h")
        terminal.send("n")
        assert terminal.finish() == 70
        assert "\x1b[?1049l" in terminal.everything
        assert "Traceback" not in terminal.everything
    logs = [path for path in (tmp_path / "state").rglob("*") if path.is_file()]
    assert any("made by a test" in path.read_text(errors="replace") for path in logs)


SOON_GONE = """if True:
    import sys
    from logical_robots_tui.tui.terminal import diff_app
    diff_app._ASK_EVERY, diff_app._SILENT, diff_app._GONE = 0.2, 1.0, 3.0
    from logical_robots_tui import supervisor
    sys.exit(supervisor.main())
"""


@pytest.mark.slow
def test_a_silent_terminal_ends_a_restricted_game_and_the_text_is_kept(tmp_path: Path) -> None:
    with Terminal(play(tmp_path, "--restricted", code=SOON_GONE)) as terminal:
        terminal.wait_for("· applied")
        terminal.send("2# typed by ada", sees="not applied")
        until(lambda: terminal.process.poll() is not None)  # nothing is read, nothing answered
    drafts = [path.read_text() for path in tmp_path.rglob("drafts/*.json")]
    assert any("# typed by ada" in draft for draft in drafts)


DEAF = """if True:
    import signal, sys
    take = signal.signal
    signal.signal = lambda at, how: None if at == signal.SIGWINCH else take(at, how)
    from logical_robots_tui import supervisor
    sys.exit(supervisor.main())
"""


def test_a_size_whose_signal_was_lost_is_noticed(tmp_path: Path) -> None:
    with Terminal(play(tmp_path, code=DEAF), size=(120, 40)) as terminal:
        terminal.wait_for("╭─ Inspector")
        terminal.resize(80, 24)
        terminal.wait_for(" 1 Map   2 Program")


# Signals can't get through, as to a thread that began to wait for a lock in the wrong moment.
STUCK = """\
import signal, sys, threading
from pathlib import Path
from logical_robots_tui.tui.terminal.crash_report import end_on_hangup

signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
end_on_hangup(lambda: Path(sys.argv[1]).write_text("kept"), lambda: None)
lock = threading.Lock()
lock.acquire()
print("stuck", flush=True)
lock.acquire()
"""

# A busy machine: when a thread has its first turn, the terminal is gone already.
BUSY = """\
import select, threading

def run(thread, run=threading.Thread.run):
    terminal = select.poll()
    terminal.register(0, 0)
    terminal.poll()
    run(thread)

threading.Thread.run = run
"""


@pytest.mark.parametrize(
    "before", ["", pytest.param(BUSY, marks=pytest.mark.slow)], ids=["idle", "busy"]
)
def test_a_deaf_main_thread_does_not_outlive_its_terminal(tmp_path: Path, before: str) -> None:
    ours, theirs = os.openpty()
    kept = tmp_path / "kept"
    command = [sys.executable, "-c", before + STUCK, str(kept)]
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    try:
        with os.fdopen(os.dup(ours)) as terminal:  # to its end: who is still writing would fail
            assert terminal.readline() == "stuck\n"
        os.close(ours)
        assert (process.wait(PATIENCE), kept.read_text()) == (129, "kept")
    finally:
        process.kill()
        process.wait(PATIENCE)


SIZE = (100, 30)
ONE_FRAME = 0.02  # seconds, so that a size finds a picture half drawn
Event: TypeAlias = "tuple[int, int] | str"  # a size, or what a terminal sends

sizes = st.tuples(st.integers(1, 240), st.integers(1, 80))
places = st.one_of(st.integers(0, 130), st.integers(0, 70_000))
mouse = st.builds(
    "\x1b[<{};{};{}{}".format,
    st.sampled_from([0, 1, 2, 3, 4, 8, 16, 32, 34, 35, 48, 64, 65, 66, 67, 128, 255]),
    *(places, places, st.sampled_from("Mm")),
)
keys = st.sampled_from([" ", "n", "p", "1", "2", "3", "?", "\t", "\x1b[A", "\x1b[B", "+", "b"])
storms = st.one_of(
    st.lists(sizes, min_size=60, max_size=60),
    st.lists(mouse, min_size=200, max_size=200),
    st.lists(st.one_of(sizes, mouse, keys), min_size=20, max_size=100),
)


def goes_through(terminal: Terminal, storm: list[Event]) -> bool:
    """Whether the game is still there after a storm, and draws; otherwise it was told to quit."""
    try:
        for event in storm:
            if isinstance(event, str):
                terminal.send(event)
                terminal.read_for(0.0)
            else:
                terminal.resize(*event)
                terminal.read_for(ONE_FRAME)
        for size in (120, 40), SIZE:
            before = terminal.traffic
            terminal.resize(*size)
            terminal.wait_for(lambda before=before: terminal.traffic > before)  # type: ignore[misc]  # a default
    except (AssertionError, OSError, ValueError):
        assert terminal.process.wait(terminal.patience) == 0, terminal.everything[-2000:]
        return False
    return True


@pytest.mark.slow  # `test_small.py` and `test_layout.py` do it without a terminal
@settings(max_examples=max(3, settings().max_examples // 4))
@given(storm=storms)
def test_no_size_and_no_place_ends_the_game(storm: list[Event]) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "04-everybody-home"]
    with (
        tempfile.TemporaryDirectory() as folder,
        Terminal([*game, "--data-dir", folder], size=SIZE, env={"EDITOR": "true"}) as terminal,
    ):
        terminal.wait_for("· applied")
        terminal.send(" ", sees="RUNNING")
        if goes_through(terminal, storm):
            terminal.press_until("\x1b?", lambda: "letters filter" in terminal.text)
