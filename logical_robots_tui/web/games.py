"""A game in a process of its own, which speaks Textual's protocol of the web."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Sequence
from contextlib import suppress

from aiohttp.web import WebSocketResponse
from textual_serve.app_service import AppService
from textual_serve.download_manager import DownloadManager

_HEAD = 5  # bytes of a packet's kind and length


class WebGame(AppService):
    """Textual's app service, for a game that ends as one in a closed terminal, and says why."""

    def __init__(
        self, words: Sequence[str], page: WebSocketResponse, downloads: DownloadManager
    ) -> None:
        super().__init__(
            "",
            write_bytes=page.send_bytes,
            write_str=page.send_str,
            close=self._close,
            download_manager=downloads,
        )
        self._words, self._page = words, page

    async def _close(self) -> None:
        await self._page.close()

    async def _open_app_process(self, width: int = 80, height: int = 24) -> Process:
        command = sys.executable, "-m", "logical_robots_tui", "play", *self._words
        environment = self._build_environment(width, height) | {"TERM_PROGRAM": "logical-robots"}
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
        handlers = {b"D": self._pass_on, b"M": self.on_meta, b"P": self.on_packed}
        with suppress(asyncio.IncompleteReadError):
            await process.stdout.readuntil()
            while True:
                head = await process.stdout.readexactly(_HEAD)
                payload = await process.stdout.readexactly(int.from_bytes(head[1:], "big"))
                with suppress(ConnectionError):  # a closed page, while the game ends
                    await handlers[head[:1]](payload)
        await process.wait()
        with suppress(ConnectionError):
            await self._tell("ended", (await errors).decode(errors="replace"))
        await self.remote_close()

    async def _pass_on(self, cells: bytes) -> None:
        await self.remote_write_bytes(cells)

    async def on_meta(self, packet: bytes) -> None:
        """Handle a packet besides the screen; the game's end shows in its process."""
        meta = json.loads(packet)
        if meta["type"] == "title":
            await self._tell("title", meta["title"])
        elif meta["type"] != "exit":
            await super().on_meta(packet)

    async def _tell(self, kind: str, text: str) -> None:
        await self.remote_write_str(json.dumps([kind, text]))

    async def stop(self) -> None:
        """End the game as a terminal that is closed does: unsaved text is kept."""
        if self._task is None or self._process is None:
            return
        await self._download_manager.cancel_app_downloads(app_service_id=self.app_service_id)
        with suppress(ProcessLookupError):
            os.kill(self._process.pid, signal.SIGHUP)
        await self._task
