"""The timeline in a real terminal, by key and by mouse."""

from __future__ import annotations

import pytest

from tests.e2e.conftest import Player


def timeline(screen: str) -> str:
    """The line above the command bar."""
    return screen.splitlines()[22]


@pytest.mark.slow
def test_the_timeline_is_clicked_dragged_and_driven_with_keys_and_shows_an_old_future(
    player: Player,
) -> None:
    tmux = player.tmux
    player.play_short_way()
    tmux.press("U")
    tmux.wait_for("Run until tick")
    tmux.type("30")
    tmux.press("Enter")
    player.wait_for_tick(30)
    tmux.wait_for("tick 30 of 30")
    tmux.drag((12, 23), (22, 23))
    player.wait_for_tick(20)
    tmux.press("P")
    player.wait_for_tick(10)
    tmux.press("N")
    player.wait_for_tick(20)
    tmux.type(")")
    player.wait_for_tick(30)
    tmux.type("(")
    player.wait_for_tick(0)
    tmux.press("T")
    tmux.press("End")
    player.wait_for_tick(30)
    tmux.press("PageUp")
    player.wait_for_tick(20)
    tmux.press("g")
    tmux.wait_for("Go to tick")
    tmux.type("99")
    tmux.press("Enter")
    tmux.wait_for("The history holds ticks 0 to 30, not 99.")

    tmux.press("Escape")
    tmux.wait_for_no("Go to tick")
    tmux.type("(")
    player.wait_for_tick(0)
    tmux.press("2")
    tmux.paste("# another\nTwo(x: 1) :- Sensor();\n")
    tmux.wait_for("# another")
    tmux.press("C-r")
    tmux.wait_for("· applied")
    tmux.press("Escape")
    tmux.wait_for("space Run")
    tmux.press("n")
    player.wait_for_tick(1)
    tmux.wait_until(lambda screen: "┄┄┄" in timeline(screen), "the old future")
    tmux.press("C")
    tmux.wait_for("The two branches are equal as far as both")
    tmux.press("F")
    tmux.type(")")
    player.wait_for_tick(30)


@pytest.mark.slow
def test_a_run_stops_at_a_breakpoint(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("B")
    player.tmux.wait_for("a add ")
    player.tmux.press("a")
    player.tmux.wait_for("a robot enters an area")
    player.tmux.press("Down", "Down", "Down", "Enter")
    player.tmux.wait_for("enter set")
    player.tmux.type("Door")
    player.tmux.press("Enter")
    player.tmux.wait_for("◉ a robot enters Door")
    player.tmux.press("Escape")
    player.tmux.wait_for_no("─ Breakpoints")
    player.tmux.press("Space")
    player.tmux.wait_for("a robot enters Door: Pip is in Door")
