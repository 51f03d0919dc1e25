"""The timeline in a real terminal, by key and by mouse."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tests.e2e.conftest import Player


def timeline(screen: str) -> str:
    """The line above the command bar."""
    return screen.splitlines()[22]


@pytest.mark.slow
def test_the_timeline_is_clicked_dragged_and_driven_with_keys(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("U")
    player.tmux.wait_for("Run until tick")
    player.tmux.type("30")
    player.tmux.press("Enter")
    player.wait_for_tick(30)
    player.tmux.wait_for("tick 30 of 30")
    player.tmux.drag((12, 23), (22, 23))
    player.wait_for_tick(20)
    player.tmux.press("P")
    player.wait_for_tick(10)
    player.tmux.type(")")
    player.wait_for_tick(30)
    player.tmux.type("(")
    player.wait_for_tick(0)
    player.tmux.press("T")
    player.tmux.press("End")
    player.wait_for_tick(30)
    player.tmux.press("PageUp")
    player.wait_for_tick(20)
    player.tmux.press("g")
    player.tmux.wait_for("Go to tick")
    player.tmux.type("99")
    player.tmux.press("Enter")
    player.tmux.wait_for("The history holds ticks 0 to 30, not 99.")


@pytest.mark.slow
def test_a_changed_program_leaves_the_old_future_in_sight(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("N")
    player.wait_for_tick(10)
    player.tmux.type("(")
    player.wait_for_tick(0)
    player.tmux.press("2")
    player.tmux.paste("# another\nTwo(x: 1) :- Sensor();\n")
    player.tmux.wait_for("# another")
    player.tmux.press("C-r")
    player.tmux.wait_for("· applied")
    player.tmux.press("Escape")
    player.tmux.wait_for("space Run")
    player.tmux.press("n")
    player.wait_for_tick(1)
    player.tmux.wait_until(lambda screen: "┄┄┄" in timeline(screen), "the old future")
    player.tmux.press("C")
    player.tmux.wait_for("The two branches are equal as far as both")
    player.tmux.press("F")
    player.tmux.type(")")
    player.wait_for_tick(10)


@pytest.mark.slow
def test_a_run_stops_at_a_breakpoint(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("B")
    player.tmux.wait_for("a add ")
    player.tmux.press("a")
    player.tmux.wait_for("a robot enters an area")
    for _ in range(3):
        player.tmux.press("Down")
    player.tmux.press("Enter")
    player.tmux.wait_for("enter set")
    player.tmux.type("Door")
    player.tmux.press("Enter")
    player.tmux.wait_for("◉ a robot enters Door")
    player.tmux.press("Escape")
    player.tmux.wait_until(lambda screen: "─ Breakpoints" not in screen, "no dialog")
    player.tmux.press("Space")
    player.tmux.wait_for("a robot enters Door: Pip is in Door")
