"""The tour, the first minute, the level screen, hints and versions; and what outlives a kill."""

from __future__ import annotations

import contextlib
import os
import re
import signal
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui import list_levels, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.progress import FILE_NAME, Progress
from tests.e2e.conftest import tick_on
from tests.waiting import until

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from tests.e2e.conftest import Player

    Seat = Callable[..., AbstractContextManager[Player]]

FIRST, SECOND = (load_level(name) for name in list_levels()[:2])


def record_of(player: Player) -> Progress:
    return Progress(player.folder / "data" / FILE_NAME)


def kill(player: Player) -> None:
    os.kill(player.tmux.game, signal.SIGKILL)
    until(lambda: not player.tmux.is_running)
    player.tmux.mend()


def start_anew(player: Player) -> None:
    """Start the game as somebody does who has played before."""
    player.play()
    player.tmux.wait_for("· applied")


def enter_editor(player: Player) -> None:
    player.tmux.press("2")
    player.tmux.wait_for("^R Apply  F5 Run")


def leave_editor(player: Player) -> None:
    player.tmux.press("Escape")
    player.tmux.wait_for("space Run")


def skip_the_tour(player: Player) -> None:
    player.tmux.wait_for("skip the tour", "· applied")
    player.tmux.press("Escape")
    player.tmux.wait_until(lambda screen: "skip the tour" not in screen, "no tour")


@pytest.mark.slow
@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=["80x24", "120x40"])
def test_the_tour_is_shown_at_the_first_start_and_never_again(
    seat: Seat, size: tuple[int, int]
) -> None:
    with seat(*size) as player:
        player.play()
        for number in (1, 2, 3, 4):
            player.tmux.wait_for(f"{number} of 4")
            player.tmux.press("Enter")
        player.tmux.wait_until(lambda screen: "4 of 4" not in screen, "no tour")
        until(lambda: record_of(player).fact("tour"))
        kill(player)
        start_anew(player)
        player.tmux.press("n")
        assert "skip the tour" not in player.wait_for_tick(1)


@pytest.mark.slow
def test_who_names_a_level_is_not_shown_round(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("n")
    assert "skip the tour" not in player.wait_for_tick(1)


@pytest.mark.slow
def test_in_the_first_minute_somebody_new_wins_by_doing_what_the_briefing_says(
    player: Player,
) -> None:
    asked = re.search(r'change "([^"]+)" to "([^"]+)"', FIRST.briefing.replace("\n", " "))
    assert asked
    before, after = asked.groups()
    lines = load_program(FIRST.starter).text.splitlines()
    row, line = next((row, line) for row, line in enumerate(lines) if before in line)
    player.play()
    skip_the_tour(player)
    player.tmux.wait_for("Try first")
    enter_editor(player)
    back = len(line) - line.index(before) - len(before)
    # From below, because lines above the rule wrap.
    up = ["C-End", *["Up"] * (len(lines) - row)]
    player.tmux.press(*up, "End", *["Left"] * back, *["BSpace"] * len(before))
    player.tmux.type(after)
    player.tmux.wait_for(after)
    player.tmux.press("C-r")
    player.tmux.wait_for("· applied")
    leave_editor(player)
    player.tmux.type("++++++")
    player.tmux.wait_for("flat out")
    player.tmux.press("Space")
    won = tick_on(player.tmux.wait_for("WON", "your best", "reference"))
    until(lambda: record_of(player).record(FIRST.name).bests.ticks == won)
    kill(player)
    start_anew(player)
    player.tmux.press("l")
    player.tmux.wait_for("★ won", f"{won:,} ticks")


@pytest.mark.slow
def test_levels_are_chosen_on_their_screen_and_the_last_one_is_where_one_goes_on(
    player: Player,
) -> None:
    player.play()
    skip_the_tour(player)
    player.tmux.press("l")
    player.tmux.wait_until(
        lambda screen: f"2 {SECOND.title}" in screen and ("▀" in screen or "▄" in screen),
        "a miniature",
    )
    player.tmux.press("Right", "Enter")
    player.tmux.wait_for(f"LOGICAL ROBOTS   {SECOND.title}")
    until(lambda: record_of(player).fact("level") == SECOND.name)
    kill(player)
    start_anew(player)
    player.tmux.wait_for(f"LOGICAL ROBOTS   {SECOND.title}")
    player.tmux.press("l")
    player.tmux.wait_for(f"▸ 2 {SECOND.title}")
    player.tmux.click(f"1 {FIRST.title}")
    player.tmux.wait_for(f"LOGICAL ROBOTS   {FIRST.title}")


@pytest.mark.slow
def test_hints_that_were_revealed_stay_so_after_a_kill(player: Player) -> None:
    player.play()
    skip_the_tour(player)
    player.tmux.press("h")
    player.tmux.wait_for("1. ")
    player.tmux.press("h")
    player.tmux.wait_for("2. ")
    until(lambda: record_of(player).record(FIRST.name).hints == 2)
    kill(player)
    start_anew(player)
    player.tmux.press("h")
    player.tmux.wait_for("2. ")


@pytest.mark.slow
def test_what_was_applied_is_there_after_a_kill_and_so_is_what_was_before(player: Player) -> None:
    player.play()
    skip_the_tour(player)
    enter_editor(player)
    for number in (1, 2):
        player.tmux.type(f"# idea {number}")
        player.tmux.press("Enter")
        player.tmux.wait_for(f"# idea {number}")
        player.tmux.press("C-r")
        until(lambda number=number: record_of(player).record(FIRST.name).versions == number)  # type: ignore[misc] # bound now
    kill(player)
    start_anew(player)
    enter_editor(player)
    assert "Continue" not in player.tmux.wait_for("# idea 2")
    leave_editor(player)
    player.tmux.press("v")
    player.tmux.wait_for("Earlier versions")
    player.tmux.press("Down", "Enter")
    player.tmux.wait_until(lambda screen: "Earlier versions" not in screen, "the game")
    enter_editor(player)
    assert "# idea 2" not in player.tmux.wait_for("# idea 1")
    leave_editor(player)
    player.tmux.press("x")
    player.tmux.wait_for("Put the starter program back?")
    player.tmux.press("y")
    player.tmux.press("2")
    player.tmux.wait_until(lambda screen: "# idea" not in screen, "the starter")


@pytest.mark.slow
def test_nothing_that_measures_survives_the_game(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("Space")
    player.tmux.wait_for("WON")
    kill(player)
    until(lambda: not measuring_processes(player))


def measuring_processes(player: Player) -> list[str]:
    """Processes that still measure with the player's copy of the game."""
    found = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            command = file.read_text("utf-8", "replace")
            if "game.measuring" in command and str(player.command.parent) in command:
                found.append(command)
    return found
