"""The web server: the page, its websocket, and downloads.

A player's token is in the fragment of the page's address, which no server and no log gets to see,
and is sent as a subprotocol of the websocket.
"""

from __future__ import annotations

import asyncio
import hmac
import secrets
import socket
import zlib
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import suppress
from ipaddress import ip_address
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import textual_serve
from aiohttp import set_zlib_backend, web
from aiohttp.helpers import content_disposition_header
from aiohttp.http import WSMsgType
from textual_serve.download_manager import DownloadManager

from logical_robots_tui.web.games import PlainGame, WebGame, dismiss
from logical_robots_tui.web.players import digest_of

_HERE = Path(__file__).parent / "static"
_TEXTUAL = Path(textual_serve.__file__).parent / "static"
_PROTOCOL = "logical-robots"
_LARGEST_MESSAGE = 4_000_000  # bytes; a paste of a million letters, some of which take three
_HEARTBEAT = 15.0  # seconds
_LOOK_SECONDS = 1.0
_MOST_DELAYED = 20  # wrong tokens at once; more are refused without delay
_REFUSAL = "This address has no valid key. Open the whole link that you were given."
_REVOKED = "This link is no longer valid. Unsaved text is kept for the next one."
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}

# As ssh -C compresses; at aiohttp's own level, the lowest, a websocket takes half as much again.
set_zlib_backend(SimpleNamespace(**{**vars(zlib), "Z_BEST_SPEED": zlib.Z_DEFAULT_COMPRESSION}))


class GameServer:
    """Serves games, started with some arguments, to the players whose tokens have the digests.

    `digests` returns them by name; a game ends when its digest is gone. There are at most `limit`
    games. A game without a page ends after `absence` seconds, and a wrong token is answered after
    `delay` seconds. `base_path` is the beginning of every path.
    """

    def __init__(
        self,
        words: Sequence[str],
        digests: Callable[[], Mapping[str, str]],
        *,
        limit: int,
        base_path: str = "",
        absence: float = 60.0,
        delay: float = 1.0,
    ) -> None:
        self._words, self._digests, self._limit = words, digests, limit
        self._base_path, self._absence, self._delay = base_path, absence, delay
        self._downloads = DownloadManager()
        self._games: set[WebGame] = set()
        self._wrong_tokens = 0  # whose answers are delayed at this moment

    def application(self) -> web.Application:
        application, base = web.Application(), self._base_path
        application.add_routes(
            [
                web.get(f"{base}/", self._page),
                web.get(f"{base}/ws", self._connect),
                web.get(f"{base}/download/{{key}}", self._download),
                web.get(f"{base}/healthz", self._health),
                web.static(f"{base}/textual", _TEXTUAL),
                web.static(f"{base}/static", _HERE),
            ]
        )
        if base:
            application.router.add_get(base, self._redirect)
        application.on_response_prepare.append(_add_headers)
        application.cleanup_ctx.append(self._run_revocations)
        application.on_startup.append(self._start_early)
        application.on_shutdown.append(self._end_games)
        return application

    async def _start_early(self, _application: web.Application) -> None:
        """Start the game of an only player while the browser still opens its page."""
        if digest := self._digests().get(""):
            with suppress(OSError):  # which the page will be told
                game = await self._game_for("", digest, "", WebGame)
                await game.open(80, 24)
                game.detach(None, self._absence)

    async def _page(self, request: web.Request) -> web.FileResponse:
        return web.FileResponse(_HERE / ("plain.html" if "plain" in request.query else "page.html"))

    async def _redirect(self, _request: web.Request) -> web.Response:
        raise web.HTTPFound(f"{self._base_path}/")

    async def _health(self, _request: web.Request) -> web.Response:
        return web.json_response({"games": len(self._games), "limit": self._limit})

    async def _connect(self, request: web.Request) -> web.WebSocketResponse:
        """Play a game in a page until either ends."""
        if request.headers.get("Origin", "").partition("://")[2] != request.host:
            raise web.HTTPForbidden(text="This page belongs to another server.")
        offers = request.headers.get("Sec-WebSocket-Protocol", "").split(",")
        _, token, tab = [*(offer.strip() for offer in offers), "", "", ""][:3]
        digest = digest_of(token)
        digests = self._digests()
        players = [name for name in digests if hmac.compare_digest(digests[name], digest)]
        if not players and self._wrong_tokens >= _MOST_DELAYED:
            raise web.HTTPTooManyRequests
        page = web.WebSocketResponse(
            heartbeat=_HEARTBEAT, max_msg_size=_LARGEST_MESSAGE, protocols=[_PROTOCOL]
        )
        await page.prepare(request)
        if not players:
            self._wrong_tokens += 1
            await asyncio.sleep(self._delay)
            self._wrong_tokens -= 1
            await dismiss(page, _REFUSAL)
            return page
        size = _side(request, "width", 80), _side(request, "height", 24)
        try:
            kind = PlainGame if "plain" in request.query else WebGame
            game = await self._game_for(players[0], digest, tab or secrets.token_hex(), kind)
            await game.attach(page, *size)
        except OSError as error:
            await dismiss(page, error.strerror or str(error))
            return page
        try:
            async for message in page:
                if message.type == WSMsgType.TEXT:
                    await _receive(message.json(), game, page)
        finally:
            game.detach(page, self._absence)
        return page

    async def _game_for(self, player: str, digest: str, tab: str, kind: type[WebGame]) -> WebGame:
        """Return the game of a tab, or one whose page is gone, or a new one; raises OSError."""
        games = [game for game in self._games if game.player == player]
        open_games = [
            game for game in games if game.is_open and game.digest == digest and type(game) is kind
        ]
        matches = [game for game in open_games if game.tab == tab]
        matches += [game for game in open_games if game.page is None]
        if matches:
            game = matches[0]
        else:
            # Text that they keep is on offer once they have ended.
            await asyncio.gather(*(game.stop() for game in games if not game.is_open))
            if len(self._games) >= self._limit:
                raise OSError(f"All {self._limit} games are taken. Try again in a few minutes.")
            game = kind(self._words, player, digest, self._downloads, self._games.discard)
            self._games.add(game)
        game.tab = tab
        return game

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

    async def _run_revocations(self, _application: web.Application) -> AsyncIterator[None]:
        task = asyncio.create_task(self._end_revoked())
        yield
        task.cancel()

    async def _end_revoked(self) -> None:
        while True:
            await asyncio.sleep(_LOOK_SECONDS)
            digests = self._digests()
            for game in self._games:
                if digests.get(game.player) != game.digest:
                    game.end(_REVOKED)

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
        case ["upload", str(name), str(content)]:
            await game.send_meta({"type": "upload", "name": name, "content": content})
        case ["ping", moment]:
            await page.send_json(["pong", moment])


def _side(request: web.Request, name: str, default: int) -> int:
    text = request.query.get(name, "")
    return int(text) if text.isdecimal() and len(text) < 5 else default


def is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def serve(server: GameServer, host: str, port: int, announce: Callable[[int], None]) -> None:
    """Serve until ^C or SIGTERM, on any free port if `port` is 0; `announce` gets its number.

    Raises OSError if the port is taken.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.create_server((host, port), family=family) as listener:

        async def start(_application: web.Application) -> None:
            announce(listener.getsockname()[1])

        application = server.application()
        application.on_startup.append(start)
        web.run_app(application, sock=listener, print=None, access_log=None)
