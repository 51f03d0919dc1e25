"""A real terminal that sends junk, or claims to be huge: the game answers the next key."""

from __future__ import annotations

import asyncio
import os
import re
import select
import sys
from pathlib import Path
from time import monotonic

import pytest
from textual.app import App

from logical_robots_tui.tui.terminal.driver import InputFilter, ListeningDriver
from tests.memory_use import memory_use
from tests.terminal import Terminal
from tests.waiting import PATIENCE

FLOODS = {
    "keys beyond Unicode": b"\x1b[1114112u\x1b[99999999999u\x1b[97;1:9;1114112u",
    "a number without end": b"\x1b[" + b"1" * 5_000_000,
    "a paste of six million letters": b"\x1b[200~" + b"x" * 6_000_000 + b"\x1b[201~",
    "answers that nobody asked for": b"\x1b[1;1R" * 200_000,
    "what is no UTF-8": b"\xff\xfe\xc3" * 200_000,
    "keys": b"[]{}" * 200_000,
}


def flood(terminal: Terminal, data: bytes) -> None:
    """Send without reading what comes back, but for making room."""
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
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "--restricted"]
    with Terminal([*game, "--data-dir", tmp_path]) as terminal:
        terminal.wait_for("· applied")
        before = memory_use(terminal.game)
        flood(terminal, FLOODS[what])
        # What is typed before all of the flood has been read is dropped with it.
        terminal.press_until("\x1bn", lambda: re.search(r"tick [1-9]", terminal.text))
        assert memory_use(terminal.game) - before < 50 * 1024**2
        assert terminal.process.poll() is None


@pytest.mark.slow
def test_of_a_huge_terminal_so_much_is_drawn_and_the_player_is_told(tmp_path: Path) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps"]
    with Terminal([*game, "--data-dir", tmp_path]) as terminal:
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


async def test_a_mistake_of_ours_in_the_thread_that_reads_ends_the_app(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def take(*_: object) -> None:
        raise LookupError("made by a test")

    async def hear(terminal: int) -> None:
        app: App[None] = App()
        async with app.run_test():
            driver = ListeningDriver(app)
            driver.fileno = terminal
            await asyncio.to_thread(driver.run_input_thread)

    monkeypatch.setattr(InputFilter, "take", take)
    ours, theirs = os.pipe()
    os.write(theirs, b"n")
    with pytest.raises(LookupError, match="made by a test"):
        await hear(ours)
    os.close(ours)
    os.close(theirs)


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
    game = [sys.executable, "-c", FAILS, "play", "01-first-steps", "--data-dir", tmp_path]
    home = {"HOME": str(tmp_path), "XDG_STATE_HOME": str(tmp_path / "state")}
    with Terminal(game, env=home) as terminal:
        terminal.wait_to_receive("\x1b[?1049h")
        terminal.send("n")
        assert terminal.finish() == 70
        assert "\x1b[?1049l" in terminal.everything
        assert "Traceback" not in terminal.everything
    logs = [path for path in (tmp_path / "state").rglob("*") if path.is_file()]
    assert any("made by a test" in path.read_text(errors="replace") for path in logs)
