"""A program can do nothing but think."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.mind.database import Database
from tests.mind.rows import ROBOT, row

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def program() -> Program:
    return Program.compile(ROBOT + "m = 1;")


@pytest.mark.parametrize(
    "sql",
    [
        "ATTACH DATABASE '{file}' AS other",
        "CREATE TABLE x(y)",
        "DROP TABLE Sensor",
        "INSERT INTO Memory VALUES ('Ada', 1)",
        "DELETE FROM Memory",
        "UPDATE Sensor SET sensor = 1",
        "PRAGMA writable_schema = 1",
        "VACUUM INTO '{file}'",
        "SELECT load_extension('{file}')",
        "SELECT readfile('/etc/passwd')",
        "SELECT writefile('{file}', 'x')",
        "SELECT randomblob(1000000000)",
        "SELECT zeroblob(2000000000)",
        "SELECT fts3_tokenizer('x')",
        "SELECT sqlite_compileoption_get(1)",
        "BEGIN",
    ],
)
def test_sql_that_does_more_than_read_is_refused(sql: str, tmp_path: Path) -> None:
    file = tmp_path / "touched"
    database = Database(seconds=5)
    database.load([("Ada", "{}")], [("Ada", "kept")])
    with pytest.raises(sqlite3.DatabaseError):
        database.ask(sql.format(file=file), most=10)
    assert not file.exists()
    assert database.ask("SELECT memory FROM Memory", most=10)[1] == [("kept",)]
    database.close()


def test_a_refusal_reaches_the_player_as_a_notice_without_sql(program: Program) -> None:
    mind = Mind(replace(program, statements={"Robot": "SELECT readfile('/etc/passwd')"}))
    (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
    mind.close()
    assert decision.memory == "kept"
    assert decision.notices[0].kind == "failed"
    assert "readfile" not in decision.notices[0].message or "no function" in (
        decision.notices[0].message
    )


@pytest.mark.parametrize(
    "rules",
    [
        "m = Sum{a * b * c * d :- a in Range(9000), b in Range(9000), c in Range(9000), "
        "d in Range(9000)};",
        "m = Size(Range(1000000000000));",
        'm = Join(List{"xxxxxxxxxx" :- a in Range(99999), b in Range(999)}, "");',
    ],
)
def test_a_bomb_is_bounded_and_the_next_program_thinks(rules: str, program: Program) -> None:
    mind = Mind(Program.compile(ROBOT + rules), limits=Limits(think_seconds=0.3))
    (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
    mind.close()
    assert decision.memory == "kept"
    assert decision.notices[0].kind == "failed"
    after = Mind(program)
    assert after.think([row("Ada")], {})[0].memory == 1
    after.close()


def test_terminal_codes_in_a_memory_stay_data() -> None:
    mind = Mind(Program.compile(ROBOT + "Memory(robot_name:, memory:), m = memory;"))
    nasty = "\x1b]0;owned\x07[red]"
    (decision,) = mind.think([row("Ada")], {"Ada": nasty})
    mind.close()
    assert decision.memory == nasty
