"""The served game: its server, a page of a real browser, and headless clients of its protocol."""

import asyncio
import json
import os
import re
import shutil
import signal
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from subprocess import PIPE, Popen
from threading import Thread
from time import monotonic
from typing import Self

import aiohttp
import pyte
from playwright.sync_api import Browser, Page, ViewportSize, WebSocket, sync_playwright

from tests.terminal import Terminal
from tests.waiting import PATIENCE

__all__ = ["CHROMIUM", "Client", "Seat", "chromium", "serving"]

CHROMIUM = shutil.which("chromium")
SIZE = ViewportSize(width=1280, height=800)

# textual.js keeps its terminal, one of xterm.js, to itself, and sets this property beside it.
_CATCH_TERMINAL = """
Object.defineProperty(Object.prototype, "fitAddon", {configurable: true, set(addon) {
  window.terminal = this.terminal;
  Object.defineProperty(this, "fitAddon", {value: addon});
}});
"""
_SHOWN = """
text => [...Array(window.terminal?.rows ?? 0).keys()].some(
  y => window.terminal.buffer.active.getLine(y).translateToString().includes(text))
"""


@contextmanager
def chromium() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def serving(folder: Path, *words: str) -> Iterator[str]:
    """Serve a level and a program, with a player's files in a folder; yield the address."""
    command = [sys.executable, "-m", "logical_robots_tui", "serve", *words, "--no-open"]
    with Popen([*command, "--data-dir", folder], stdout=PIPE, text=True) as server:
        assert server.stdout is not None
        match = re.match(r"Playing at (http://127\.0\.0\.1:\d+/#\S+)", server.stdout.readline())
        assert match
        try:
            yield match[1]
        finally:
            server.send_signal(signal.SIGINT)
            assert server.wait(PATIENCE) == 0


class Seat:
    """A page of the browser, and the screen that the server has sent to it.

    Args:
        browser: Where the page is opened, in a profile of its own.
        address: Of the page.
        zoom: As the browser's zoom: the same window has fewer, larger CSS pixels.
    """

    def __init__(self, browser: Browser, address: str, zoom: float = 1.0) -> None:
        size = ViewportSize(width=round(SIZE["width"] / zoom), height=round(SIZE["height"] / zoom))
        context = browser.new_context(viewport=size, device_scale_factor=zoom)
        self.page: Page = context.new_page()
        self.screen = pyte.Screen(1, 1)  # of the latest connection
        self.errors: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("dialog", lambda dialog: dialog.accept())
        self.page.on("websocket", self._open)
        self.page.add_init_script(_CATCH_TERMINAL)
        self.page.goto(address)

    def _open(self, websocket: WebSocket) -> None:
        columns, lines = map(int, re.findall(r"=(\d+)", websocket.url))
        self.screen = pyte.Screen(columns, lines)
        stream = pyte.ByteStream(self.screen)

        def feed(frame: str | bytes) -> None:
            if isinstance(frame, bytes):
                stream.feed(frame)

        websocket.on("framereceived", feed)

    @property
    def text(self) -> str:
        return "\n".join(self.screen.display)

    def sees(self, text: str | Callable[[], object]) -> None:
        deadline = monotonic() + PATIENCE
        while not (text in self.text if isinstance(text, str) else text()):
            assert monotonic() < deadline, f"{text} is not in\n{self.text}"
            self.page.wait_for_timeout(20)

    def shows(self, text: str) -> None:
        """Wait until a text is in the page's own buffer, and drawn."""
        self.page.wait_for_function(_SHOWN, arg=text, polling="raf", timeout=1000 * PATIENCE)

    def press(self, *keys: str, sees: str = "") -> None:
        for key in keys:
            self.page.keyboard.press(key)
        if sees:
            self.sees(sees)


class Client(Terminal):
    """Plays as a page does, without a browser.

    Args:
        address: Of the page, with its key.
        size: Columns and lines.
        port: Of a line to the server, if it is not the server's.
        compress: Whether to offer permessage-deflate, as browsers do.
    """

    def __init__(
        self, address: str, *, size: tuple[int, int], port: int | None = None, compress: bool = True
    ) -> None:
        super().__init__([], size=size)
        page, _, self._key = address.partition("#")
        self._origin = page.rstrip("/")
        server = self._origin if port is None else f"http://127.0.0.1:{port}"
        self._url = f"{server}/ws?width={size[0]}&height={size[1]}"
        self._compress = 15 if compress else 0

    def __enter__(self) -> Self:
        ours, theirs = socket.socketpair()
        self._ours = os.dup(ours.fileno())
        ours.close()
        self._thread = Thread(target=lambda: asyncio.run(self._connect(theirs)))
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._ours)
        self._thread.join(PATIENCE)

    async def _connect(self, end: socket.socket) -> None:
        """Carry bytes between the player's end of a socket pair and the server."""
        reader, writer = await asyncio.open_connection(sock=end)
        headers = {"Origin": self._origin, "Host": self._origin.partition("://")[2]}
        async with (
            aiohttp.ClientSession(headers=headers) as session,
            session.ws_connect(
                self._url, protocols=["logical-robots", self._key], compress=self._compress
            ) as page,
        ):
            output = asyncio.create_task(_receive(page, writer))
            with suppress(ConnectionError, aiohttp.ClientConnectionError):  # of either side
                while keys := await reader.read(4096):
                    await page.send_str(json.dumps(["stdin", keys.decode()]))
            output.cancel()


async def _receive(page: aiohttp.ClientWebSocketResponse, writer: asyncio.StreamWriter) -> None:
    """Pass on the screen, however long nobody reads it: a page that is slow answers pings, too."""
    with suppress(aiohttp.ClientConnectionError):
        async for message in page:
            if message.type == aiohttp.WSMsgType.BINARY:
                writer.write(message.data)
    writer.close()
