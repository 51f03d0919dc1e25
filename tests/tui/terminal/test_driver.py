"""What the game sends while a terminal answers, and when it does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from textual import events

from logical_robots_tui.tui.terminal import diff_app as sparing
from tests.tui.conftest import opened

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.usefixtures("drawn_at_once")
async def test_what_waits_for_the_line_to_be_measured_is_sent_without_an_answer(
    data_dir: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    async with opened(data_dir) as game:
        await game.ready()
        await game.later(1)
        driver = type(game.app._driver)
        monkeypatch.setattr(
            driver, "ask", lambda _, question: asked.append(question), raising=False
        )
        monkeypatch.setattr(sparing, "ListeningDriver", driver)
        monkeypatch.setattr(sparing, "_PATIENCE", 0.001)
        game.app.refresh()
        await game.until(lambda: len(asked) == 1)
        game.app.post_message(events.CursorPosition(0, 0))
        await game.until(lambda: len(asked) == 2)
        # What the line is measured by is not answered, and nothing else happens.
        await game.until(lambda: not game.app._line._asked)
