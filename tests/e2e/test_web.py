"""The game behind a web server, which gives it pipes instead of a terminal."""

import sys
from contextlib import suppress
from pathlib import Path

import aiohttp
import pytest

from tests.browser import serving
from tests.e2e.test_supervisor import GETS_STUCK, NEVER, WHOLE, texts
from tests.terminal import WHERE_IS_THE_CURSOR
from tests.waiting import until
from tests.web import WEB_DRIVER, WebTerminal


def served(
    folder: Path, *python: object, driver: str = WEB_DRIVER, options: tuple[str, ...] = ()
) -> WebTerminal:
    command = [sys.executable, *(python or ("-m", "logical_robots_tui")), "play", "02-open-space"]
    return WebTerminal([*command, *options, "--data-dir", folder], env={"TEXTUAL_DRIVER": driver})


def test_the_game_is_played_through_the_protocol_of_the_web(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        page.send("", sees="· applied")
        page.send("n", sees="tick 1 ")
        page.resize(120, 44)
        page.send("", sees="Open space")
        page.send("2\x1b[200~pasted text\x1b[201~", sees="pasted text")
        page.send("\x1b")
        page.send("\x1a", sees="applied")
        for content, answer in (("damaged", "own.l is empty."), ("MQ==", "own.l in")):
            page.tell({"type": "upload", "name": "own.l", "content": content})
            page.send("", sees=answer)
        page.send("\x15", sees="Only the page of logical-robots serve")
        page.send("q")
        assert page.finish() == 0
        assert page.meta[-1] == {"type": "exit"}


def test_another_page_takes_over_a_restricted_game(tmp_path: Path) -> None:
    with served(tmp_path, options=("--restricted",)) as page:
        page.wait_for("· applied")
        page.send("2hello", sees="hello")
        page.screen.reset()
        sent = page.traffic
        page.tell({"type": "attach", "width": 100, "height": 40})
        page.wait_for(lambda: all(text in page.text for text in ("LOGICAL", "hello", "^R Apply")))
        for mode in ("1049", "1000", "1006", "2004"):  # alternate screen, mouse, pastes
            assert page.has_received(f"\x1b[?{mode}h", since=sent)


@pytest.mark.parametrize("is_asked", [False, True], ids=["gone", "asks to quit"])
def test_a_server_ends_the_game_which_keeps_the_text(tmp_path: Path, *, is_asked: bool) -> None:
    with served(tmp_path) as page:
        page.wait_for("applied")
        page.send("2hello", sees="hello")
        if is_asked:
            page.tell({"type": "quit"})
            page.finish()
        assert page.hang_up() == (0, "")
    assert texts(tmp_path) == ["hello"]


def test_a_driver_that_is_not_there_is_named(tmp_path: Path) -> None:
    with served(tmp_path, driver="textual.drivers:None") as page:
        status, said = page.hang_up()
    assert (status, said.count("\n")) == (2, 1)
    assert "TEXTUAL_DRIVER=textual.drivers:None: This is not a driver of Textual" in said


@pytest.mark.slow
def test_a_stuck_game_is_ended_and_closes_its_page(tmp_path: Path) -> None:
    code = GETS_STUCK.replace('os.write(1, b"stuck")', "pass") + WHOLE
    with served(tmp_path, "-c", code, "waits in C", NEVER, 2.0, NEVER) as page:
        page.wait_for("applied")
        page.send("2hello", sees="hello")
        until(lambda: list((tmp_path / "drafts").glob("*.json")))
        page.send("\x03")
        assert page.finish() == 70
        assert page.meta[-1] == {"type": "exit"}
        assert page.process.stderr is not None
        assert b"The game was stuck and was ended" in page.process.stderr.read()
    assert texts(tmp_path) == ["hello"]


MOST_DRAWN = 300_000  # bytes


async def test_a_page_that_is_resized_at_once_is_drawn_once(tmp_path: Path) -> None:
    with serving(tmp_path, "01-first-steps") as address:
        assert await drawn_bytes(address) < MOST_DRAWN


async def drawn_bytes(address: str) -> int:
    origin, _, key = address.partition("/#")
    async with (
        aiohttp.ClientSession(headers={"Origin": origin}) as session,
        session.ws_connect(f"{origin}/ws", protocols=["logical-robots", key, "x"]) as page,
    ):
        await page.send_json(["resize", {"width": 140, "height": 40}])
        size = 0  # bytes: 67,000, and 20,000 of each further picture
        timeout = None
        with suppress(TimeoutError):
            while size < MOST_DRAWN:
                message = await page.receive(timeout=timeout)
                if message.type == aiohttp.WSMsgType.BINARY:
                    size += len(message.data)
                    timeout = 1.0 if b"applied" in message.data else timeout
                    for _ in range(message.data.count(WHERE_IS_THE_CURSOR)):
                        await page.send_json(["stdin", "\x1b[1;1R"])
    return size
