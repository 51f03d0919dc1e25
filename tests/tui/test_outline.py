"""The outline that stands before the screen: it is what the first picture has in its place."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pyte
import pytest

from logical_robots_tui.progress import FILE_NAME, Progress
from logical_robots_tui.progress.glance import facts_in
from logical_robots_tui.tui.app.dress import NIGHT, dress_from
from logical_robots_tui.tui.app.facts import DRESS, THEME
from logical_robots_tui.tui.app.outline import ENTER, LEAVE, colours_of, drawn
from tests.terminal import Terminal, looks

if TYPE_CHECKING:
    from pathlib import Path

END = "\x1b[0m\x1b[H"  # of an outline

TERM = {"TERM": "xterm-256color", "COLORTERM": "truecolor"}

WITHOUT_SCREEN = """
import os, signal, sys, time, types
sys.modules["logical_robots_tui.tui.app.play"] = game = types.ModuleType("play")
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
    first_is_outline(size, TERM | {"COLORTERM": colours}, data_dir)


@pytest.mark.parametrize(
    ("size", "env", "settings"),
    [
        ((80, 24), TERM, 'theme = "solarized-light"\n[keys]\nlabyrinth = "f7"\n'),
        ((120, 40), {"TERM": "xterm-256color"}, 'theme = "gruvbox"\n'),
        ((120, 40), {"TERM": "xterm"}, ""),
        ((80, 24), {"TERM": "xterm"}, 'theme = "night"\n'),
    ],
    ids=["keys", "256", "standard", "night"],
)
def test_the_outline_is_that_of_the_last_start(
    size: tuple[int, int], env: dict[str, str], settings: str, data_dir: Path
) -> None:
    if settings:
        file = data_dir / "logical-robots" / "config.toml"
        file.parent.mkdir(parents=True)
        file.write_text(settings)
    with started(size, env, data_dir) as terminal:
        terminal.arrival_of(lambda: "tick 0" in terminal.text)
        terminal.send("q")
        terminal.finish()
    first_is_outline(size, env, data_dir)


def started(size: tuple[int, int], env: dict[str, str], data_dir: Path) -> Terminal:
    command = [sys.executable, "-m", "logical_robots_tui", "play", "01-first-steps"]
    env = {"COLORTERM": ""} | env | {"XDG_CONFIG_HOME": str(data_dir)}
    return Terminal([*command, "--data-dir", data_dir], size=size, env=env)


def first_is_outline(size: tuple[int, int], env: dict[str, str], data_dir: Path) -> None:
    """Start a game whose first picture has an outline, and compare the two."""
    with started(size, env, data_dir) as terminal:
        terminal.arrival_of(lambda: "tick 0" in terminal.text)
        picture = looks(terminal.screen)
    assert terminal.everything.count(ENTER) == 1
    entered = terminal.everything.removeprefix(f"{ENTER}\x1b[?25l")
    text, ended, _ = entered.partition(END)
    assert ended
    screen = pyte.Screen(*size)
    pyte.Stream(screen).feed(text)
    outline = looks(screen)
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


def test_what_is_kept_for_other_circumstances_is_not_worn() -> None:
    dress = NIGHT["256"]._replace(keys=("space", "2"))
    assert dress_from(dress.as_text("256 night -"), "256 night -") == dress
    assert dress_from(dress.as_text("256 night -"), "256 gruvbox -") is None
    assert dress_from("", "256 night -") is None
    assert dress_from("256 night -\n1\t2\nwhat is this", "256 night -") is None
    damaged = dress.as_text("256 night -").replace("void", "avoid")
    assert dress_from(damaged, "256 night -") is None


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
        ({"TERM": "xterm"}, "standard"),
        ({"TERM": "dumb"}, ""),
        (TERM | {"NO_COLOR": "1"}, ""),
    ],
)
def test_there_is_an_outline_only_where_its_colours_are_certain(
    environ: dict[str, str], colours: str
) -> None:
    assert colours_of(environ) == colours


def test_a_terminal_without_room_has_no_outline() -> None:
    assert drawn(39, 24, NIGHT["truecolor"]) == ""


def test_a_glance_at_the_record_changes_nothing(tmp_path: Path) -> None:
    file = tmp_path / FILE_NAME
    assert facts_in(file, THEME, DRESS) == ("", "")
    assert not file.exists()
    progress = Progress(file)
    progress.set_fact("tour", "seen")
    assert facts_in(file, THEME, DRESS) == ("", "")
    progress.set_fact(THEME, "gruvbox")
    progress.close()
    assert facts_in(file, DRESS, THEME) == ("", "gruvbox")
    file.write_bytes(damaged := b"no record at all " * 100)
    assert facts_in(file, THEME) is None
    assert file.read_bytes() == damaged
