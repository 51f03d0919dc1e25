"""The served game in a real browser."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from tests.browser import CHROMIUM, Seat, chromium, serving
from tests.processes import run_command

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None and "CI" not in os.environ, reason="there is no Chromium"),
]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as browser:
        yield browser


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    with serving(tmp_path, "01-first-steps") as address:
        yield address


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


def test_files_go_to_the_game_and_back(seat: Seat, tmp_path: Path) -> None:
    file = tmp_path / "mine.l"
    file.write_text("# mine\n", "utf-8")
    with seat.page.expect_file_chooser() as chooser:
        seat.press("Control+u")
    chooser.value.set_files([file])
    seat.sees("mine.l in")
    assert (tmp_path / "programs" / "mine.l").read_text("utf-8") == "# mine\n"
    data = seat.page.evaluate_handle(
        """() => {
            const data = new DataTransfer();
            data.items.add(new File(["# dropped\\n"], "mine.l"));
            return data;
        }"""
    )
    seat.page.dispatch_event(".textual-terminal", "drop", {"dataTransfer": data})
    seat.sees("mine-2.l in")
    seat.press("2", sees="# dropped")
    seat.page.keyboard.type("typed ")
    seat.sees("typed # dropped")
    seat.press("Control+p")
    seat.page.keyboard.type("download the program")
    with seat.page.expect_download() as download:
        seat.press("Enter")
    assert download.value.suggested_filename == "mine-2.l"
    assert download.value.path().read_text("utf-8") == "typed # dropped\n"


@pytest.mark.parametrize("key", ["", "#", "#wrong", "#ö"])
def test_nobody_plays_without_the_key(key: str, browser: Browser, address: str) -> None:
    page = browser.new_context().new_page()
    page.goto(address.partition("#")[0] + key)
    page.wait_for_selector("#end:not([hidden])")
    assert "no valid key" in page.inner_text("#reason")
    page.context.close()
