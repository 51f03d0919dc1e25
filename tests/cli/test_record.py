"""Recording a run without a screen."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.cast import events_of, played

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command


def test_a_recording_can_be_played(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    film = tmp_path / "run.cast"
    told = command("record", level, ahead, "-o", film, "--size", "60x20", "--speed", "20")
    assert told.status == 0
    assert told.out.endswith("won.\n")
    head, events = events_of(film)
    assert (head["width"], head["height"], head["title"]) == (60, 20, "A short way")
    ticks = int(told.out.split()[1])
    assert events[-1][0] == pytest.approx(ticks / 20 + 3)
    last = played(film).display
    assert f"tick {ticks}   Door 1/1   ★ won" in last[-1]
    assert any("Pip" in line for line in last)


@pytest.mark.parametrize("size", ["80", "5x5", "80x24x3", "9999x9999"])
def test_a_size_that_can_not_be_is_refused(command: Command, size: str, tmp_path: Path) -> None:
    told = command("record", "01-first-steps", "herd", "-o", tmp_path / "x", "--size", size)
    assert told.status == 2
    assert f"'{size}' is not a size from 20x6 to 500x200" in told.err


def test_a_file_that_can_not_be_written_is_named(
    command: Command, level: Path, ahead: Path, tmp_path: Path
) -> None:
    told = command("record", level, ahead, "--ticks", "1", "-o", tmp_path / "none" / "run.cast")
    assert told.status == 2
    assert "run.cast: No such file or directory." in told.err
