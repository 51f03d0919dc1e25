"""A class over a real sshd: frames, help and keys with twelve and with thirty players."""

from __future__ import annotations

import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, Target, at_least, at_most, summed_up
from benchmarks.ssh import need_openssh
from tests.crowd import Crowd
from tests.sshd import Server
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["class_of", "classes", "large_classes"]


def classes(effort: Effort) -> Iterator[Measurement]:
    """Measure twelve players' frames per second, and milliseconds to the help and to a letter."""
    return _class(effort, 12, at_least(10), at_most(150))


def large_classes(effort: Effort) -> Iterator[Measurement]:
    """Measure the same with thirty players."""
    return _class(effort, 30, None, at_most(300))


def _class(
    effort: Effort, players: int, frames: Target | None, milliseconds: Target
) -> Iterator[Measurement]:
    need_openssh()
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
        yield from class_of(seats, effort, "at once", frames, milliseconds)


def class_of(
    seats: Sequence[Terminal],
    effort: Effort,
    place: str,
    frames: Target | None,
    milliseconds: Target,
) -> Iterator[Measurement]:
    """Measure frames per second, and milliseconds to the help and to a letter."""
    crowd = Crowd(seats)
    crowd.play()
    rates = crowd.frames_per_second(effort.ticks / 80)
    helps = crowd.help_milliseconds()
    crowd.edit()
    keys = crowd.key_milliseconds(len(seats))
    subject = f"80x24, {len(seats)} players {place}"
    yield summed_up("frames of a class", subject, "/s", rates, target=frames)
    yield summed_up("help of a class", subject, "ms", helps, target=None)
    yield summed_up("key of a class", subject, "ms", keys, target=milliseconds)
