"""Playing again what others claim ends within bounds, and says what was given up."""

import asyncio
import json
from contextlib import nullcontext
from pathlib import Path

import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import load_program
from logical_robots_tui.game.verification import (
    MOST_PROGRAMS,
    MOST_ROBOT_TICKS,
    FileBudget,
    OverBudgetError,
    check_size,
)
from logical_robots_tui.mind import Program
from logical_robots_tui.mind.program import Texts
from tests.cli.running import Command

LEVEL = "01-first-steps"


def exported(folder: Path, *programs: str) -> Path:
    victories = [{"program": text, "ticks": 3, "size": 1, "distance": 5.0} for text in programs]
    file = folder / "export.json"
    file.write_text(json.dumps({"format": 1, "levels": [{"level": LEVEL, "victories": victories}]}))
    return file


@pytest.mark.parametrize(
    ("programs", "robot_ticks", "message"),
    [
        (MOST_PROGRAMS, MOST_ROBOT_TICKS, ""),
        (MOST_PROGRAMS + 1, 0, "It has 1,001 programs; at most 1,000 are played again"),
        (1, MOST_ROBOT_TICKS + 1, "It has 10,000,001 decisions of robots; at most 10,000,000"),
    ],
)
def test_size_is_bounded(programs: int, robot_ticks: int, message: str) -> None:
    with pytest.raises(InputError, match=message) if message else nullcontext():
        check_size(programs, robot_ticks)


async def test_work_is_cancelled_when_its_time_is_over() -> None:
    ended = asyncio.Event()

    async def compute() -> None:
        try:
            budget.seconds = 1
            budget.end()
            await asyncio.Event().wait()
        finally:
            ended.set()

    budget = Bounded(100)
    with pytest.raises(OverBudgetError, match=r"given up after 1 processor second\. --seconds N"):
        await budget.bound(compute())
    assert ended.is_set()
    assert budget.entry_seconds == 1
    with pytest.raises(OverBudgetError):
        await budget.compile("Robot();")


async def test_what_is_done_in_time_has_its_result_or_error() -> None:
    assert await FileBudget(100).bound(asyncio.to_thread(str, "x")) == "x"
    with pytest.raises(ZeroDivisionError):
        await FileBudget(100).bound(asyncio.to_thread(divmod, 1, 0))


def test_victories_are_given_up_by_name(command: Command, tmp_path: Path) -> None:
    endless = load_program("first-steps").text.replace("left_engine: 0.8", "left_engine: 0.0")
    assert endless != load_program("first-steps").text
    file = exported(tmp_path, endless, endless + "\n# Forged.")
    told = command("progress", "--check", file, "--seconds", 1, status=1)
    while "try again" in told.out:  # a busy machine cut off a thought
        told = command("progress", "--check", file, "--seconds", 1, status=1)
    for line in told.out.splitlines()[1:]:
        assert line.startswith(LEVEL)
        assert line.endswith("given up after 1 processor second. --seconds N allows more.")


def test_a_file_of_too_many_programs_is_not_played(command: Command, tmp_path: Path) -> None:
    file = exported(tmp_path, *(f"A({number});" for number in range(MOST_PROGRAMS + 1)))
    told = command("progress", "--check", file)
    assert "export.json: It has 1,001 programs" in told.refusal
    assert not told.out


def test_a_replay_is_given_up_at_a_tick(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "a.replay"
    command("replay", "record", LEVEL, "first-steps", "-o", file, "--ticks", 5)
    monkeypatch.setattr("logical_robots_tui.cli.replay.FileBudget", lambda _seconds: Bounded(100))
    told = command("replay", "verify", file)
    assert f"{file}: Tick 0 of 5: given up after 100 processor seconds" in told.refusal


class Bounded(FileBudget):
    def end(self) -> None:
        self._end = 0

    async def compile(self, texts: "str | Texts") -> Program:
        """Spend all when a program has been compiled."""
        try:
            return await super().compile(texts)
        finally:
            self.end()
