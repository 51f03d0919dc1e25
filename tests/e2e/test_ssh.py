"""The installed game over a real sshd, a real ssh client and lines of all kinds."""

import os
import re
import shlex
import statistics
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.e2e.conftest import TYPED
from tests.e2e.tmux import PROMPT, Tmux
from tests.installed import Installed
from tests.processes import is_running
from tests.sshd import SSHD, Line, Server
from tests.terminal import Terminal
from tests.waiting import until

pytestmark = pytest.mark.skipif(
    SSHD is None and "CI" not in os.environ, reason="openssh-server is not installed"
)

THREE_ROBOTS = ("07-station-management", "station-management")
SIX_ROBOTS = ("10-distributed-mapping", "distributed-mapping")
FRAMES = 60
BEFORE_A_KEY = 6_000  # bytes, of which the slowest line carries 20,000 a second


@dataclass(frozen=True)
class Host:
    server: Server
    folder: Path
    game: Path

    def command(self, data: Path, *arguments: object) -> str:
        """What a shell there is to run; it notes its number in a file ``pid``."""
        play = shlex.join(map(str, (self.game, "play", *arguments, "--data-dir", data)))
        return f"sh -c {shlex.quote(f'echo $$ > {self.folder}/pid; exec {play}')}"

    @property
    def is_playing(self) -> bool:
        return is_running(int((self.folder / "pid").read_text()))


@pytest.fixture(scope="module")
def host(installed: Installed, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    folder = tmp_path_factory.mktemp("host")
    settings = f"SetEnv LOGICAL_ROBOTS_CACHE_DIR={folder}/cache COLORTERM=truecolor"
    with Server(folder, settings) as server:
        yield Host(server, folder, installed.command)


@contextmanager
def playing(
    host: Host,
    data: Path,
    level: tuple[str, str],
    size: tuple[int, int],
    *options: str,
    rate: int = 0,
) -> Iterator[tuple[Line, Terminal]]:
    with Line(host.server.port, rate) as line:
        ssh = host.server.client("-t", *options, port=line.port)
        with Terminal([*ssh, host.command(data, *level)], size=size) as terminal:
            terminal.wait_for("· applied")
            terminal.wait_for_quiet(0.5)
            yield line, terminal


def run(terminal: Terminal) -> None:
    terminal.send(" ", sees="RUNNING")


def wait_for_frames(terminal: Terminal, number: int) -> None:
    last = terminal.frames + number
    terminal.wait_for(lambda: terminal.frames >= last)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("allowed", "how"),
    [
        (2000, (THREE_ROBOTS, (120, 40))),
        pytest.param(500, (THREE_ROBOTS, (120, 40), "-C"), marks=pytest.mark.proof),
        pytest.param(1000, (THREE_ROBOTS, (80, 24)), marks=pytest.mark.proof),
        pytest.param(250, (THREE_ROBOTS, (80, 24), "-C"), marks=pytest.mark.proof),
        pytest.param(3300, (SIX_ROBOTS, (120, 40)), marks=pytest.mark.proof),
        pytest.param(830, (SIX_ROBOTS, (120, 40), "-C"), marks=pytest.mark.proof),
    ],
)
def test_a_game_sends_little_or_nothing(host: Host, tmp_path: Path, allowed: int, how: Any) -> None:
    with playing(host, tmp_path, *how) as (line, terminal):
        run(terminal)
        before = line.traffic
        wait_for_frames(terminal, FRAMES)
        assert 0 < line.traffic - before <= FRAMES * allowed
        terminal.send(" ", sees="PAUSED")
        terminal.wait_for_quiet()


@pytest.mark.slow
@pytest.mark.parametrize("rate", [20_000, pytest.param(64_000, marks=pytest.mark.proof)])
def test_slow_lines_carry_little_before_a_key_shows(host: Host, tmp_path: Path, rate: int) -> None:
    with playing(host, tmp_path, SIX_ROBOTS, (120, 40), rate=rate) as (line, terminal):
        run(terminal)
        terminal.send("2", sees="Leave")
        numbers = []
        for letter in "αβγδεζηθικλ":
            wait_for_frames(terminal, 2)
            before = line.traffic
            terminal.send(letter)
            terminal.wait_to_receive(letter)
            numbers.append(line.traffic - before)
        assert statistics.median(numbers) <= BEFORE_A_KEY, numbers


@pytest.mark.slow
def test_who_loses_the_connection_goes_on_there(host: Host, tmp_path: Path) -> None:
    with Line(host.server.port) as line, Tmux(tmp_path, 120, 40) as tmux:
        ssh = host.server.client("-t", port=line.port)
        tmux.start(*ssh, host.command(tmp_path / "data", *THREE_ROBOTS))
        tmux.wait_for("· applied")
        tmux.press("2", "C-Home")  # no dialog covers the first line
        tmux.type(TYPED, sees=TYPED)
        tmux.press("F5", sees="RUNNING")
        line.cut()
        until(lambda: not host.is_playing, lambda: "the process ends")
        tmux.mend()
        tmux.start(*ssh, host.command(tmp_path / "data", *THREE_ROBOTS))
        tmux.wait_for("unsaved", "Yes, continue")
        tmux.press("Enter", sees=TYPED)


@pytest.mark.slow
def test_a_game_is_suspended_and_resized_and_goes_on(host: Host, tmp_path: Path) -> None:
    with Tmux(tmp_path, 120, 40) as tmux:
        tmux.start(*host.server.client("-t"), f"PS1='{PROMPT}' sh -i")
        tmux.wait_until(lambda screen: screen.rstrip().endswith(PROMPT.strip()), "a shell")
        tmux.type(host.command(tmp_path / "data", *THREE_ROBOTS))
        tmux.press("Enter", sees="· applied")
        tmux.press("n", sees="tick 1")
        tmux.press("C-z", sees="Stopped")
        tmux.type("fg")
        tmux.press("Enter", sees="tick 1")
        tmux.press("Space", sees="RUNNING")
        tmux.resize(80, 24)
        screen = tmux.wait_until(lambda screen: re.search(r"tick [1-9]\d", screen), "it runs on")
        assert max(map(len, screen.splitlines())) <= 80
        tmux.press("q")
        tmux.wait_until(lambda screen: screen.rstrip().endswith(PROMPT.strip()), "a shell")
