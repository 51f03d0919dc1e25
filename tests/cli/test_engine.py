"""``--engine duckdb``: the same runs, and a word where it can't be used."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.mind.duck import engine

if TYPE_CHECKING:
    from pathlib import Path

    from tests.cli.running import Command

REMEMBERS = """\
Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory:) :-
  Memory(robot_name:, memory:);
"""


@pytest.fixture
def remembers(tmp_path: Path) -> Path:
    """A program that DuckDB can't compute."""
    path = tmp_path / "remembers.l"
    path.write_text(REMEMBERS, encoding="utf-8")
    return path


def test_a_run_ends_the_same_with_both_engines(
    command: Command, level: Path, ahead: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine, "FEWEST", 1)
    ours, theirs = (command("run", level, ahead, "--engine", name) for name in ("sqlite", "duckdb"))
    assert (ours.status, ours.err) == (theirs.status, theirs.err) == (0, "")
    for kept in ("won", "ticks", "robots", "goals", "notices"):
        assert ours.data[kept] == theirs.data[kept]


def test_a_run_says_once_why_it_thinks_with_sqlite(
    command: Command, level: Path, remembers: Path
) -> None:
    told = command("run", level, remembers, "--engine", "duckdb", "--ticks", 5)
    assert told.err.count("\n") == 1
    assert "DuckDB can't compute Robot: it reads what robots remember" in told.err
    assert "The robots think with SQLite" in told.err
    assert told.data["ticks"] == 5
    assert command("run", level, remembers, "--ticks", 5).err == ""


def test_a_check_warns_of_what_duckdb_can_not_compute(
    command: Command, ahead: Path, remembers: Path
) -> None:
    told = command("check", ahead, remembers, "--engine", "duckdb")
    assert told.status == 0
    assert told.out.splitlines()[0] == (
        f"{remembers}:1:1: warning: DuckDB can't compute Robot: "
        "it reads what robots remember, which may be of any kind"
    )
    assert str(ahead) not in told.out
    assert command("check", ahead, remembers).out == ""


@pytest.mark.parametrize("what", ["run", "check"])
def test_without_the_package_it_is_said_how_to_get_it(
    what: str, command: Command, level: Path, ahead: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "duckdb", None)
    places = [level, ahead] if what == "run" else [ahead]
    told = command(what, *places, "--engine", "duckdb")
    assert told.status == 2
    assert "pip install logical-robots-tui[duckdb]" in told.err
    assert command(what, *places).status == 0


def test_other_engines_are_refused(command: Command, level: Path, ahead: Path) -> None:
    told = command("run", level, ahead, "--engine", "postgres")
    assert told.status == 2
    assert "'sqlite', 'duckdb'" in told.err
