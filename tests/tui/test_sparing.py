"""The game in a real terminal shows the same whether it sends all cells or those that changed."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from tests.terminal import Terminal, looks

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
def test_after_play_typing_and_dialogs_a_redraw_changes_nothing(
    size: tuple[int, int], tmp_path: Path
) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "07-station-management"]
    with Terminal([*game, "station-management", "--data-dir", tmp_path], size=size) as terminal:
        terminal.wait_for("applied")
        terminal.send(" ")
        terminal.wait_for(lambda: "RUNNING" in terminal.text and "tick 2" in terminal.text)
        terminal.send("?")
        terminal.wait_for("esc close")
        terminal.send("\x1b")
        terminal.wait_for(lambda: "esc close" not in terminal.text)
        terminal.send(" ")
        terminal.wait_for("PAUSED")
        terminal.send("2hello\x1b")
        terminal.wait_for("edited")
        terminal.wait_for_quiet()
        shown, before = looks(terminal.screen), terminal.traffic
        terminal.send("\x0c")
        terminal.wait_for(lambda: terminal.traffic > before + 2000)
        terminal.wait_for_quiet()
        assert looks(terminal.screen) == shown


def test_a_paused_game_sends_nothing(tmp_path: Path) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "first-steps"]
    with Terminal([*game, "--data-dir", tmp_path], size=(80, 24)) as terminal:
        terminal.wait_for("· applied")
        terminal.wait_for_quiet(3)
        before = terminal.traffic
        terminal.read_for(1.5)
        assert terminal.traffic == before
