"""``logical-robots play``: opening the game, or saying why not."""

import sys
from pathlib import Path

import pytest

from tests.cli.running import Command, in_terminal
from tests.terminal import Terminal


def test_the_size_is_the_terminals_and_it_comes_back(
    level: Path, ahead: Path, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "logical_robots_tui", "play", level, ahead]
    exported = {"COLUMNS": "30", "LINES": "8"}
    with Terminal([*command, "--data-dir", tmp_path], size=(120, 40), env=exported) as terminal:
        terminal.wait_for("tick 0")
        terminal.wait_for(lambda: "Quit" in terminal.screen.display[-1])
        terminal.wait_for("· applied")
        terminal.send("q")
        assert terminal.finish() == 0
    entered, left = (terminal.everything.rfind(f"\x1b[?1049{how}") for how in "hl")
    assert 0 <= entered < left


def test_what_can_not_be_opened_is_told_after_the_prompt_and_not_in_the_game(ahead: Path) -> None:
    with in_terminal("play", "nowhere.toml", ahead) as terminal:
        assert terminal.finish() == 2
    assert terminal.text.startswith("logical-robots: nowhere.toml: ")
    assert "\x1b[?1049h" not in terminal.everything


def test_the_labyrinth_of_a_day_is_played(command: Command) -> None:
    words = ("play", "--daily", "2026-11-22", "--size", "small", "--plain")
    assert command(*words, typed=("where",)).success.startswith("Labyrinth of 2026-11-22, small\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--daily", "yesterday"), "'yesterday' is not a date such as 2026-11-22"),
        (("a-level", "a-program", "--daily"), "--daily chooses the level"),
        (("--size", "huge"), "invalid choice: 'huge'"),
    ],
)
def test_a_labyrinth_that_can_not_be_played_is_told(
    words: tuple[str, ...], message: str, command: Command
) -> None:
    assert message in command("play", *words, "--plain").refusal
