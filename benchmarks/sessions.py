"""Memory of a game over a scripted hour: levels, runs, proofs, questions, diagnoses, edits."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from benchmarks.measure import Effort, Measurement, at_most, need, summed_up
from logical_robots_tui.caching import FOLDER_VARIABLE
from logical_robots_tui.world import list_levels
from tests.memory_use import descendants, memory_share
from tests.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["session"]

SIZE = (120, 40)
ROUNDS = 12  # each with what a player does in five minutes
TICKS = 400  # of a run
MOST_MEGABYTES = 130
REST_SECONDS = 120  # most, until the compile process has ended

_FASTER = "+" * 12
_LEAVE = "\x1b"
_APPLY, _COMMANDS, _PAGE_UP, _HOME = "\x12", "\x10", "\x1b[5~", "\x1b[H"
_MOMENT, _WHILE = 0.5, 4.0  # seconds in which a dialog opens, and in which a run or scan ends


def session(effort: Effort) -> Iterator[Measurement]:
    """Measure megabytes of all processes of a game, at most and after each of its parts."""
    need("/proc", Path("/proc/self/smaps_rollup").exists())
    rounds = 2 if effort.is_quick else ROUNDS
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        game = [sys.executable, "-m", "logical_robots_tui", "play", "--data-dir", folder]
        env = {FOLDER_VARIABLE: f"{folder}/cache"}
        with Terminal(game, size=SIZE, env=env) as terminal:
            player = _Player(terminal)
            player.open_game()
            for number, level in enumerate(list_levels()[:rounds]):
                player.play_round(number, level)
            after = player.rest()
    subject = f"120x40, {rounds} rounds of what 5 minutes hold"
    for activity, megabytes in player.most_megabytes.items():
        yield summed_up(f"memory, {activity}", subject, "MB", [megabytes])
    yield summed_up("memory after it", subject, "MB", [after], target=at_most(MOST_MEGABYTES))


class _Player:
    """Types what a player does, and notes the memory after each activity."""

    def __init__(self, terminal: Terminal) -> None:
        self._terminal = terminal
        self.most_megabytes: dict[str, float] = {}

    def open_game(self) -> None:
        self._terminal.wait_for("· applied")
        self._type(_LEAVE, _FASTER)
        self._note("at the start")

    def play_round(self, number: int, level: str) -> None:
        if number:
            self._type("1l", level, "\r")
            self._terminal.wait_for("tick 0 ")
            self._terminal.wait_for("· applied")
            self._note("levels")
        self._run_until(TICKS)
        for _ in range(3):
            self._type("1w", "1PPPP")
        self._note("proofs")
        for query in range(number, number + 2):
            self._type("1/", f"Robot(robot_name:, memory:, desire:), {query} == {query}\r", _LEAVE)
        self._note("questions")
        self._type(f"1{_COMMANDS}diagnosis", "\r", "\r", seconds=_WHILE)
        self._note("diagnoses")
        for edit in range(3):
            comment = f"{_PAGE_UP}{_HOME}# {number} {edit}\r"
            self._type("2", comment, _APPLY, _LEAVE, seconds=2 * _MOMENT)
        self._note("edits")
        self._run_until(TICKS + 50)

    def rest(self) -> float:
        """Return the megabytes when the compile process has ended because nothing is compiled."""
        deadline = monotonic() + REST_SECONDS
        pid = self._terminal.process.pid
        while len(descendants(pid)) > 1 and monotonic() < deadline:
            self._terminal.read_for(_MOMENT)
        return memory_share(pid, and_children=True) / 1e6

    def _run_until(self, tick: int) -> None:
        self._type("1U", f"{tick}\r", seconds=_WHILE)
        self._type(_LEAVE)
        self._note("runs")

    def _type(self, *texts: str, seconds: float = _MOMENT) -> None:
        """Send texts, each when what the one before led to has come, the last one with time."""
        for text in texts:
            self._terminal.send(text)
            self._terminal.read_for(_MOMENT)
        self._terminal.read_for(seconds - _MOMENT)

    def _note(self, activity: str) -> None:
        megabytes = memory_share(self._terminal.process.pid, and_children=True) / 1e6
        self.most_megabytes[activity] = max(megabytes, self.most_megabytes.get(activity, 0))
