"""Sixty players who log in together: time until all can play, the help, and memory."""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, need, summed_up
from benchmarks.ssh import need_openssh
from tests.crowd import Crowd
from tests.memory_use import memory_share
from tests.sshd import Server
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["arrivals"]

PLAYERS = 60
READY_SECONDS, HELP_MILLISECONDS = 20, 700
MOST_MB = {"alone": 65, "forked by a host": 45}
"""Of memory for each player, in all processes (PSS)."""

_READY = "applied"
_PATIENCE = 300.0  # seconds until all are ready


def arrivals(effort: Effort) -> Iterator[Measurement]:
    """Measure seconds until all can play, milliseconds to the help, and megabytes of each."""
    need_openssh()
    need("/proc", Path("/proc/self/smaps_rollup").exists())
    players = 6 if effort.is_quick else PLAYERS
    for start, most_megabytes in MOST_MB.items():
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name, ExitStack() as stack:
            folder = Path(name)
            words = ""
            if start != "alone":
                stack.enter_context(_host(folder / "warm"))
                words = f" --host {folder / 'warm'}"
            seats, seconds = _log_in(stack, folder, players, words)
            crowd = Crowd(seats)
            at_rest = _megabytes() / players
            crowd.play()
            helps = crowd.help_milliseconds()
            subject = f"80x24, {players} players, {start}"
            yield summed_up(
                "all ready after logging in",
                subject,
                "s",
                [seconds],
                target=at_most(READY_SECONDS) if words else None,
            )
            late = statistics.quantiles(helps, n=20)[-1] if len(helps) > 1 else helps[0]
            target = at_most(HELP_MILLISECONDS) if words else None
            yield summed_up("help, 95 % of", subject, "ms", [late], target=target)
            for state, megabytes in (("ready", at_rest), ("running", _megabytes() / players)):
                yield summed_up(
                    f"memory of a game, {state}",
                    subject,
                    "MB",
                    [megabytes],
                    target=at_most(most_megabytes),
                )


@contextmanager
def _host(folder: Path) -> Iterator[None]:
    command = [sys.executable, "-m", "logical_robots_tui", "host", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as host:
        assert host.stdout is not None
        host.stdout.readline()  # it is loaded
        try:
            yield
        finally:
            host.terminate()


def _log_in(
    stack: ExitStack, folder: Path, players: int, words: str
) -> tuple[list[Terminal], float]:
    """Let everybody log in at once; return terminals, and seconds until all can play."""
    data_dir = folder / "data"
    game = f"{sys.executable} -m logical_robots_tui play --restricted --data-dir {data_dir}{words}"
    names = [f"player-{number}" for number in range(players)]
    keys = 'environment="LOGICAL_ROBOTS_PLAYER={name}" {key}'
    config = f"PermitUserEnvironment LOGICAL_ROBOTS_PLAYER\nForceCommand {game}\n"
    config += f"SetEnv HOME={folder}\n"  # no start-up files of a shell, as in the recipe
    server = stack.enter_context(Server(folder, config, names, keys))
    # Keys safe from quantum computers take a player's own machine 0.1 s, but here the server's.
    options = "-t", "-o", "KexAlgorithms=curve25519-sha256"
    began = monotonic()
    seats = [
        stack.enter_context(Terminal(server.client(*options, player=name), size=(80, 24)))
        for name in names
    ]
    Crowd(seats).everybody_sees(_READY, _PATIENCE)
    return seats, monotonic() - began


def _megabytes() -> float:
    """Return the megabytes of all processes of the game on this machine."""
    total = 0
    for process in Path("/proc").iterdir():
        if process.name.isdecimal():
            with suppress(OSError):
                command = (process / "cmdline").read_text(errors="replace")
                if "logical_robots_tui" in command:
                    total += memory_share(int(process.name))
    return total / 1e6
