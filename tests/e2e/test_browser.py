"""The served game in a real browser."""

import os
import re
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Browser, FileChooser, expect

from logical_robots_tui.tui.labyrinth.drawing.cells import BLOCKS
from tests.browser import CHROMIUM, SIZE, Client, Seat, chromium, serving, zoomed
from tests.e2e.test_supervisor import texts
from tests.processes import run_command
from tests.terminal import Terminal, looks
from tests.waiting import PATIENCE, until

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None and "CI" not in os.environ, reason="there is no Chromium"),
]

BAR_IS_LAST = """
() => terminal.buffer.active.getLine(terminal.rows - 1).translateToString().includes("Run")
"""


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
    seat.press("Escape", "+", "+", "+", "+", "Space", sees="You made it")
    assert seat.page.evaluate("document.fonts.check('16px \"Roboto Mono\"', '▟⠿')")
    seat.press("Escape", sees=lambda: "You made it" not in seat.text)
    seat.finds_command("Save a replay")
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
    choosers: list[FileChooser] = []
    seat.page.on("filechooser", lambda chooser: choosers.append(chooser))
    seat.press("Control+u", sees=lambda: choosers)
    choosers.pop().set_files([file])
    seat.sees("mine.l in")
    seat.page.evaluate(  # as browsers that have forgotten the key
        """() => {
            HTMLInputElement.prototype.showPicker = () => {
                throw new DOMException("", "NotAllowedError");
            };
        }"""
    )
    dialog = seat.page.get_by_role("dialog", name="A program, a level or a replay")
    seat.press("Control+u")
    expect(dialog).to_be_visible(timeout=1000 * PATIENCE)
    seat.press("Enter", sees=lambda: choosers)
    seat.press("Escape")
    expect(dialog).to_be_hidden()
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
    seat.finds_command("Download the program")
    with seat.page.expect_download() as download:
        seat.press("Enter")
    assert download.value.suggested_filename == "mine-2.l"
    assert download.value.path().read_text("utf-8") == "typed # dropped\n"


def test_the_game_in_plain_text_needs_only_keys_and_keeps_the_text(
    browser: Browser, address: str, tmp_path: Path
) -> None:
    page = browser.new_context(viewport=SIZE).new_page()
    page.goto(address)
    page.on("dialog", lambda dialog: dialog.accept())
    page.get_by_role("link", name="Play in plain text").focus()
    page.keyboard.press("Enter")
    log, field = page.get_by_role("log", name="Game"), page.get_by_label("Command")

    def types(line: str, answer: str) -> None:
        page.keyboard.type(line)
        page.keyboard.press("Enter")
        expect(log).to_contain_text(re.compile(answer), timeout=1000 * PATIENCE)

    expect(log).to_contain_text("Type help for the commands.", timeout=1000 * PATIENCE)
    assert page.evaluate("document.activeElement.id") == "line"
    page.keyboard.press("Escape")  # ends no game
    types("step", r"Tick 1\.")
    types("run 1000000", "> run 1000000.*is blocked")
    page.keyboard.press("Control+c")
    expect(log).to_contain_text(re.compile(r"Tick \d+\.$"), timeout=1000 * PATIENCE)
    types("help", "leave; so does the end of the input")
    expect(field).to_be_in_viewport()
    expect(log.get_by_text("leave; so does")).to_be_in_viewport()
    page.keyboard.press("ArrowUp")
    expect(field).to_have_value("help")
    page.keyboard.press("ArrowDown")
    for name in ("Send", "Stop the run"):
        page.keyboard.press("Tab")
        expect(page.get_by_role("button", name=name)).to_be_focused()
    field.focus()
    types("line 1 hello", "Type apply")
    page.keyboard.type("run 1000000")
    page.keyboard.press("Enter")
    page.context.close()
    assert texts(tmp_path) == ["hello"]


def test_the_end_of_a_game_in_plain_text_is_told(browser: Browser, address: str) -> None:
    page = browser.new_context().new_page()
    page.goto(address.replace("#", "?plain#"))
    page.keyboard.type("quit")
    page.keyboard.press("Enter")
    log = page.get_by_role("log")
    expect(log).to_contain_text("The game has ended.", timeout=1000 * PATIENCE)
    expect(page.get_by_role("button", name="Play again")).to_be_focused()
    page.keyboard.press("Enter")
    expect(log).to_contain_text("Type help", timeout=1000 * PATIENCE)
    page.context.close()


def test_the_first_level_is_won_with_the_mouse(browser: Browser, tmp_path: Path) -> None:
    with serving(tmp_path, "01-first-steps", "first-steps") as address:
        seat = Seat(browser, address)
        seat.sees("· applied")
        for speed in ("80/s", "160/s", "320/s"):
            seat.click("+ Speed", sees=speed)
        seat.click("Run", sees="WON")
        seat.page.context.close()


