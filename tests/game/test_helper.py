"""Helpers can do nothing but compute, and end with the game whatever they do."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from logical_robots_tui.processes.helper import Helper, is_helper
from tests.processes import is_running
from tests.waiting import PATIENCE, until

MODULE = "tests.game.odd_helper"


def test_a_helper_reaches_nothing_outside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "secret.l").write_text("nobody's business")
    monkeypatch.setenv("SOME_SECRET", "swordfish")
    monkeypatch.setenv("HOME", str(tmp_path))
    helper = Helper(MODULE, "attempt", str(tmp_path))
    assert helper.stdout is not None
    found = json.loads(helper.stdout.readline())
    helper.end()
    assert found == {
        "isolated": "True",
        "home": "/",
        "folder": "/",
        "secret": "",
        "seconds": "600",
        "read the game": "done",
        **dict.fromkeys(("read", "list", "write", "run", "call"), "PermissionError"),
    }
    assert [path.name for path in tmp_path.iterdir()] == ["secret.l"]


PARENT = f"""
import sys
from logical_robots_tui.processes.helper import Helper
helper = Helper("{MODULE}", sys.argv[1])
helper.stdout.readline()
print(helper.pid, flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("what", ["in C", "in Python"])
def test_a_helper_ends_with_a_game_that_is_killed_whatever_it_does(what: str) -> None:
    command, pipe = [sys.executable, "-c", PARENT, what], subprocess.PIPE
    path = {"PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, env=os.environ | path) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        parent.kill()
    until(lambda: not is_running(pid))


@pytest.mark.slow
def test_a_helper_has_a_bound_of_processor_time() -> None:
    helper = Helper(MODULE, "in C", "bounded")
    assert -helper.wait(PATIENCE) in (signal.SIGXCPU, signal.SIGKILL)
    helper.end()


def test_only_the_games_own_helpers_are_taken_for_one() -> None:
    words: list[list[str]] = []

    class Noted(Helper):
        def __init__(self, module: str) -> None:
            super().__init__(module, "1", "2")
            assert isinstance(self.args, list)
            words.append([str(word) for word in self.args])
            self.end()

    Noted("logical_robots_tui.compile_process")
    Noted(MODULE)
    own, odd = words
    assert is_helper(sys.executable, own)
    assert not is_helper(sys.executable, odd)
    assert not is_helper("/bin/sh", own)
    for at in range(len(own) - 3):
        for change in ([], ["-c"], ["import os"]):
            changed = [*own[:at], *change, *own[at + 1 :]]
            assert not is_helper(sys.executable, changed) or changed == own
