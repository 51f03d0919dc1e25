"""Work in the background of a dialog that is closed meanwhile."""

import asyncio
from collections.abc import Awaitable, Callable

import pytest
from textual.app import App, ComposeResult
from textual.dom import NoScreen
from textual.screen import ModalScreen
from textual.widgets import Static
from textual.worker import WorkerFailed

from logical_robots_tui.tui.app.ui import in_background
from tests.waiting import PATIENCE


class Dialog(ModalScreen[None]):
    def __init__(self, *, closes: bool) -> None:
        super().__init__()
        self.closes = closes
        self.lost = asyncio.Event()

    def compose(self) -> ComposeResult:
        yield Static(id="said")

    def on_mount(self) -> None:
        in_background(self, self._work)

    async def _work(self) -> None:
        if self.closes:
            self.dismiss()
        else:
            await self.query_one("#said").remove()
        while self.query("#said"):  # noqa: ASYNC110 - the very turn in which it goes is wanted
            await asyncio.sleep(0)
        self.lost.set()
        self.query_one("#said", Static).update("done")


async def show(dialog: Dialog) -> None:
    async with App[None]().run_test() as pilot, asyncio.timeout(PATIENCE):
        await pilot.app.push_screen(dialog)
        await dialog.lost.wait()


async def test_a_dialog_that_was_closed_has_no_last_word() -> None:
    await show(Dialog(closes=True))


async def test_what_is_missing_in_a_dialog_that_is_open_is_a_mistake() -> None:
    with pytest.raises(WorkerFailed, match="NoMatches"):
        await show(Dialog(closes=False))


async def test_work_for_a_part_off_screen_is_no_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[Callable[[], Awaitable[None]]] = []
    async with App[None]().run_test() as pilot:
        part = Static()
        await pilot.app.mount(part)
        monkeypatch.setattr(part, "run_worker", lambda work, **_: begun.append(work))

        async def look() -> None:
            raise NoScreen("node has no screen")

        in_background(part, look)
        with pytest.raises(NoScreen):
            await begun[0]()
        await part.remove()
        await begun[0]()
