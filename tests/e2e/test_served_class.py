"""A class that plays in browsers: who gets in, which game it is, and what ends it."""

import asyncio
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager, suppress
from pathlib import Path
from subprocess import PIPE, STDOUT
from typing import Any

import aiohttp
import pyte
import pytest
from aiohttp.test_utils import TestServer

from logical_robots_tui.web.players import Players, change_player, new_token
from logical_robots_tui.web.server import GameServer
from tests.e2e.test_supervisor import texts
from tests.processes import run_command
from tests.waiting import PATIENCE

COMMAND = [sys.executable, "-m", "logical_robots_tui", "serve"]
SIZE = "?width=100&height=30"
BASE = "/robots"
NEVER, AT_ONCE = 3600.0, 0.0  # seconds


class Tab:
    """A page of a browser, without the browser: a websocket and what it would show."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.socket = socket
        self.reason: str | None = None
        self.messages: list[list[Any]] = []
        self._screen = pyte.Screen(100, 30)
        self._stream = pyte.ByteStream(self._screen)

    @property
    def text(self) -> str:
        return "\n".join(self._screen.display)

    async def sees(self, text: str) -> None:
        async with asyncio.timeout(PATIENCE):
            while text not in self.text:
                assert await self._receive(), f"{self.reason}: {text} is not in\n{self.text}"

    async def hears(self, kind: str) -> Any:
        async with asyncio.timeout(PATIENCE):
            while not (contents := [rest for head, *rest in self.messages if head == kind]):
                assert await self._receive(), self.reason
        return contents[-1][0]

    async def is_refused(self) -> str:
        """Read until the page is closed, and return the reason."""
        async with asyncio.timeout(PATIENCE):
            while await self._receive():
                pass
        assert self.reason is not None
        return self.reason

    async def type(self, keys: str, sees: str) -> None:
        await self.socket.send_json(["stdin", keys])
        await self.sees(sees)

    async def _receive(self) -> bool:
        message = await self.socket.receive()
        if message.type == aiohttp.WSMsgType.BINARY:
            self._stream.feed(message.data)
            with suppress(ConnectionError):
                for _ in range(message.data.count(b"\x1b[6n")):
                    await self.socket.send_json(["stdin", "\x1b[1;1R"])
        elif message.type == aiohttp.WSMsgType.TEXT:
            self.messages.append(json.loads(message.data))
            if self.messages[-1][0] == "ended":
                self.reason = self.messages[-1][1]
        return message.type in (aiohttp.WSMsgType.BINARY, aiohttp.WSMsgType.TEXT)


async def open_tab(
    session: aiohttp.ClientSession, url: str, token: str, tab: str = "tab", origin: str = ""
) -> Tab:
    protocols = [text for text in ("logical-robots", token, tab) if text]
    address, headers = f"{url}{BASE}/ws{SIZE}", {"Origin": origin or url}
    return Tab(await session.ws_connect(address, protocols=protocols, headers=headers))


class School:
    """A server with the players Ada and Bob, in this process."""

    def __init__(self, folder: Path, url: str, session: aiohttp.ClientSession) -> None:
        self.data, self.players, self.url = folder / "data", folder / "players.toml", url
        self.tokens = {"ada": new_token(), "bob": new_token()}
        for name, token in self.tokens.items():
            change_player(self.players, name, token)
        self.session, self.warnings = session, list[str]()

    async def open(self, token: str, tab: str = "tab", origin: str = "") -> Tab:
        return await open_tab(self.session, self.url, token, tab, origin)

    async def health(self) -> dict[str, int]:
        async with self.session.get(f"{self.url}{BASE}/healthz") as response:
            health: dict[str, int] = await response.json()
            return health

    async def has_games(self, number: int) -> None:
        async with asyncio.timeout(PATIENCE):
            while (await self.health())["games"] != number:
                pass


@asynccontextmanager
async def school(folder: Path, absence: float, limit: int = 10) -> AsyncIterator[School]:
    folder.joinpath("data").mkdir()
    words = ["02-open-space", "--restricted", "--data-dir", str(folder / "data")]
    async with AsyncExitStack() as stack:
        session = await stack.enter_async_context(aiohttp.ClientSession())
        place = School(folder, "", session)
        digests = Players(place.players, place.warnings.append).digests
        games = GameServer(words, digests, limit=limit, base_path=BASE, absence=absence, delay=0.1)
        server = await stack.enter_async_context(TestServer(games.application()))
        place.url = str(server.make_url("")).rstrip("/")
        yield place


def children() -> set[int]:
    tasks = Path(f"/proc/{os.getpid()}/task").glob("*/children")
    pids = {int(pid) for task in tasks for pid in task.read_text().split()}
    return {pid for pid in pids if b"--restricted" in Path(f"/proc/{pid}/cmdline").read_bytes()}


def environment_of(pid: int) -> str:
    return Path(f"/proc/{pid}/environ").read_text()


async def test_a_page_comes_back_to_its_game_and_only_to_its_own(tmp_path: Path) -> None:
    async with school(tmp_path, NEVER) as place:
        ada = await place.open(place.tokens["ada"])
        await ada.sees("· applied")
        await ada.type("2hello", sees="hello")
        (pid,) = children()
        environment = environment_of(pid)
        assert "LOGICAL_ROBOTS_PLAYER=ada" in environment
        assert not any(token in environment for token in place.tokens.values())
        bob = await place.open(place.tokens["bob"])  # whose tab has the same name
        await bob.sees("· applied")
        assert "hello" not in bob.text
        assert {path.name for path in (place.data / "players").iterdir()} == {"ada", "bob"}

        await ada.socket.close()
        ada = await place.open(place.tokens["ada"])
        await ada.sees("hello")
        assert await ada.hears("title") == "Open space"
        again = await place.open(place.tokens["ada"])  # before the server misses the other
        await again.sees("hello")
        assert "another tab" in await ada.is_refused()
        assert await place.health() == {"games": 2, "limit": 10}
        assert pid in children()

        second = await place.open(place.tokens["ada"], "second")
        await second.sees("Another game has been open")
        await second.socket.close()
        third = await place.open(place.tokens["ada"], "third")  # takes over what has no page
        await third.sees("Another game has been open")
        assert await place.health() == {"games": 3, "limit": 10}

        token = new_token()
        assert change_player(place.players, "ada", token)
        for tab in (again, third):
            assert "no longer valid" in await tab.is_refused()
        assert "no valid key" in await (await place.open(place.tokens["ada"])).is_refused()
        ada = await place.open(token)
        await ada.sees("unsaved")
        change_player(place.players, "ada", None)
        assert "no longer valid" in await ada.is_refused()
        place.players.write_text("[ada")
        assert "no valid key" in await (await place.open(token)).is_refused()
        assert "The players stay as they were" in place.warnings[0]
        await bob.type("2hello", sees="hello")
        assert await place.health() == {"games": 1, "limit": 10}
    assert texts(place.data / "players" / "bob") == ["hello"]
    assert not children()


async def test_a_page_that_stays_away_ends_its_game_and_keeps_the_text(tmp_path: Path) -> None:
    async with school(tmp_path, AT_ONCE) as place:
        ada = await place.open(place.tokens["ada"])
        await ada.sees("· applied")
        await ada.type("2hello", sees="hello")
        await ada.socket.close()
        await place.has_games(0)
        ada = await place.open(place.tokens["ada"])
        await ada.sees("unsaved")


async def test_games_are_limited_for_each_player_and_in_all(tmp_path: Path) -> None:
    async with school(tmp_path, NEVER, limit=5) as place:
        tabs = [await place.open(place.tokens["ada"], f"tab-{number}") for number in range(4)]
        for tab in tabs:
            await tab.sees("· applied")
        fifth = await place.open(place.tokens["ada"], "tab-5")
        assert "You have 4 games open, the most allowed" in await fifth.is_refused()
        await place.has_games(4)
        bob = await place.open(place.tokens["bob"], "tab-1")
        await bob.sees("· applied")
        assert "All 5 games" in await (await place.open(place.tokens["bob"], "tab-2")).is_refused()


async def test_nobody_gets_in_without_a_token(tmp_path: Path) -> None:
    async with school(tmp_path, NEVER) as place:
        tokens = ["guess", "", "ada", next(iter(Players(place.players, print).digests().values()))]
        for token in tokens:
            assert "no valid key" in await (await place.open(token)).is_refused()

        async def guess(number: int) -> str:
            try:
                return await (await place.open(f"guess-{number}")).is_refused()
            except aiohttp.WSServerHandshakeError as error:
                return str(error.status)

        guesses = asyncio.gather(*map(guess, range(100)))
        ada = await place.open(place.tokens["ada"])
        await ada.sees("· applied")
        for reason in await guesses:
            assert reason == "429" or "no valid key" in reason
        await ada.type("n", sees="tick 1 ")
        await ada.socket.send_json(["stdin", "\x10save a replay\r"])
        download = f"{place.url}{BASE}/download/{await ada.hears('deliver_file_start')}"
        for status in (200, 404):  # once
            async with place.session.get(download) as response:
                assert await response.read()
                assert response.status == status
        for origin in ("http://elsewhere.example", "null"):
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await place.open(place.tokens["ada"], origin=origin)
        for path, status in (
            ("", 404),
            (BASE, 200),
            ("/healthz", 404),
            (f"{BASE}/download/x", 404),
        ):
            async with place.session.get(place.url + path) as response:
                assert response.status == status
                assert response.headers["Referrer-Policy"] == "no-referrer" or status == 404
        assert await place.health() == {"games": 1, "limit": 10}


@contextmanager
def server(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str, str]]:
    """A server in a process of its own, its address and Ada's token."""
    options = ["--class", folder / "players.toml", "--base-path", BASE, "--port", "0"]
    link = run_command([*COMMAND, *options, "--add", "ada"]).stdout
    command = map(str, [*COMMAND, "02-open-space", *options, "--data-dir", folder])
    with subprocess.Popen([*command], stdout=PIPE, stderr=STDOUT, text=True) as process:
        assert process.stdout is not None
        line = process.stdout.readline()
        match = re.match(r"Serving a class at (http://127\.0\.0\.1:\d+)/robots/ ", line)
        assert match, line
        yield process, match[1], link.strip().rpartition("#")[2]
        assert process.wait(PATIENCE) == 0
        assert process.stdout.read() == ""


async def test_a_signal_ends_the_server_which_keeps_texts_and_secrets(tmp_path: Path) -> None:
    with server(tmp_path) as (process, url, token):
        async with aiohttp.ClientSession() as session:
            ada = await open_tab(session, url, token)
            await ada.sees("· applied")
            await ada.type("2hello", sees="hello")
            assert token not in run_command(["ps", "-e", "-ww", "-o", "args"]).stdout
            process.send_signal(signal.SIGTERM)
            await ada.is_refused()
    assert texts(tmp_path / "players" / "ada") == ["hello"]
