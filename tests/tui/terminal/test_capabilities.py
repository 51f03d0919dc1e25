"""Choosing a way of drawing for a terminal."""

import os
import re
import shutil
import subprocess
import sys
from io import BytesIO, TextIOWrapper
from pathlib import Path

import pytest

from logical_robots_tui.tui.labyrinth.drawing import Drawing
from logical_robots_tui.tui.terminal.capabilities import (
    assume_colours,
    drawing_for,
    may_use_mouse,
    replace_unwritable,
)
from tests.terminal import Terminal
from tests.waiting import PATIENCE


def test_the_drawing_suits_the_terminal() -> None:
    for term, colours, encoding, drawing in (
        ("xterm-256color", "truecolor", "utf-8", Drawing.QUADRANTS),
        ("tmux-256color", "256", "UTF-8", Drawing.QUADRANTS),
        ("linux", "256", "utf-8", Drawing.HALVES),
        ("xterm", "standard", "utf-8", Drawing.ASCII),
        ("xterm-256color", "256", "iso8859-1", Drawing.ASCII),
        ("dumb", None, "utf-8", Drawing.ASCII),
    ):
        assert drawing_for({"TERM": term}, colours, encoding, colourless=False) is drawing, term
        assert drawing_for({"TERM": term}, colours, encoding, colourless=True) is Drawing.ASCII


def colours_of(**environ: str) -> str | None:
    assume_colours(environ)
    return environ.get("COLORTERM")


def test_some_terminals_are_known_for_their_colours_and_gnu_screen_for_having_few() -> None:
    assert colours_of(TERM="xterm-kitty") == colours_of(TERM="foot") == "truecolor"
    assert colours_of(TERM="xterm-256color") is None
    assert colours_of(TERM="foot", COLORTERM="no") == "no", "what the environment says stands"
    for term in ("screen", "screen.alacritty", "screen-256color", "xterm-direct"):
        environ = {"TERM": term, "STY": "1.pts", "COLORTERM": "truecolor"}
        assert colours_of(**environ) is None, term
        assert colours_of(**environ, TMUX="x") == "truecolor", term


def test_the_mouse_is_left_alone_where_it_would_take_the_escape_key() -> None:
    tmux, screen = {"TMUX": "x"}, {"STY": "y"}
    for term, within, is_used in (
        *(("xterm-256color", {}, True), ("screen-256color", {}, True), ("screen", tmux, True)),
        *(("tmux-256color", tmux, True), ("tmux-256color", tmux | screen, True)),
        *(("screen-256color", screen, False), ("screen", tmux | screen, False)),
        *(("screen.xterm-256color", {}, False), ("screen", {}, False)),
    ):
        assert may_use_mouse({"TERM": term, **within}) is is_used, (term, within)
    assert may_use_mouse({})


LATIN = {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C", "LANG": "C"}
NO_KEY_PROTOCOL = {"TEXTUAL_DISABLE_KITTY_KEY": "1"}


def test_where_the_locale_is_not_utf_8_all_is_drawn_in_ascii_and_the_game_says_so(
    tmp_path: Path,
) -> None:
    command = [sys.executable, "-m", "logical_robots_tui", "play", "02-open-space"]
    with Terminal([*command, "--data-dir", tmp_path], env=LATIN | NO_KEY_PROTOCOL) as terminal:
        terminal.wait_for("This locale is not UTF-8")
        assert terminal.everything.isascii()
        assert "\\u" not in terminal.everything
        terminal.wait_for("| Bring Ada through")
        terminal.send("q")
        assert terminal.finish() == 0
        begun = re.findall(r"\x1b\[>\d+u", terminal.everything)
        assert terminal.everything.count("\x1b[<u") == len(begun), "ends of the key protocol"


@pytest.mark.parametrize(
    ("encoding", "written"),
    [("ascii", "-|+#<v.*?? e"), ("latin-1", "-|+#<v·*?? é"), ("utf-8", "─│┼█←▼·★漢 é")],
)
def test_what_an_encoding_lacks_is_written_as_wide_as_it_was(encoding: str, written: str) -> None:
    content = BytesIO()
    file = TextIOWrapper(content, encoding, errors="backslashreplace")
    replace_unwritable(file)
    file.write("─│┼█←▼·★漢 é")
    file.flush()
    assert content.getvalue().decode(encoding) == written


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
            terminal.send(" ", sees="RUNNING")
            terminal.send("q")
            assert terminal.finish() == 0
    finally:
        subprocess.run(["screen", "-S", "game", "-X", "quit"], env=env, timeout=PATIENCE)
