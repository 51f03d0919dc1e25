"""The served game in a real browser."""

import os
import re
import shutil
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from subprocess import PIPE, Popen
from time import monotonic

import pyte
import pytest
from playwright.sync_api import Browser, Page, ViewportSize, WebSocket, sync_playwright

from tests.processes import run_command
from tests.waiting import PATIENCE

CHROMIUM = shutil.which("chromium")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None and "CI" not in os.environ, reason="there is no Chromium"),
]
SIZE = ViewportSize(width=1280, height=800)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    command = [sys.executable, "-m", "logical_robots_tui", "serve", "01-first-steps", "--no-open"]
    with Popen([*command, "--data-dir", tmp_path], stdout=PIPE, text=True) as server:
        assert server.stdout is not None
        match = re.match(r"Playing at (http://127\.0\.0\.1:\d+/#\S+)", server.stdout.readline())
        assert match
        yield match[1]
        server.send_signal(signal.SIGINT)
        assert server.wait(PATIENCE) == 0


class Seat:
    """A page of the browser, and the screen that the server has sent to it."""

    def __init__(self, browser: Browser, address: str) -> None:
        self.page: Page = browser.new_context(viewport=SIZE).new_page()
        self.screen = pyte.Screen(1, 1)  # of the latest connection
        self.errors: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("dialog", lambda dialog: dialog.accept())
        self.page.on("websocket", self._open)
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

    def press(self, *keys: str, sees: str = "") -> None:
        for key in keys:
            self.page.keyboard.press(key)
        if sees:
            self.sees(sees)


@pytest.fixture
def seat(browser: Browser, address: str) -> Iterator[Seat]:
    seat = Seat(browser, address)
    seat.sees("· applied")
    yield seat
    seat.page.context.close()
    assert not seat.errors


def test_the_first_level_is_won_with_a_program_that_is_pasted(seat: Seat, tmp_path: Path) -> None:
    assert seat.page.title() == "First steps · Logical Robots"
    assert "#" not in seat.page.url
    seat.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    program = (Path(__file__).parents[2] / "programs" / "first-steps.l").read_text("utf-8")
    seat.page.evaluate("text => navigator.clipboard.writeText(text)", program)
    seat.press("2", "Control+a", "Control+v", sees="not applied")
    seat.press("Control+r", sees="· applied ·")
    seat.press("Escape", "+", "+", "+", "+", "Space", sees="WON")
    assert seat.page.evaluate("document.fonts.check('16px \"Roboto Mono\"', '▟⠿')")
    seat.press("Escape", "Control+p")
    seat.page.keyboard.type("save a replay")
    with seat.page.expect_download() as download:
        seat.press("Enter")
    replay = tmp_path / download.value.suggested_filename
    download.value.save_as(replay)
    verify = [sys.executable, "-m", "logical_robots_tui", "replay", "verify", replay]
    assert run_command(verify).returncode == 0
    seat.page.set_viewport_size({"width": 1000, "height": 700})

    def has_left() -> bool:
        seat.press("Escape", "q")
        return seat.page.is_visible("#end")

    seat.sees(has_left)
    assert seat.page.inner_text("#reason") == "The game has ended."


def test_a_page_that_is_loaded_again_or_opened_after_it_was_closed_finds_its_game(
    seat: Seat, browser: Browser, address: str
) -> None:
    seat.press("2")
    seat.page.keyboard.type("hello")
    seat.sees("hello")
    seat.page.reload()
    seat.sees("hello")
    seat.page.close()
    later = Seat(browser, address)
    later.sees("hello")
    later.page.context.close()


@pytest.mark.parametrize("key", ["", "#", "#wrong", "#ö"])
def test_nobody_plays_without_the_key(key: str, browser: Browser, address: str) -> None:
    page = browser.new_context().new_page()
    page.goto(address.partition("#")[0] + key)
    page.wait_for_selector("#end:not([hidden])")
    assert "no valid key" in page.inner_text("#reason")
    page.context.close()
