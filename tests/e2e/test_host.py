"""Games that a host forks: as ready, as safe and as well supervised as those that start alone."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import combinations
from pathlib import Path

import pytest

from logical_robots_tui.processes import hosted
from tests.e2e.test_supervisor import texts
from tests.processes import is_running, run_command
from tests.terminal import Terminal
from tests.waiting import PATIENCE, until

GAME = [sys.executable, "-m", "logical_robots_tui"]
SIZE = (90, 30)


def children(process: int) -> list[int]:
    """The children of a process with one thread, in the order of their starts."""
    return [
        int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()
    ]


def descriptors(process: int) -> set[str]:
    """What a process has open besides its standard streams."""
    names = set[str]()
    for link in Path(f"/proc/{process}/fd").iterdir():
        if int(link.name) > 2:
            with suppress(FileNotFoundError):  # closed meanwhile
                names.add(str(link.readlink()))
    return names


@contextmanager
def killed(process: subprocess.Popen[str]) -> Iterator[None]:
    try:
        yield
    finally:
        process.kill()


@pytest.fixture
def host(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    command = [*GAME, "host", str(tmp_path / "host")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert "are forked" in process.stdout.readline()
        with killed(process):
            yield process


@contextmanager
def playing(
    tmp_path: Path,
    player: str = "ada",
    options: Sequence[str] | None = None,
    level: str = "02-open-space",
) -> Iterator[Terminal]:
    words = ["play", level, "--restricted", "--player", player, "--data-dir", tmp_path]
    options = ["--host", str(tmp_path / "host")] if options is None else options
    with Terminal([*GAME, *words, *options], size=SIZE, controls=True) as terminal:
        terminal.wait_for("applied")
        yield terminal


def test_a_forked_game_is_played_resized_and_left(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    with playing(tmp_path) as terminal:
        compile_host, game = children(host.pid)
        (compile_process,) = children(compile_host)
        assert children(terminal.process.pid) == []  # nothing is loaded for this player alone
        terminal.send("2hello", sees="1 error")
        terminal.resize(120, 40)
        terminal.wait_for("─ Inspector")  # which has no room before
        terminal.resize(*SIZE)
        terminal.wait_for("3 Inspector")
        terminal.send("\x1b", sees="q Quit")
        terminal.send("q")
        assert terminal.finish() == 0
        until(lambda: not is_running(game) and not is_running(compile_process))
    assert is_running(compile_host)


def test_what_a_host_has_rehearsed_is_not_compiled_again(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    with playing(tmp_path, level="01-first-steps") as terminal:
        compile_host, _ = children(host.pid)
        assert children(compile_host) == []
        terminal.send("2hello", sees="1 error")
        assert len(children(compile_host)) == 1


def test_games_share_nothing_and_the_host_has_one_thread_and_no_file(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    assert len([*Path(f"/proc/{host.pid}/task").iterdir()]) == 1
    kinds = {re.sub(r"\d+", "N", name) for name in descriptors(host.pid)}
    assert kinds == {"socket:[N]", "anon_inode:[eventpoll]"}
    with playing(tmp_path, "ada"), playing(tmp_path, "ben"):
        compile_host, ada, ben = children(host.pid)
        of_ada, of_ben = children(compile_host)
        pairs = combinations((host.pid, compile_host, ada, ben, of_ada, of_ben), 2)
        for first, second in {*pairs} - {(ada, of_ada), (ben, of_ben)}:
            common = descriptors(first) & descriptors(second)
            assert not [name for name in common if name.startswith(("socket", "pipe"))]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV])
def test_the_end_of_a_game_is_told_and_its_text_is_kept(
    host: subprocess.Popen[str], tmp_path: Path, number: signal.Signals
) -> None:
    folder = tmp_path / "players" / "ada"
    with playing(tmp_path) as terminal:
        terminal.send("2hello", sees="hello")
        until(lambda: terminal.receive() and any(folder.glob("drafts/*.json")))
        os.kill(children(host.pid)[1], number)
        assert terminal.finish() == 128 + number
        assert f"was ended by {number.name}" in terminal.text
    assert texts(folder)


def test_a_client_that_is_gone_ends_its_game_which_keeps_the_text(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    with playing(tmp_path) as terminal:
        game = children(host.pid)[1]
        terminal.send("2hello", sees="hello")
        terminal.process.kill()
        until(lambda: not is_running(game))
    assert texts(tmp_path / "players" / "ada") == ["hello"]


def test_a_game_outlives_its_host_and_compiles_without_it(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    with playing(tmp_path) as terminal:
        compile_host, game = children(host.pid)
        for process in (host.pid, compile_host, *children(compile_host)):
            os.kill(process, signal.SIGKILL)
        terminal.send("2hello", sees="1 error")
        terminal.send("\x1b", sees="q Quit")
        terminal.send("q")
        terminal.finish()
        until(lambda: not is_running(game))
    with playing(tmp_path, "ben") as terminal:  # without a host
        assert terminal.game
        terminal.send("q")
        assert terminal.finish() == 0


def test_a_host_forks_no_game_of_another_version(
    host: subprocess.Popen[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    request = hosted.GameRequest([], {}, "/", [], version="0.1 elsewhere")
    opened = descriptors(host.pid)
    for content in (json.dumps(request).encode(), b"[", b"{}", b"[1]"):
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as client:
            client.connect(str(tmp_path / "host" / hosted.SOCKET))
            socket.send_fds(client, [content], [client.fileno()])
            assert client.recv(100) == b""
            until(lambda: descriptors(host.pid) == opened)
    assert len(children(host.pid)) == 1


def test_one_host_works_in_a_folder_and_takes_over_from_one_that_was_killed(
    host: subprocess.Popen[str], tmp_path: Path
) -> None:
    second = run_command([*GAME, "host", str(tmp_path / "host")])
    assert second.returncode == 2
    assert "A host is at work there already" in second.stderr
    host.kill()
    host.wait(PATIENCE)
    command = [*GAME, "host", str(tmp_path / "host")]
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process,
        killed(process),
    ):
        assert process.stdout is not None
        assert "are forked" in process.stdout.readline()
        with playing(tmp_path) as terminal:
            assert len(children(process.pid)) == 2
            terminal.send("q")
            assert terminal.finish() == 0


AS_SYSTEMD = """if True:
    import os, sys
    os.dup2(int(sys.argv[1]), 3)
    os.environ["LISTEN_PID"] = str(os.getpid())
    os.execv(sys.argv[2], sys.argv[2:])
"""


def test_a_socket_and_a_variable_are_enough(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "host").mkdir()
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        listener.bind(str(tmp_path / "host" / hosted.SOCKET))
        listener.listen()
        number = listener.fileno()
        command = [sys.executable, "-c", AS_SYSTEMD, str(number), *GAME, "host", "unused"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, pass_fds=[number])
    with process, killed(process):
        assert process.stdout is not None
        assert "are forked" in process.stdout.readline()
        monkeypatch.setenv("LOGICAL_ROBOTS_HOST", str(tmp_path / "host"))
        with playing(tmp_path, options=[]) as terminal:
            assert len(children(process.pid)) == 2
            terminal.send("q")
            assert terminal.finish() == 0
