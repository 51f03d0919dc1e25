"""What was typed outlives a killed process and a lost terminal, one after the other."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from contextlib import AbstractContextManager

import pytest

from tests.e2e.conftest import TYPED, Player
from tests.waiting import until

SLOW = """\
N(x) :- x in Range(3000);
Big(s? += a * b) distinct :- N(a), N(b), N(c);
Robot(robot_name:, desire: {left_engine: s, right_engine: 0}, memory: 1) :-
  Sensor(robot_name:), Big(s:);
"""


@pytest.mark.slow
def test_the_text_is_offered_when_the_process_was_killed_and_when_the_terminal_was_gone(
    seat: Callable[..., AbstractContextManager[Player]],
) -> None:
    with seat() as player:
        player.play_short_way()
        player.type_an_idea()
        until(lambda: any(TYPED in f.read_text() for f in player.folder.rglob("data/**/*.json")))
        os.kill(player.tmux.game, signal.SIGKILL)
        until(lambda: not player.tmux.is_running)
        player.tmux.mend()
        player.is_offered_the_idea()
        player.tmux.close()
        until(lambda: not player.tmux.is_running, lambda: "the process ends")
    with seat() as player:
        player.is_offered_the_idea()


@pytest.mark.slow
def test_a_hangup_ends_even_a_robot_that_is_deep_in_thought(player: Player) -> None:
    (player.folder / "ahead.l").write_text(SLOW)
    player.play_short_way()
    player.tmux.press("Space", sees="thinking")
    player.tmux.hang_up()
    until(lambda: not player.tmux.is_running, lambda: "the process ends")
