"""What the driver sends while a terminal answers, and when it does not, and what it hears."""

import asyncio
import os
import signal
import sys
from pathlib import Path
from time import monotonic
from typing import Self

import pytest
from textual import events
from textual._compositor import Compositor
from textual.app import App

from logical_robots_tui.tui.terminal import diff_app as sparing
from logical_robots_tui.tui.terminal.driver import InputFilter, TerminalDriver
from tests.terminal import Terminal
from tests.tui.conftest import opened

DRAW_AT_ONCE = Compositor.render_update  # a quick run draws later


async def test_answers_decide_what_is_sent(data_dir: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Compositor, "render_update", DRAW_AT_ONCE)
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
        await game.until(lambda: not game.app._line._queries)

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


class LateTerminal(Terminal):
    """Answers long after it was asked."""

    SECONDS = 1.5

    def __enter__(self) -> Self:
        self._due: list[float] = []
        return super().__enter__()

    def _read(self, deadline: float) -> bool:
        soon = min([deadline, *self._due[:1]])
        is_open = super()._read(soon)
        while self._due and self._due[0] <= monotonic():
            del self._due[0]
            super().send("\x1b[1;1R")
        return is_open

    def send(self, keys: str, sees: str = "") -> None:
        answers = keys.count("\x1b[1;1R")
        self._due += [monotonic() + self.SECONDS] * answers
        if keys and not answers:
            super().send(keys, sees)


AFTERWARDS = "stty raw -echo min 0 time 30; echo left $(dd bs=99 count=1 2>/dev/null | od -An -c) ;"


@pytest.mark.slow
@pytest.mark.parametrize("seen", ["Open space", "tick 40"])
def test_answers_that_come_late_are_not_left_for_the_shell(seen: str, tmp_path: Path) -> None:
    play = f"{sys.executable} -m logical_robots_tui play 02-open-space --data-dir {tmp_path}"
    with LateTerminal(["sh", "-c", f"{play}; {AFTERWARDS}"]) as terminal:
        terminal.wait_for("Open space")
        terminal.send(" ", seen)
        terminal.send("q")
        terminal.finish()
        assert terminal.everything.rpartition("left")[2].strip() == ""


async def test_a_mistake_in_the_reader_thread_ends_the_app(monkeypatch: pytest.MonkeyPatch) -> None:
    def take(*_: object) -> None:
        raise LookupError("made by a test")

    async def hear(terminal: int) -> None:
        app: App[None] = App()
        async with app.run_test():
            driver = TerminalDriver(app)
            driver.fileno = terminal
            await asyncio.to_thread(driver.run_input_thread)

    monkeypatch.setattr(InputFilter, "take", take)
    ours, theirs = os.pipe()
    os.write(theirs, b"n")
    with pytest.raises(LookupError, match="made by a test"):
        await hear(ours)
    os.close(ours)
    os.close(theirs)
