"""In the browser: the first picture, traffic beside that of SSH, and a class of thirty players."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from functools import partial
from itertools import count
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from benchmarks.classes import class_of
from benchmarks.measure import Effort, Measurement, at_most, need, repeated, summed_up
from benchmarks.ssh import SIX_ROBOTS, SIZE, need_openssh, running
from tests.browser import CHROMIUM, Client, Seat, chromium, serving
from tests.sshd import Line, Server

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser

    from tests.terminal import Terminal

__all__ = ["web"]

PLAYERS = 30
SETTLED = 1.0  # seconds of running, after which no picture is new to the compression


def web(effort: Effort) -> Iterator[Measurement]:
    """Measure ms to the first picture, traffic over that of SSH, and a class of headless pages."""
    need("Chromium", CHROMIUM)
    need_openssh()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        with chromium() as browser:
            once = partial(_first_picture, browser, folder, count())
            pictures = repeated(effort.repeats, once)
        target = at_most(1500)
        yield summed_up("first picture in a browser", "1280x800", "ms", pictures, target=target)
        for is_compressed in (False, True):
            yield _traffic(effort.ticks / 25, folder, is_compressed=is_compressed)
        with ExitStack() as stack:
            address = stack.enter_context(serving(folder / "class"))
            clients = [stack.enter_context(Client(address, size=(80, 24))) for _ in range(PLAYERS)]
            yield from class_of(clients, effort, "in browsers", None, at_most(300))


def _first_picture(browser: Browser, folder: Path, numbers: Iterator[int]) -> float:
    """Return the milliseconds from opening the address to the level on the screen."""
    with serving(folder / f"picture-{next(numbers)}") as address:
        start = perf_counter()
        seat = Seat(browser, address)
        seat.shows("tick 0")
        milliseconds = 1000 * (perf_counter() - start)
        seat.page.context.close()
    return milliseconds


def _traffic(seconds: float, folder: Path, *, is_compressed: bool) -> Measurement:
    """Compare the bytes of a websocket with those of SSH in true colour."""
    name = "compressed" if is_compressed else "plain"
    folder /= name
    folder.mkdir()
    with (
        serving(folder / "web", *SIX_ROBOTS) as address,
        Line(int(address.rpartition(":")[2].partition("/")[0])) as line,
        Client(address, size=SIZE, port=line.port, compress=is_compressed) as client,
    ):
        client.wait_for("· applied")
        client.send(" ")
        client.wait_for("RUNNING")
        by_web = _rate(client, line, seconds)
    with (
        Server(folder, "SetEnv COLORTERM=truecolor") as server,
        Line(server.port) as line,
        running(server, line, folder, "-C" if is_compressed else "-q") as terminal,
    ):
        by_ssh = _rate(terminal, line, seconds)
    subject = f"{SIZE[0]}x{SIZE[1]}, 6 robots, {name}, {by_web:.1f} and {by_ssh:.1f} kB/s"
    ratio = [by_web / by_ssh]
    return summed_up("browser / ssh", subject, "times", ratio, target=at_most(1.3))


def _rate(terminal: Terminal, line: Line, seconds: float) -> float:
    """Return the kilobytes a second on a line."""
    terminal.read_for(SETTLED)
    traffic, start = line.traffic, perf_counter()
    terminal.read_for(seconds)
    return (line.traffic - traffic) / 1000 / (perf_counter() - start)
