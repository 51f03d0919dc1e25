"""The timeline in a real terminal, by key and by mouse."""

from __future__ import annotations

import pytest

from tests.e2e.conftest import Player


def timeline(screen: str) -> str:
    """The line above the command bar."""
    return screen.splitlines()[22]


@pytest.mark.slow
def test_the_timeline_is_dragged_driven_with_keys_and_shows_an_old_future(player: Player) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.press("U", sees="Run until tick")
    tmux.type("30")
    player.press("Enter", tick=30)
    tmux.wait_for("tick 30 of 30")
    tmux.drag((12, 23), (22, 23))
    player.wait_for_tick(20)
    player.press("P", tick=10)
    player.press("N", tick=20)
    player.press(")", tick=30)
    player.press("(", tick=0)
    tmux.press("T")
    player.press("End", tick=30)
    player.press("PageUp", tick=20)
    tmux.press("g", sees="Go to tick")
    tmux.type("99")
    tmux.press("Enter", sees="The history holds ticks 0 to 30, not 99.")

    tmux.press("Escape", sees_no="Go to tick")
    player.press("(", tick=0)
    tmux.press("2")
    tmux.paste("# another\nTwo(x: 1) :- Sensor();\n")
    tmux.wait_for("# another")
    tmux.press("C-r", sees="· applied")
    tmux.press("Escape", sees="space Run")
    player.press("n", tick=1)
    tmux.wait_until(lambda screen: "┄┄┄" in timeline(screen), "the old future")
    tmux.press("C", sees="The two branches are equal as far as both")
    tmux.press("F")
    player.press(")", tick=30)


@pytest.mark.slow
def test_a_run_stops_at_a_breakpoint(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("B", sees="a add ")
    player.tmux.press("a", sees="a robot enters an area")
    player.tmux.press("Down", "Down", "Down", "Enter", sees="enter set")
    player.tmux.type("Door")
    player.tmux.press("Enter", sees="◉ a robot enters Door")
    player.tmux.press("Escape", sees_no="─ Breakpoints")
    player.tmux.press("Space", sees="a robot enters Door: Pip is in Door")
