"""What a clock has ended is told by every command that counts what happened in a run."""

from pathlib import Path

import pytest

from tests.cli.running import Command


@pytest.mark.parametrize("ticks", [2, 5])
@pytest.mark.usefixtures("late")
def test_a_run_in_which_a_clock_ended_a_thought_is_marked(
    ticks: int, command: Command, level: Path, ahead: Path
) -> None:
    for name, words in (("run", ()), ("when", ("Robot",)), ("diagnose", ())):
        told = command(name, level, ahead, *words, "--ticks", ticks, "--json")
        assert told.data["reliable"] is (ticks < 3), name
    told = command("trace", level, ahead, "--ticks", ticks)
    assert ('"reliable": false' in told.out) is (ticks >= 3)
