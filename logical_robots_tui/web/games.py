"""A game in a process of its own, which speaks Textual's protocol of the web.

It outlives its page for a while: another page can take it over.
"""

from __future__ import annotations

import asyncio
import json
import signal
import socket
import sys
from asyncio import StreamReader
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable, Sequence
from contextlib import suppress

from aiohttp.web import WebSocketResponse
from textual_serve.app_service import AppService
from textual_serve.download_manager import DownloadManager

_HEAD = 5  # bytes of a packet's kind and length
_CHUNK = 65536
_LEAVE_SECONDS = 1.0
_TO_END = 5.0  # seconds that a game in lines has to end
_ENVIRONMENT = {"TERM_PROGRAM": "logical-robots", "PYTHONIOENCODING": "utf-8"}


async def dismiss(page: WebSocketResponse, reason: str) -> None:
    """Close a page and say why, even one that no longer answers."""
    connection = page.get_extra_info("socket")
    with suppress(ConnectionError, TimeoutError):
        async with asyncio.timeout(_LEAVE_SECONDS):
            await page.send_str(json.dumps(["ended", reason]))
            await page.close()
    if connection is not None:
        with suppress(OSError):  # it is closed
            connection.shutdown(socket.SHUT_RDWR)


class WebGame(AppService):
    """Textual's app service, for a game that ends as one in a closed terminal, and says why.

    Attributes:
        player: The player's name, "" where there is only one, who came with a token of `digest`.
        tab: Identifies the page that has the game, or had it last.
        page: The page; without one, what the game sends is dropped.
        is_open: Whether another page can take it over.
    """

    _COMMAND: tuple[str, ...] = ("-m", "logical_robots_tui", "play")

    def __init__(
        self,
        words: Sequence[str],
        player: str,
        digest: str,
        downloads: DownloadManager,
        on_end: Callable[[WebGame], None],
    ) -> None:
        super().__init__(
            "",
            write_bytes=self._send_bytes,
            write_str=self._send_str,
            close=self._leave,
            download_manager=downloads,
        )
        self.player, self.digest, self.tab, self.is_open = player, digest, "", False
        self.page: WebSocketResponse | None = None
        self._words, self._on_end, self._reason = words, on_end, ""
        self._absence: asyncio.TimerHandle | None = None

    async def _send_bytes(self, cells: bytes) -> None:
        if self.page is not None:
            await self.page.send_bytes(cells)

    async def _send_str(self, text: str) -> None:
        if self.page is not None:
            await self.page.send_str(text)

    async def _leave(self, reason: str = "") -> None:
        if self.page is not None:
            await dismiss(self.page, reason)

    async def open(self, width: int, height: int) -> None:
        """Start the game, for a page that has it or will take it over; raises OSError."""
        try:
            await self.start(width, height)
        except OSError:
            self._on_end(self)
            raise
        self.is_open = True

    async def attach(self, page: WebSocketResponse, width: int, height: int) -> None:
        """Show the game in a page, instead of the one it had; raises OSError at its start."""
        if self._absence is not None:
            self._absence.cancel()
        previous, self.page = self.page, page
        if self._process is None:
            await self.open(width, height)
            return
        await self.send_meta({"type": "attach", "width": width, "height": height})
        if previous is not None:
            await dismiss(previous, "The game goes on in another tab.")

    def detach(self, page: WebSocketResponse | None, patience: float) -> None:
        """End the game so many seconds after its page is gone, unless another comes."""
        if self.page is page:
            self.page = None
            self._absence = asyncio.get_running_loop().call_later(patience, self.end)

    async def _open_app_process(self, width: int = 80, height: int = 24) -> Process:
        command = sys.executable, *self._COMMAND, *self._words
        environment = self._build_environment(width, height) | _ENVIRONMENT
        if self.player:
            environment["LOGICAL_ROBOTS_PLAYER"] = self.player
        self._process = await asyncio.create_subprocess_exec(
            *command,
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
            env=environment,
            start_new_session=True,  # ^C is for the server, which ends its games
        )
        self._stdin = self._process.stdin
        return self._process

    async def run(self) -> None:
        """Pass on what the game sends until it has ended; then tell the page why."""
        process = self._process
        assert process is not None
        assert process.stdout is not None
        assert process.stderr is not None
        errors = asyncio.create_task(process.stderr.read())
        try:
            await self._relay(process.stdout)
        except asyncio.IncompleteReadError:
            pass
        except (LookupError, ValueError):  # no packet, so its place must not stay taken
            self._send(signal.SIGHUP)
        self.is_open = False
        await process.wait()
        self._on_end(self)
        await self._leave(self._reason or (await errors).decode(errors="replace"))

    async def _relay(self, output: StreamReader) -> None:
        handlers = {b"D": self._send_bytes, b"M": self.on_meta, b"P": self.on_packed}
        await output.readuntil()
        while True:
            head = await output.readexactly(_HEAD)
            payload = await output.readexactly(int.from_bytes(head[1:], "big"))
            with suppress(ConnectionError):  # a closed page, while the game ends
                await handlers[head[:1]](payload)

    async def on_meta(self, packet: bytes) -> None:
        """Handle a packet besides the screen; the game's end shows in its process."""
        meta = json.loads(packet)
        if meta["type"] in ("title", "upload"):
            await self._tell(meta["type"], meta.get("title", ""))
        elif meta["type"] != "exit":
            await super().on_meta(packet)

    async def _tell(self, kind: str, text: str) -> None:
        await self._send_str(json.dumps([kind, text]))

    def end(self, reason: str = "") -> None:
        """End the game as a terminal that is closed does: unsaved text is kept."""
        if self.is_open:
            self.is_open, self._reason = False, reason
            self._send(signal.SIGHUP)

    def _send(self, number: signal.Signals) -> None:
        assert self._process is not None
        with suppress(ProcessLookupError):
            self._process.send_signal(number)

    async def stop(self) -> None:
        """End the game, and wait until it has ended."""
        self.end()
        if self._task is not None:
            await asyncio.wait([self._task])


class PlainGame(WebGame):
    """A game in lines of text, which takes lines, and ^C to end a run; it ends with its page."""

    # Between two runs, ^C would end the game if it were not ignored.
    _COMMAND = (
        "-c",
        "import runpy, signal; signal.signal(signal.SIGINT, signal.SIG_IGN); "
        "runpy.run_module('logical_robots_tui', run_name='__main__', alter_sys=True)",
        *("play", "--plain"),
    )

    async def send_bytes(self, line: bytes) -> bool:
        if line == b"\x03":
            self._send(signal.SIGINT)
        else:
            self.stdin.write(line)
            with suppress(ConnectionError):  # of a game that has ended
                await self.stdin.drain()
        return True

    async def _relay(self, output: StreamReader) -> None:
        while chunk := await output.read(_CHUNK):
            with suppress(ConnectionError):
                await self._send_bytes(chunk)

    def detach(self, page: WebSocketResponse | None, patience: float) -> None:
        """End the game: what another page would show of it is gone."""
        super().detach(page, 0)

    def end(self, reason: str = "") -> None:
        """End the game at the end of its input, a run as well; text is kept after each line."""
        if self.is_open:
            self.is_open, self._reason = False, reason
            self._send(signal.SIGINT)
            self.stdin.close()
            asyncio.get_running_loop().call_later(_TO_END, self._send, signal.SIGKILL)
