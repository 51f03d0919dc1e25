"""What the game sends while a terminal answers, and when it does not."""

from __future__ import annotations

import signal
import sys
from typing import TYPE_CHECKING

import pytest
from textual import events

from logical_robots_tui.tui.terminal import diff_app as sparing
from tests.terminal import Terminal
from tests.tui.conftest import opened
from tests.waiting import until

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.usefixtures("drawn_at_once")
async def test_what_is_sent_to_a_terminal_depends_on_its_answers(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    written: list[str] = []
    ended: list[int] = []
    async with opened(data_dir) as game:
        await game.ready()
        await game.later(1)
        driver = type(game.app._driver)
        monkeypatch.setattr(
            driver, "ask", lambda _, question: asked.append(question), raising=False
        )
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


SOON_GONE = """if True:
    import sys
    from logical_robots_tui.tui.terminal import diff_app
    diff_app._ASK_EVERY, diff_app._SILENT, diff_app._GONE = 0.2, 1.0, 3.0
    from logical_robots_tui import supervisor
    sys.exit(supervisor.main())
"""


@pytest.mark.slow
def test_a_terminal_that_falls_silent_ends_a_restricted_game_and_the_text_is_kept(
    tmp_path: Path,
) -> None:
    play = [sys.executable, "-c", SOON_GONE, "play", "01-first-steps", "--restricted"]
    with Terminal([*play, "--data-dir", tmp_path]) as terminal:
        terminal.wait_for("· applied")
        terminal.send("2# typed by ada")
        terminal.wait_for("not applied")
        until(lambda: terminal.process.poll() is not None)  # nothing is read, nothing answered
    drafts = [path.read_text() for path in tmp_path.rglob("drafts/*.json")]
    assert any("# typed by ada" in draft for draft in drafts)


DEAF = """if True:
    import signal, sys
    take = signal.signal
    signal.signal = lambda at, how: None if at == signal.SIGWINCH else take(at, how)
    from logical_robots_tui import supervisor
    sys.exit(supervisor.main())
"""


def test_a_size_whose_signal_was_lost_is_noticed(tmp_path: Path) -> None:
    play = [sys.executable, "-c", DEAF, "play", "01-first-steps", "--data-dir", tmp_path]
    with Terminal(play, size=(120, 40)) as terminal:
        terminal.wait_for("╭─ Inspector")
        terminal.resize(80, 24)
        terminal.wait_for(" 1 Map   2 Program")
