"""The web server: the page, its websocket, and downloads.

The key of a page is in the fragment of its address, which no server and no log gets to see, and is
sent as a subprotocol of the websocket.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
import socket
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import textual_serve
from aiohttp import web
from aiohttp.helpers import content_disposition_header
from aiohttp.http import WSMsgType
from textual_serve.download_manager import DownloadManager

from logical_robots_tui.web.games import WebGame

_HERE = Path(__file__).parent / "static"
_TEXTUAL = Path(textual_serve.__file__).parent / "static"
_PROTOCOL = "logical-robots"
_LARGEST_MESSAGE = 4_000_000  # bytes; a paste of a million letters, some of which take three
_HEARTBEAT = 15.0  # seconds
_WRONG_KEY = "This address has no valid key. Open the one that logical-robots serve printed."
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}


class GameServer:
    """Serves one player on this computer, whose games are started with some arguments."""

    def __init__(self, words: Sequence[str]) -> None:
        self.key = secrets.token_urlsafe(24)
        self._words = words
        self._downloads = DownloadManager()
        self._games: set[WebGame] = set()
        self._closing: set[WebGame] = set()

    def application(self) -> web.Application:
        application = web.Application()
        application.add_routes(
            [
                web.get("/", self._page),
                web.get("/ws", self._connect),
                web.get("/download/{key}", self._download),
                web.static("/textual", _TEXTUAL),
                web.static("/static", _HERE),
            ]
        )
        application.on_response_prepare.append(_add_headers)
        application.on_shutdown.append(self._end_games)
        return application

    async def _page(self, _request: web.Request) -> web.FileResponse:
        return web.FileResponse(_HERE / "page.html")

    async def _connect(self, request: web.Request) -> web.WebSocketResponse:
        """Play a game in a page until either ends."""
        if request.headers.get("Origin", "").partition("://")[2] != request.host:
            raise web.HTTPForbidden(text="This page belongs to another server.")
        page = web.WebSocketResponse(
            heartbeat=_HEARTBEAT, max_msg_size=_LARGEST_MESSAGE, protocols=[_PROTOCOL]
        )
        await page.prepare(request)
        if not self._has_key(request):
            await page.send_str(json.dumps(["ended", _WRONG_KEY]))
            await page.close()
            return page
        while self._closing:  # of a page that was reloaded: its text is on offer once it has ended
            await asyncio.gather(*(game.stop() for game in self._closing))
        game = WebGame(self._words, page, self._downloads)
        await game.start(_side(request, "width", 80), _side(request, "height", 24))
        self._games.add(game)
        try:
            async for message in page:
                if message.type == WSMsgType.TEXT:
                    await _receive(message.json(), game, page)
        finally:
            self._closing.add(game)
            await game.stop()
            self._closing.discard(game)
            self._games.discard(game)
        return page

    def _has_key(self, request: web.Request) -> bool:
        offers = request.headers.get("Sec-WebSocket-Protocol", "").encode().split(b",")
        return any(hmac.compare_digest(offer.strip(), self.key.encode()) for offer in offers)

    async def _download(self, request: web.Request) -> web.StreamResponse:
        key = request.match_info["key"]
        try:
            download = await self._downloads.get_download_metadata(key)
        except KeyError:
            raise web.HTTPNotFound(text="This file was downloaded before.") from None
        response = web.StreamResponse()
        response.content_type = "application/octet-stream"
        response.headers["Content-Disposition"] = content_disposition_header(
            "attachment", filename=download.file_name
        )
        await response.prepare(request)
        async for chunk in self._downloads.download(key):
            await response.write(chunk)
        return response

    async def _end_games(self, _application: web.Application) -> None:
        await asyncio.gather(*(game.stop() for game in self._games))


async def _add_headers(_request: web.Request, response: web.StreamResponse) -> None:
    response.headers.update(_HEADERS)


async def _receive(message: Any, game: WebGame, page: web.WebSocketResponse) -> None:
    """Handle a message of Textual's page; anything else is dropped."""
    match message:
        case ["stdin", str(text)]:
            await game.send_bytes(text.encode("utf-8", "replace"))
        case ["resize", {"width": int(width), "height": int(height)}]:
            await game.set_terminal_size(width, height)
        case ["focus"]:
            await game.focus()
        case ["blur"]:
            await game.blur()
        case ["ping", moment]:
            await page.send_json(["pong", moment])


def _side(request: web.Request, name: str, default: int) -> int:
    text = request.query.get(name, "")
    return int(text) if text.isdecimal() and len(text) < 5 else default


def serve(words: Sequence[str], port: int, announce: Callable[[str], None]) -> None:
    """Serve until ^C, on a free port if `port` is 0; raises OSError if the port is taken."""
    server = GameServer(words)
    with socket.create_server(("127.0.0.1", port)) as listener:
        address = f"http://127.0.0.1:{listener.getsockname()[1]}/#{server.key}"

        async def start(_application: web.Application) -> None:
            announce(address)

        application = server.application()
        application.on_startup.append(start)
        web.run_app(application, sock=listener, print=None, access_log=None)
