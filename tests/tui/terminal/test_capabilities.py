"""Choosing a way of drawing for a terminal."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.tui.labyrinth.drawing import Drawing
from logical_robots_tui.tui.terminal.capabilities import assume_colours, drawing_for, may_use_mouse
from tests.terminal import Terminal
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("term", "colours", "encoding", "drawing"),
    [
        ("xterm-256color", "truecolor", "utf-8", Drawing.QUADRANTS),
        ("tmux-256color", "256", "UTF-8", Drawing.QUADRANTS),
        ("linux", "256", "utf-8", Drawing.HALVES),
        ("xterm", "standard", "utf-8", Drawing.ASCII),
        ("xterm-256color", "256", "iso8859-1", Drawing.ASCII),
        ("dumb", None, "utf-8", Drawing.ASCII),
    ],
)
def test_the_drawing_suits_the_terminal(
    term: str, colours: str | None, encoding: str, drawing: Drawing
) -> None:
    assert drawing_for({"TERM": term}, colours, encoding, colourless=False) is drawing
    assert drawing_for({"TERM": term}, colours, encoding, colourless=True) is Drawing.ASCII


@pytest.mark.parametrize(
    ("term", "known"), [("xterm-kitty", True), ("foot", True), ("xterm-256color", False)]
)
def test_some_terminals_are_known_for_their_colours(term: str, known: bool) -> None:
    environ = {"TERM": term}
    assume_colours(environ)
    assert (environ.get("COLORTERM") == "truecolor") == known


def test_what_the_environment_says_of_colours_stands() -> None:
    environ = {"TERM": "foot", "COLORTERM": "no"}
    assume_colours(environ)
    assert environ["COLORTERM"] == "no"


@pytest.mark.parametrize("term", ["screen", "screen.alacritty", "screen-256color", "xterm-direct"])
def test_in_gnu_screen_there_is_no_true_colour(term: str) -> None:
    environ = {"TERM": term, "STY": "1.pts", "COLORTERM": "truecolor"}
    assume_colours(environ)
    assert "COLORTERM" not in environ
    environ |= {"TMUX": "x", "COLORTERM": "truecolor"}
    assume_colours(environ)
    assert environ["COLORTERM"] == "truecolor"


@pytest.mark.parametrize(
    ("environ", "used"),
    [
        ({"TERM": "xterm-256color"}, True),
        ({"TERM": "tmux-256color", "TMUX": "x"}, True),
        ({"TERM": "tmux-256color", "TMUX": "x", "STY": "y"}, True),
        ({"TERM": "screen", "TMUX": "x"}, True),
        ({"TERM": "screen-256color"}, True),
        ({"TERM": "screen-256color", "STY": "y"}, False),
        ({"TERM": "screen", "STY": "y", "TMUX": "x"}, False),
        ({"TERM": "screen.xterm-256color"}, False),
        ({"TERM": "screen"}, False),
        ({}, True),
    ],
)
def test_the_mouse_is_left_alone_where_it_would_take_the_escape_key(
    environ: dict[str, str], used: bool
) -> None:
    assert may_use_mouse(environ) == used


@pytest.mark.skipif(
    shutil.which("screen") is None and "CI" not in os.environ, reason="GNU screen is not installed"
)
def test_all_keys_work_in_gnu_screen(tmp_path: Path) -> None:
    sockets = tmp_path / "sockets"
    sockets.mkdir(mode=0o700)
    env = {**os.environ, "SCREENDIR": str(sockets)}
    game = [sys.executable, "-m", "logical_robots_tui", "play", "--data-dir", tmp_path]
    try:
        with Terminal(["screen", "-U", "-m", "-S", "game", *game], env=env) as terminal:
            terminal.wait_for("skip the tour")
            terminal.wait_for("· applied")
            terminal.send("\x1b")
            terminal.wait_for(lambda: "skip the tour" not in terminal.text)
            for key, shown in (("n", "tick 1 "), ("n", "tick 2 "), ("p", "tick 1 ")):
                terminal.send(key)
                terminal.wait_for(shown)
            terminal.send(" ")
            terminal.wait_for("RUNNING")
            terminal.send("q")
            assert terminal.finish() == 0
    finally:
        subprocess.run(
            ["screen", "-S", "game", "-X", "quit"], env=env, check=False, timeout=PATIENCE
        )


@pytest.mark.sampled
@pytest.mark.parametrize(
    "env",
    [
        {"NO_COLOR": "1"},
        {"TERM": "xterm", "COLORTERM": ""},
        {"TERM": "xterm-256color", "COLORTERM": ""},
    ],
    ids=["none", "16", "256"],
)
def test_the_game_plays_in_fewer_colours(env: dict[str, str], tmp_path: Path) -> None:
    game = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps", "first-steps"]
    with Terminal([*game, "--data-dir", tmp_path], size=(80, 24), env=env) as terminal:
        terminal.wait_for("applied")
        terminal.send(" ")
        terminal.wait_for("tick 1")
        colours = re.findall(r"38;2;(\d+);(\d+);(\d+)", terminal.everything)
        assert all(red == green == blue for red, green, blue in colours)
        assert ("##" in terminal.text) == (env.get("TERM") != "xterm-256color")