def test_a_first_start_shows_the_player_round(browser: Browser, tmp_path: Path) -> None:
    with serving(tmp_path) as address:
        seat = Seat(browser, address)
        seat.press(sees="skip the tour")

        def has_ended() -> bool:
            seat.press("Enter")
            return "skip the tour" not in seat.text

        seat.sees(has_ended)
        seat.page.context.close()


def test_keys_that_a_browser_takes_have_second_ones(seat: Seat) -> None:
    seat.press("2", sees="Leave")
    seat.page.keyboard.type("hello world")
    seat.sees("hello world")
    seat.press("Alt+Backspace")
    seat.sees(lambda: "hello" in seat.text and "world" not in seat.text)
    seat.press("F10")
    seat.sees(lambda: "Leave" not in seat.text)
    seat.press("1", "k")
    seat.sees(lambda: "Program" not in seat.text)


def test_two_pages_are_two_games(seat: Seat, browser: Browser, address: str) -> None:
    other = Seat(browser, address)
    other.sees("· applied")
    seat.press("n", sees="tick 1 ")
    other.press("n", "n", sees="tick 2 ")
    assert "tick 1 " in seat.text
    other.page.context.close()


def test_a_window_of_another_size_is_filled(seat: Seat) -> None:
    columns, lines = seat.screen.columns, seat.screen.lines
    seat.page.set_viewport_size({"width": 900, "height": 600})
    seat.page.wait_for_function("columns => window.terminal.cols < columns", arg=columns)
    width, height = seat.page.evaluate("[terminal.cols, terminal.rows]")
    assert (columns, lines) > (width, height)
    seat.screen.resize(height, width)
    seat.shows("Quit")
    seat.page.wait_for_function(BAR_IS_LAST)


def test_a_page_shows_what_a_terminal_shows(seat: Seat, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps"]
    size = seat.screen.columns, seat.screen.lines
    with Terminal([*command, "--data-dir", tmp_path / "other"], size=size) as terminal:
        terminal.wait_for("· applied")
        for tick in ("tick 1 ", "tick 2 ", "tick 3 "):
            terminal.send("n", sees=tick)
            seat.press("n", sees=tick)
            seat.shows(tick)
        terminal.wait_for("Robots · tick 3")
        seat.shows("Robots · tick 3")
        *page_rows, page_bar = seat.looks()
        *rows, bar = looks(terminal.screen)
    assert page_rows == rows
    assert page_bar[:12] == bar[:12]  # later keys are those that a browser passes on


def test_a_map_has_no_gaps_at_any_zoom(browser: Browser, address: str) -> None:
    """The pixels in the corners of each cell have the colours of its quadrants."""
    for zoom in (0.5, 0.67, 0.8, 1, 1.1, 1.25, 1.5, 2):
        with zoomed(browser, zoom) as window:
            seat = Seat(window, address, size=None)
            seat.shows("tick 0")
            seat.sees(partial(has_no_gaps, seat, zoom))  # once all of it is drawn


def has_no_gaps(seat: Seat, zoom: float) -> bool:
    width, height = (round(side * zoom) for side in seat.cell_size)
    colors = quadrant_corners(seat.looks(), width, height)
    return len(colors) > 100 and seat.pixels([*colors]) == [*colors.values()]


def quadrant_corners(
    cells: list[list[tuple[object, ...]]], width: int, height: int
) -> dict[tuple[int, int], object]:
    """Return the colours of pixels by their x and y, of cells in all columns and lines."""
    colors = {}
    for y, row in enumerate(cells):
        for x, (sign, paper, *marks) in enumerate(row):
            if (x + y) % 4 == 0 and str(sign) in BLOCKS[4].strip():
                filled, ink = BLOCKS[4].index(str(sign)), marks[0]
                for quadrant in range(4):
                    corner_x = (x + quadrant % 2) * width - quadrant % 2
                    corner_y = (y + quadrant // 2) * height - quadrant // 2
                    colors[corner_x, corner_y] = ink if filled >> quadrant & 1 else paper
    return colors


@pytest.mark.parametrize("key", ["", "#", "#wrong", "#ö"])
def test_nobody_plays_without_the_key(key: str, browser: Browser, address: str) -> None:
    page = browser.new_context().new_page()
    page.goto(address.partition("#")[0] + key)
    page.wait_for_selector("#end:not([hidden])")
    assert "no valid key" in page.inner_text("#reason")
    page.context.close()


@pytest.mark.parametrize("key", ["", "#wrong"])
def test_a_websocket_without_the_key_gets_no_game(key: str, address: str) -> None:
    with Client(address.partition("#")[0] + key, size=(80, 24)) as client:
        until(lambda: not client.receive())
        assert client.everything == ""
