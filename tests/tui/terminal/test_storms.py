"""A window that is dragged to any size, and a mouse that reports any place: the game goes on."""

import sys
import tempfile
from typing import TypeAlias

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.terminal import Terminal

SIZE = (100, 30)
ONE_FRAME = 0.02  # seconds, so that a size finds a picture half drawn
Event: TypeAlias = "tuple[int, int] | str"  # a size, or what a terminal sends

sizes = st.tuples(st.integers(1, 240), st.integers(1, 80))
places = st.one_of(st.integers(0, 130), st.integers(0, 70_000))
mouse = st.builds(
    "\x1b[<{};{};{}{}".format,
    st.sampled_from([0, 1, 2, 3, 4, 8, 16, 32, 34, 35, 48, 64, 65, 66, 67, 128, 255]),
    *(places, places, st.sampled_from("Mm")),
)
keys = st.sampled_from([" ", "n", "p", "1", "2", "3", "?", "\t", "\x1b[A", "\x1b[B", "+", "b"])
storms = st.one_of(
    st.lists(sizes, min_size=60, max_size=60),
    st.lists(mouse, min_size=200, max_size=200),
    st.lists(st.one_of(sizes, mouse, keys), min_size=20, max_size=100),
)


def goes_through(terminal: Terminal, storm: list[Event]) -> bool:
    """Whether the game is still there after a storm, and draws; otherwise it was told to quit."""
    try:
        for event in storm:
            if isinstance(event, str):
                terminal.send(event)
                terminal.read_for(0.0)
            else:
                terminal.resize(*event)
                terminal.read_for(ONE_FRAME)
        for size in (120, 40), SIZE:
            before = terminal.traffic
            terminal.resize(*size)
            terminal.wait_for(lambda before=before: terminal.traffic > before)  # type: ignore[misc]  # a default
    except (AssertionError, OSError, ValueError):
        assert terminal.process.wait(terminal.patience) == 0, terminal.everything[-2000:]
        return False
    return True


@pytest.mark.slow  # `test_small.py` and `test_layout.py` do it without a terminal
@settings(max_examples=max(3, settings().max_examples // 4))
@given(storm=storms)
def test_no_size_and_no_place_ends_the_game(storm: list[Event]) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "04-everybody-home"]
    with (
        tempfile.TemporaryDirectory() as folder,
        Terminal([*game, "--data-dir", folder], size=SIZE, env={"EDITOR": "true"}) as terminal,
    ):
        terminal.wait_for("· applied")
        terminal.send(" ", sees="RUNNING")
        if goes_through(terminal, storm):
            terminal.press_until("\x1b?", lambda: "letters filter" in terminal.text)
