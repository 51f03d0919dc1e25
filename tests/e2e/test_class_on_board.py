"""A class on one board: one plays in a browser, one over SSH, and the teacher sees both."""

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

import pytest

from tests.browser import CHROMIUM, Seat, chromium, serving
from tests.processes import run_command
from tests.sshd import SSHD, Server
from tests.terminal import Terminal

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        (CHROMIUM is None or SSHD is None) and "CI" not in os.environ,
        reason="there is no Chromium or sshd",
    ),
]

GAME = [sys.executable, "-m", "logical_robots_tui"]
LEVEL = "01-first-steps"
SOLUTION = (Path(__file__).parents[2] / "programs" / "first-steps.l").read_text("utf-8")
NOTICE = "In this class the teacher sees"
JOIN = "others may race my best run"


@contextmanager
def browser_player(folder: Path, board: Path) -> Iterator[Seat]:
    options = ["--class", str(folder / "players.toml"), "--port", "0"]
    link = run_command([*GAME, "serve", *options, "--add", "cleo"]).stdout
    with serving(folder, LEVEL, *options, "--board", str(board)) as address, chromium() as browser:
        yield Seat(browser, f"{address}#{link.strip().rpartition('#')[2]}")


@contextmanager
def ssh_player(folder: Path, board: Path) -> Iterator[Terminal]:
    words = f"play {LEVEL} --restricted --data-dir {folder} --board {board} --class"
    config = f"ForceCommand {sys.executable} -m logical_robots_tui {words}\n"
    keys = 'environment="LOGICAL_ROBOTS_PLAYER={name}" {key}'
    config += "PermitUserEnvironment LOGICAL_ROBOTS_PLAYER\n"
    with (
        Server(folder, config, ["ben"], keys) as server,
        Terminal(server.client("-t", player="ben"), size=(100, 40)) as terminal,
    ):
        yield terminal


def on_board(folder: Path, *words: str) -> Any:
    return json.loads(run_command([*GAME, "board", words[0], folder, *words[1:], "--json"]).stdout)


def test_one_in_a_browser_and_one_over_ssh_compare_what_they_won(tmp_path: Path) -> None:
    board, web, ssh = (tmp_path / name for name in ("board", "web", "ssh"))
    for folder in (web, ssh):
        folder.mkdir()
    with browser_player(web, board) as cleo, ssh_player(ssh, board) as ben:
        cleo.sees(NOTICE)
        cleo.press("Enter", sees="· applied")
        cleo.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        cleo.page.evaluate("text => navigator.clipboard.writeText(text)", f"{SOLUTION}# Cleo\n")
        cleo.press("2", "Control+a", "Control+v", sees="not applied")
        cleo.press("Control+r", sees="· applied ·")
        cleo.press("Escape", "+", "+", "+", "+", "Space", sees="You made it")
        cleo.press("Escape", sees=JOIN)
        cleo.page.keyboard.type("Cleo")
        cleo.press("Enter", sees=lambda: JOIN not in cleo.text)
        cleo.press("m", sees="1 of 1")

        ben.wait_for(NOTICE)
        ben.send("\r", sees="· applied")
        ben.send("2\x01")
        ben.send(f"\x1b[200~{SOLUTION}# Ben\n\x1b[201~", sees="not applied")
        ben.send("\x12", sees="· applied ·")
        ben.send("\x1b")
        ben.wait_for("space Run")
        assert "Cleo" not in ben.text
        ben.send("++++ ", sees="You made it")
        ben.send("\x1b", sees=JOIN)
        ben.send("\r")
        ben.wait_for(lambda: JOIN not in ben.text)
        ben.send("m", sees="2 of 2")
        ben.wait_for("Cleo")

        pupils = {pupil["player"]: pupil for pupil in watched(board)}
        assert {name: pupil["won_level"] for name, pupil in pupils.items()} == {
            "cleo": LEVEL,
            "ben": LEVEL,
        }
        assert not any(pupil["program"] for pupil in pupils.values())
    names = [entry["name"] for entry in on_board(board, "show")]
    assert sorted(names, key=str) == ["Cleo", None]
    assert on_board(board, "check")["confirmed"]


def watched(board: Path) -> list[dict[str, Any]]:
    """Return the first two lines of what the teacher sees."""
    with Popen([*GAME, "board", "watch", str(board), "--json"], stdout=PIPE, text=True) as watch:
        assert watch.stdout is not None
        lines = [watch.stdout.readline() for _ in range(2)]
        watch.terminate()
    return [json.loads(line) for line in lines]
