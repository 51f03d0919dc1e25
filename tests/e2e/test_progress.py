"""The tour, the first minute, the level screen, hints and versions; and what outlives a kill."""

import os
import re
import signal
from time import monotonic

import pytest

from logical_robots_tui import list_levels, load_level
from logical_robots_tui.game import load_program
from logical_robots_tui.progress import FILE_NAME, Progress
from tests.e2e.conftest import Player, Seat, tick_on
from tests.waiting import until

FIRST, SECOND = (load_level(name) for name in list_levels()[:2])


def record_of(player: Player) -> Progress:
    return Progress(player.folder / "data" / FILE_NAME)


def kill(player: Player) -> None:
    os.kill(player.tmux.game, signal.SIGKILL)
    until(lambda: not player.tmux.is_running)
    player.tmux.mend()


def start_anew(player: Player) -> None:
    player.play()
    player.tmux.wait_for("· applied")


def enter_editor(player: Player) -> None:
    player.tmux.press("2", sees="^R Apply  F5 Run")


def leave_editor(player: Player) -> None:
    player.tmux.press("Escape", sees="space Run")


def skip_the_tour(player: Player) -> None:
    player.tmux.wait_for("skip the tour", "· applied")
    player.tmux.press("Escape", sees_no="skip the tour")


@pytest.mark.slow
@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=["80x24", "120x40"])
def test_the_first_start_shows_the_tour_and_a_level(seat: Seat, size: tuple[int, int]) -> None:
    with seat(*size) as player:
        player.play()
        screen = player.tmux.wait_for(FIRST.title, "PAUSED", "tick 0", "· applied")
        assert len(screen.splitlines()) <= size[1]
        assert "▄" in screen or "▀" in screen
        for number in (1, 2, 3, 4):
            player.tmux.wait_for(f"{number} of 4")
            player.tmux.press("Enter")
        player.tmux.wait_for_no("4 of 4")
        until(lambda: record_of(player).fact("tour"))
        kill(player)
        start_anew(player)
        player.tmux.press("n")
        assert "skip the tour" not in player.wait_for_tick(1)


@pytest.mark.slow
def test_in_the_first_minute_somebody_new_wins_by_what_the_briefing_says(player: Player) -> None:
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
    player.tmux.type(after, sees=after)
    player.tmux.press("C-r", sees="· applied")
    leave_editor(player)
    player.tmux.type("++++++", sees="flat out")
    player.tmux.press("Space")
    won = tick_on(player.tmux.wait_for("WON", "your best", "reference"))
    until(lambda: record_of(player).record(FIRST.name).bests.ticks == won)
    kill(player)
    start_anew(player)
    player.tmux.press("l")
    player.tmux.wait_for("★ won", f"{won:,} ticks")


@pytest.mark.slow
def test_hints_what_was_applied_and_the_last_level_are_there_after_a_kill(player: Player) -> None:
    tmux = player.tmux
    player.play()
    skip_the_tour(player)
    tmux.press("h", sees="1. ")
    pause_until = monotonic() + 1.1
    until(lambda: monotonic() > pause_until)
    tmux.press("h", sees="2. ")
    until(lambda: record_of(player).record(FIRST.name).hints == 2)
    tmux.press("Escape", sees_no="2. ")
    enter_editor(player)
    for number in (1, 2):
        tmux.type(f"# idea {number}")
        tmux.press("Enter", sees=f"# idea {number}")
        tmux.press("C-r")
        until(lambda number=number: record_of(player).record(FIRST.name).versions == number)  # type: ignore[misc] # bound now
    until(lambda: any("# idea 2\\n" in f.read_text() for f in player.folder.rglob("drafts/*.json")))
    kill(player)

    start_anew(player)
    tmux.press("h", sees="2. ")
    tmux.press("Escape", sees_no="2. ")
    enter_editor(player)
    assert "Continue" not in tmux.wait_for("# idea 2")
    leave_editor(player)
    tmux.press("v", sees="Earlier versions")
    tmux.press("Down", "Enter", sees_no="Earlier versions")
    enter_editor(player)
    assert "# idea 2" not in tmux.wait_for("# idea 1")
    leave_editor(player)
    tmux.press("l", sees=f"2 {SECOND.title}")
    tmux.press("Right", "Enter", sees=f"LOGICAL ROBOTS   {SECOND.title}")
    until(lambda: record_of(player).fact("level") == SECOND.name)
    kill(player)

    start_anew(player)
    tmux.wait_for(f"LOGICAL ROBOTS   {SECOND.title}")
