"""The installed game, played in a real terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from logical_robots_tui import list_levels, load_level
from tests.e2e.conftest import tick_on
from tests.e2e.tmux import PROMPT
from tests.short import AHEAD
from tests.waiting import until

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from tests.e2e.conftest import Player

    Seat = Callable[..., AbstractContextManager[Player]]


@pytest.mark.slow
@pytest.mark.parametrize("size", [(80, 24), (120, 40)], ids=["80x24", "120x40"])
def test_the_first_level_opens_with_a_program_that_is_ready(
    size: tuple[int, int], seat: Seat
) -> None:
    with seat(*size) as player:
        player.play()
        title = load_level(list_levels()[0]).title
        screen = player.tmux.wait_for(title, "PAUSED", "tick 0", "· applied")
        assert len(screen.splitlines()) <= size[1]
        assert "▄" in screen or "▀" in screen


def test_a_level_is_played_from_start_to_victory(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("Space")
    screen = player.tmux.wait_until(
        lambda screen: "WON" in screen and f"{tick_on(screen)} ticks" in screen, "the victory"
    )
    assert 40 < tick_on(screen) < 60


@pytest.mark.slow
def test_running_moves_on_and_pausing_stands_still(player: Player) -> None:
    nowhere = AHEAD.replace("0.5", "0")
    (player.folder / "ahead.l").write_text(nowhere)
    player.play_short_way()
    player.tmux.press("Space")
    player.tmux.wait_until(lambda screen: "RUNNING" in screen and tick_on(screen) >= 3, "tick 3")
    player.tmux.press("Space")
    paused = tick_on(player.tmux.wait_for("PAUSED"))
    player.tmux.press("n")
    player.wait_for_tick(paused + 1)


@pytest.mark.slow
def test_stepping_goes_forward_and_back_one_tick_at_a_time(player: Player) -> None:
    player.play_short_way()
    for number in (1, 2, 3):
        player.tmux.press("n")
        player.wait_for_tick(number)
    player.tmux.press("p")
    player.wait_for_tick(2)


@pytest.mark.slow
def test_restarting_begins_at_tick_0(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("n")
    player.wait_for_tick(1)
    player.tmux.press("r")
    player.wait_for_tick(0)


@pytest.mark.slow
def test_another_level_can_be_chosen(player: Player) -> None:
    player.play_short_way()
    title = load_level(list_levels()[1]).title
    player.tmux.press("l")
    player.tmux.wait_for(title)
    player.tmux.type(title)
    player.tmux.press("Enter")
    player.tmux.wait_until(
        lambda screen: title in screen.splitlines()[0] and "A short way" not in screen, title
    )


@pytest.mark.slow
def test_nonsense_gets_a_message_in_place_and_the_last_good_program_goes_on(
    player: Player,
) -> None:
    player.play_short_way()
    player.tmux.press("2")
    player.tmux.type("nonsense(")
    player.tmux.wait_for("nonsense(")
    player.tmux.press("C-r")
    player.tmux.wait_for("line 1, column")
    player.tmux.press("F5")
    player.tmux.wait_for("WON")


@pytest.mark.slow
def test_a_program_pasted_and_applied_is_what_the_robots_think(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("2")
    player.tmux.press("C-End")
    player.tmux.paste('\n# pasted\nThought(robot_name:, idea: "left") :- Sensor(robot_name:);\n')
    player.tmux.wait_for("# pasted")
    player.tmux.press("C-r")
    player.tmux.wait_for("· applied")
    player.tmux.press("Escape")
    player.tmux.press("3")
    player.tmux.wait_for("Thought")


@pytest.mark.slow
def test_the_mouse_presses_what_it_points_at(player: Player) -> None:
    player.play_short_way()
    player.tmux.click("Step")
    player.wait_for_tick(1)


@pytest.mark.slow
def test_a_tiny_terminal_is_told_and_a_larger_one_has_the_game_again(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("n")
    player.wait_for_tick(1)
    player.tmux.resize(20, 5)
    player.tmux.wait_for("20x5")
    player.tmux.resize(120, 40)
    player.wait_for_tick(1)
    player.tmux.wait_for("Inspector")


@pytest.mark.slow
def test_quitting_gives_the_shell_back(player: Player) -> None:
    player.play_short_way()
    player.tmux.press("q")
    player.tmux.wait_until(lambda screen: screen.rstrip().endswith(PROMPT.strip()), "the prompt")
    until(lambda: not player.tmux.is_running)
    player.tmux.type("echo a$((20+22))b")
    player.tmux.press("Enter")
    player.tmux.wait_for("a42b")
