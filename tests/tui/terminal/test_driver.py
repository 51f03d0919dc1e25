"""What the driver sends while a terminal answers, and when it does not, and what it hears."""

import asyncio
import os
import signal
from pathlib import Path

import pytest
from textual import events
from textual.app import App

from logical_robots_tui.tui.terminal import diff_app as sparing
from logical_robots_tui.tui.terminal.driver import InputFilter, ListeningDriver
from tests.tui.conftest import opened


@pytest.mark.usefixtures("drawn_at_once")
async def test_answers_decide_what_is_sent(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, written, ended = list[str](), list[str](), list[int]()
    async with opened(data_dir, ready=True) as game:
        await game.later(1)
        driver = type(game.app._driver)
        monkeypatch.setattr(driver, "ask", lambda _, text: asked.append(text), raising=False)
        monkeypatch.setattr(driver, "write", lambda _, text: written.append(text))
        monkeypatch.setattr(driver, "silence", 0.0, raising=False)
        monkeypatch.setattr(sparing, "ListeningDriver", driver)
        monkeypatch.setattr(sparing, "_PATIENCE", 0.001)
        game.app.refresh()
        await game.until(lambda: len(asked) == 1)
        game.app.post_message(events.CursorPosition(0, 0))
        await game.until(lambda: len(asked) == 2)
        # What the line is measured by is not answered, and nothing else happens.
        await game.until(lambda: not game.app._line._asked)

        # A restricted game asks a terminal that falls silent, draws no more, and then ends.
        before = signal.signal(signal.SIGHUP, lambda number, _: ended.append(number))
        try:
            game.app.watch_terminal()
            asked.clear()
            await game.until(lambda: asked)
            monkeypatch.setattr(driver, "silence", sparing._SILENT + 1)
            written.clear()
            game.app.redraw()
            await game.later(sparing._ASK_EVERY)
            assert not written
            assert not ended
            monkeypatch.setattr(driver, "silence", sparing._GONE + 1)
            await game.until(lambda: ended)
        finally:
            signal.signal(signal.SIGHUP, before)
        monkeypatch.setattr(driver, "silence", 0.0)
        game.app.redraw()
        await game.until(lambda: written)


async def test_a_mistake_in_the_reader_thread_ends_the_app(monkeypatch: pytest.MonkeyPatch) -> None:
    def take(*_: object) -> None:
        raise LookupError("made by a test")

    async def hear(terminal: int) -> None:
        app: App[None] = App()
        async with app.run_test():
            driver = ListeningDriver(app)
            driver.fileno = terminal
            await asyncio.to_thread(driver.run_input_thread)

    monkeypatch.setattr(InputFilter, "take", take)
    ours, theirs = os.pipe()
    os.write(theirs, b"n")
    with pytest.raises(LookupError, match="made by a test"):
        await hear(ours)
    os.close(ours)
    os.close(theirs)
