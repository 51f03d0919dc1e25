"""The outline that stands before the screen: it is what the first picture has in its place."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pyte
import pytest

from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.progress.glance import fact_in
from logical_robots_tui.tui.outline import ENTER, LEAVE, colours_of, drawn
from logical_robots_tui.tui.places import THEME
from tests.terminal import Terminal, looks

if TYPE_CHECKING:
    from pathlib import Path

TERM = {"TERM": "xterm-256color", "COLORTERM": "truecolor"}

WITHOUT_SCREEN = """
import os, signal, sys, time, types
sys.modules["logical_robots_tui.tui.play"] = game = types.ModuleType("play")
def ended(*_): os.kill(os.getpid(), signal.SIGTERM); time.sleep(60)
def failed(*_): raise RuntimeError("not this time")
game.play = {}
from logical_robots_tui.cli.main import main
sys.exit(main(["play", "--data-dir", sys.argv[1]]))
"""


@pytest.mark.parametrize(
    ("size", "colours"), [((80, 24), "truecolor"), ((120, 40), "256"), ((100, 51), "truecolor")]
)
def test_the_first_picture_has_the_cells_of_the_outline(
    size: tuple[int, int], colours: str, data_dir: Path
) -> None:
    text = drawn(*size, truecolor=colours == "truecolor")
    screen = pyte.Screen(*size)
    pyte.Stream(screen).feed(text)
    outline = looks(screen)
    command = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps"]
    env = TERM | {"COLORTERM": colours, "XDG_CONFIG_HOME": str(data_dir)}
    with Terminal([*command, "--data-dir", data_dir], size=size, env=env) as terminal:
        terminal.arrival_of(lambda: "tick 0" in terminal.text)
        picture = looks(terminal.screen)
    assert terminal.everything.startswith(f"{ENTER}\x1b[?25l{text}")
    assert terminal.everything.count(ENTER) == 1
    lines = (0, size[1] - 2, size[1] - 1)  # status, timeline, commands
    written = 0
    for row, line in enumerate(outline):
        note = "".join(str(sign) for sign, *_ in picture[row]).find("Program · ")
        for column, (sign, paper, *ink) in enumerate(line):
            its_sign, its_paper, *its_ink = picture[row][column]
            if sign != " ":
                written += 1
                is_under_a_note = sign == "─" and 0 <= note < column
                assert is_under_a_note or (sign, ink) == (its_sign, its_ink), (row, column)
            if sign != " " or row in lines:
                assert paper == its_paper, (row, column)
    assert written >= len("1Labyrinth")


@pytest.mark.parametrize(("fate", "status"), [("ended", 143), ("failed", 70)])
def test_a_start_that_fails_leaves_no_outline(fate: str, status: int, data_dir: Path) -> None:
    command = [sys.executable, "-c", WITHOUT_SCREEN.format(fate), data_dir]
    with Terminal(command, env=TERM | {"XDG_CONFIG_HOME": str(data_dir)}) as terminal:
        assert terminal.finish() == status
    entered, left = (terminal.everything.find(where) for where in (ENTER, LEAVE))
    assert 0 <= entered < left
    assert terminal.everything.find("\x1b[?25h") > left


@pytest.mark.parametrize(
    ("environ", "colours"),
    [
        (TERM, "truecolor"),
        ({"TERM": "xterm-256color"}, "256"),
        ({"TERM": "screen-256color", "COLORTERM": ""}, "256"),
        ({"TERM": "xterm"}, ""),
        (TERM | {"NO_COLOR": "1"}, ""),
    ],
)
def test_there_is_an_outline_only_where_its_colours_are_certain(
    environ: dict[str, str], colours: str
) -> None:
    assert colours_of(environ) == colours


def test_a_terminal_without_room_has_no_outline() -> None:
    assert drawn(39, 24, truecolor=True) == ""


def test_a_glance_at_the_record_changes_nothing(tmp_path: Path) -> None:
    file = tmp_path / FILE_NAME
    assert fact_in(file, THEME) == ""
    assert not file.exists()
    progress = Progress(file)
    progress.set_fact("tour", "seen")
    assert fact_in(file, THEME) == ""
    progress.set_fact(THEME, "gruvbox")
    progress.close()
    assert fact_in(file, THEME) == "gruvbox"
    file.write_bytes(damaged := b"no record at all " * 100)
    assert fact_in(file, THEME) is None
    assert file.read_bytes() == damaged
