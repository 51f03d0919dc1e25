"""Editing a level in a real terminal, with the mouse."""

from __future__ import annotations

import pytest

from logical_robots_tui.world import load_level
from tests.e2e.conftest import Player
from tests.e2e.tmux import place_of
from tests.waiting import until


@pytest.mark.slow
def test_a_level_is_edited_with_the_mouse_saved_and_survives_a_hangup(player: Player) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.press("M", sees="h Hand")
    tmux.click("b Brush")
    tmux.wait_for("units wide")
    tmux.drag((30, 8), (30, 18))
    tmux.wait_for("● not saved", "finding")
    tmux.press("s", sees="Saved as short")
    walls = load_level(player.folder / "short.toml").walls
    assert walls[10:15, 15:45].any()
    tmux.press("h", "Tab")
    column, line = place_of("+", tmux.wait_for("Robot Pip at 12, 12.5", "+"))
    tmux.drag((column, line), (column + 8, line))
    tmux.wait_until(lambda screen: "Robot Pip at" in screen and "at 12, " not in screen)
    tmux.wait_for("● not saved")
    drafts = player.folder / "data" / "drafts"
    until(lambda: list(drafts.glob("*.json")), lambda: "a draft on disk")
    tmux.hang_up()
    until(lambda: not tmux.is_running, lambda: "the game has ended")
    tmux.mend()
    player.play("play", "short.toml", "ahead.l")
    tmux.wait_for("Continue editing the level", "Yes, continue")
    tmux.press("y", sees="● not saved")
    tmux.press("Escape", sees="What should happen to your changes")
    tmux.press("t", sees="q Quit")
