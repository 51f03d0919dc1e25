"""What was typed outlives a hangup, a killed process and a lost terminal."""

from __future__ import annotations

import os
import signal
from functools import partial
from typing import TYPE_CHECKING

import pytest

from tests.waiting import until

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from tests.e2e.conftest import Player

    Seat = Callable[..., AbstractContextManager[Player]]

SLOW = """\
N(x) :- x in Range(3000);
Big(s? += a * b) distinct :- N(a), N(b), N(c);
Robot(robot_name:, desire: {left_engine: s, right_engine: 0}, memory: 1) :-
  Sensor(robot_name:), Big(s:);
"""
TYPED = "# an idea worth keeping"


def type_an_idea(player: Player) -> None:
    player.tmux.press("2")
    player.tmux.type(TYPED)
    player.tmux.wait_for(TYPED)
    player.tmux.press("Enter")


def is_gone(text: str, screen: str) -> bool:
    return text not in screen


def assert_the_idea_is_offered(player: Player, *others: str) -> None:
    player.play("play", "short.toml", "ahead.l")
    for offer in ("unsaved", *others):
        player.tmux.wait_for(offer, "Yes, continue")
        player.tmux.press("Enter")
        player.tmux.wait_until(partial(is_gone, offer))
    player.tmux.press("2")
    player.tmux.wait_for(TYPED)


def test_after_a_hangup_the_process_ends_and_the_game_goes_on_exactly_there(
    player: Player,
) -> None:
    player.play_short_way()
    player.tmux.press("n", "n", "n")
    player.wait_for_tick(3)
    type_an_idea(player)
    player.tmux.hang_up()
    until(lambda: not player.tmux.is_running, lambda: "the process ends")
    player.tmux.mend()
    assert_the_idea_is_offered(player, "cut off at tick 3")
    player.wait_for_tick(3)


@pytest.mark.slow
def test_when_the_terminal_is_gone_the_process_ends_and_the_text_is_offered(seat: Seat) -> None:
    with seat() as player:
        player.play_short_way()
        type_an_idea(player)
        player.tmux.close()
        until(lambda: not player.tmux.is_running, lambda: "the process ends")
    with seat() as player:
        assert_the_idea_is_offered(player)


@pytest.mark.slow
def test_when_the_process_is_killed_what_was_on_disk_a_moment_ago_is_offered(
    player: Player,
) -> None:
    player.play_short_way()
    type_an_idea(player)
    until(lambda: any(TYPED in f.read_text() for f in player.folder.rglob("data/**/*.json")))
    os.kill(player.tmux.game, signal.SIGKILL)
    until(lambda: not player.tmux.is_running)
    player.tmux.mend()
    assert_the_idea_is_offered(player)


@pytest.mark.slow
def test_a_hangup_ends_even_a_robot_that_is_deep_in_thought(player: Player) -> None:
    (player.folder / "ahead.l").write_text(SLOW)
    player.play_short_way()
    player.tmux.press("Space")
    player.tmux.wait_for("thinking")
    player.tmux.hang_up()
    until(lambda: not player.tmux.is_running, lambda: "the process ends")
