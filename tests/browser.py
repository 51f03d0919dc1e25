"""The served game: its server, a page of a real browser, and headless clients of its protocol."""

import asyncio
import json
import os
import re
import shutil
import signal
import socket
import sys
from base64 import b64encode
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from subprocess import PIPE, Popen
from threading import Thread
from time import monotonic
from typing import Self

import aiohttp
import pyte
from playwright.sync_api import Browser, ViewportSize, WebSocket, sync_playwright

from tests.terminal import Terminal
from tests.waiting import PATIENCE

__all__ = ["CHROMIUM", "SIZE", "Client", "Seat", "chromium", "serving", "zoomed"]

CHROMIUM = shutil.which("chromium")
SIZE = ViewportSize(width=1280, height=800)

# textual.js keeps its terminal, one of xterm.js, to itself, and sets this property beside it.
_CATCH_TERMINAL = """
Object.defineProperty(Object.prototype, "fitAddon", {configurable: true, set(addon) {
  window.terminal = this.terminal;
  Object.defineProperty(this, "fitAddon", {value: addon});
}});
window.lineAt = y => {
  const buffer = window.terminal.buffer.active;
  return buffer.getLine(buffer.baseY + y);
};
"""
_SHOWN = """
text => [...Array(window.terminal?.rows ?? 0).keys()].some(
  y => lineAt(y).translateToString().includes(text))
"""
_LOOKS = """
() => [...Array(terminal.rows).keys()].map(y => [...Array(terminal.cols).keys()].map(x => {
  const cell = lineAt(y).getCell(x);
  const color = (mode, number) =>
    mode === 0 ? "default" : mode === 3 << 24 ? number.toString(16).padStart(6, "0") : number;
  const paper = color(cell.getBgColorMode(), cell.getBgColor());
  const ink = color(cell.getFgColorMode(), cell.getFgColor());
  const marks = [cell.isBold(), cell.isInverse(), cell.isUnderline()].map(Boolean);
  const sign = cell.getChars() || " ";
  return sign === " " && !marks[1] && !marks[2] ? [sign, paper] : [sign, paper, ink, ...marks];
}))
"""
_DRAWN = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
_PIXELS = """
async ([picture, places]) => {
  const image = await createImageBitmap(await (await fetch(picture)).blob());
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  const bytes = context.getImageData(0, 0, image.width, image.height).data;
  return places.map(([x, y]) => [...bytes.subarray(4 * (y * image.width + x)).subarray(0, 3)]);
}
"""


@contextmanager
def chromium() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@contextmanager
def zoomed(browser: Browser, zoom: float) -> Iterator[Browser]:
    """Run another one with a zoom; Playwright's own scale factor leaves canvases blurred."""
    size = f"{SIZE['width'] / zoom:.0f},{SIZE['height'] / zoom:.0f}"
    args = ["--no-sandbox", f"--force-device-scale-factor={zoom}", f"--window-size={size}"]
    other = browser.browser_type.launch(executable_path=CHROMIUM, args=args)
    yield other
    other.close()


@contextmanager
def serving(folder: Path, *words: str) -> Iterator[str]:
    """Serve a game or a class, with players' files in a folder; yield the address."""
    command = [sys.executable, "-m", "logical_robots_tui", "serve", *words, "--no-open"]
    with Popen([*command, "--data-dir", folder], stdout=PIPE, text=True) as server:
        assert server.stdout is not None
        match = re.match(r"(?:Playing|Serving a class) at (http://\S+)", server.stdout.readline())
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
        size: Of the page; if None, of the browser's window.
    """

    def __init__(self, browser: Browser, address: str, size: ViewportSize | None = SIZE) -> None:
        context = browser.new_context(viewport=size, no_viewport=size is None)
        context.set_default_timeout(1000 * PATIENCE)
        self.page = context.new_page()
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
        self.page.wait_for_function(_SHOWN, arg=text, polling=20, timeout=1000 * PATIENCE)

    def looks(self) -> list[list[tuple[object, ...]]]:
        """Return the page's own buffer, as `tests.terminal.looks` does a terminal's screen."""
        return [[tuple(cell) for cell in row] for row in self.page.evaluate(_LOOKS)]

    def pixels(self, places: Sequence[tuple[int, int]]) -> list[str]:
        """Return the colours in a picture of the page; x and y are in the screen's pixels."""
        self.page.evaluate(_DRAWN)
        picture = b64encode(self.page.screenshot(scale="device")).decode()
        with self.page.context.new_page() as page:
            colors = page.evaluate(_PIXELS, ["data:image/png;base64," + picture, places])
        return ["".join(f"{part:02x}" for part in color) for color in colors]

    @property
    def cell_size(self) -> tuple[float, float]:
        """The width and height of a cell in CSS pixels."""
        box = self.page.locator(".xterm-screen").bounding_box()
        assert box
        return box["width"] / self.screen.columns, box["height"] / self.screen.lines

    def click(self, text: str, sees: str) -> None:
        line = next(y for y, line in enumerate(self.screen.display) if text in line)
        width, height = self.cell_size
        column = self.screen.display[line].index(text)
        self.page.mouse.click((column + 0.5) * width, (line + 0.5) * height)
        self.sees(sees)

    def press(self, *keys: str, sees: str | Callable[[], object] = "") -> None:
        for key in keys:
            self.page.keyboard.press(key)
        if sees:
            self.sees(sees)

    def finds_command(self, title: str) -> None:
        """Search for a command in the palette until it is the first one, which enter runs."""
        self.press("Control+p")
        self.page.keyboard.type(title.lower())
        self.sees(title)


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
        page, _, key = address.partition("#")
        self._protocols = ["logical-robots", key] if key else ["logical-robots"]
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
                self._url, protocols=self._protocols, compress=self._compress
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
