"""A class over a real sshd: frame rate and key latency with twelve and with thirty players."""

from __future__ import annotations

import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, summed_up
from tests.crowd import Crowd
from tests.sshd import Server
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["classes"]

PLAYERS = ((12, 10, 150), (30, 0, 300))
"""Players at once, required frames per second for each, and the longest key latency in ms."""


def classes(effort: Effort) -> Iterator[Measurement]:
    """Measure each player's frames per second, and milliseconds from a key to the screen."""
    for players, frames, milliseconds in PLAYERS:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name, ExitStack() as stack:
            folder = Path(name)
            game = f"{sys.executable} -m logical_robots_tui play --restricted --data-dir {folder}"
            names = [f"player-{number}" for number in range(players)]
            keys = 'environment="LOGICAL_ROBOTS_PLAYER={name}" {key}'
            config = f"PermitUserEnvironment LOGICAL_ROBOTS_PLAYER\nForceCommand {game}\n"
            server = stack.enter_context(Server(folder, config, names, keys))
            seats = [
                stack.enter_context(Terminal(server.client("-t", player=name), size=(80, 24)))
                for name in names
            ]
            crowd = Crowd(seats)
            crowd.play()
            drawn = crowd.frames_per_second(effort.ticks / 80)
            crowd.edit()
            found = crowd.key_milliseconds(players)
        subject = f"80x24, {players} players at once"
        required = f">= {frames}" if frames else ""
        yield summed_up("frames of a class", subject, "/s", drawn, required=required)
        yield summed_up("key of a class", subject, "ms", found, required=f"<= {milliseconds}")
