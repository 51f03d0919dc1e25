"""With DuckDB, too, a program can do nothing but think."""

from __future__ import annotations

import sys
import threading
from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING, Any

import duckdb
import pytest

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.mind import Limits, Mind, Program, ProgramError, Stopped, why_not_duckdb
from logical_robots_tui.mind.duck import engine
from logical_robots_tui.mind.duck.engine import DuckTables
from logical_robots_tui.mind.duck.words import is_harmless
from logical_robots_tui.mind.program import Duck
from logical_robots_tui.mind.sqlite.database import TooSlowError
from logical_robots_tui.mind.sqlite.moment import Moment, Within
from logical_robots_tui.mind.sqlite.tables import UnfitError
from tests.mind.duck.both import CROWD, decisions
from tests.mind.hostile.programs import PROGRAMS
from tests.mind.rows import ROBOT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

HOSTILE = [
    "SELECT * FROM read_text('/etc/passwd')",
    "SELECT * FROM read_csv ('/etc/passwd')",
    "SELECT * FROM '/etc/passwd'",
    "SELECT content FROM glob('/*')",
    "ATTACH 'touched.db'",
    "COPY (SELECT 1) TO 'touched.csv'",
    "EXPORT DATABASE 'touched'",
    "INSTALL httpfs",
    "LOAD '/tmp/touched.so'",
    "SET enable_external_access = true",
    "SET memory_limit = '100GB'",
    "SET threads = 64",
    "RESET lock_configuration",
    "SET temp_directory = 'touched'",
    "CREATE SECRET s (TYPE s3, KEY_ID 'a', SECRET 'b')",
    "SELECT a FROM local_variable",
]
"""What DuckDB itself has to refuse."""

ODD = [
    *HOSTILE,
    "SELECT getenv('HOME')",
    "SELECT version()",
    "SELECT current_setting('memory_limit')",
    "SELECT * FROM duckdb_settings()",
    "SELECT * FROM pandas_scan(140000000000000)",
    "SELECT 1pandas_scan(140000000000000)",
    "SELECT * FROM s1, pandas_scan\n(1)",
    "SELECT random()",
    "SELECT now()",
    "SELECT CURRENT_TIMESTAMP",
    "SELECT s1.c1.getenv() FROM Sensor AS s1",
    "SELECT * FROM \"read_text\"('/etc/passwd')",
    "SELECT 1; DROP VIEW Sensor",
    "SELECT $$a$$",
    "SELECT 1 -- '\n",
    "SELECT 1 /* ' */ FROM pandas_scan(1) /* ' */",
    "SELECT 'a' || repeat('b', 1000000000)",
    "SELECT e'\\x41'",
    "SELECT 'it''s' FROM range(1000000000)",
    "SELECT repeat('b', 1000000000)",
    "SELECT [1, 2]",
    "DROP VIEW Sensor",
    "PRAGMA database_list",
    "",
    "SELECT 'open",
]


@pytest.fixture
def tables(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[DuckTables]:
    monkeypatch.chdir(tmp_path)
    opened = DuckTables(Limits())
    yield opened
    opened.close()
    assert list(tmp_path.iterdir()) == []


def ask(tables: DuckTables, sql: str, within: Within | None = None) -> Any:
    """What a query gives for a crowd."""
    moment = Moment(CROWD * 60, {}, "own", "own")
    duck = Duck(("robot_name",), {"Sensor": ("robot_name",), "Ray": ("distance",)}, own=sql)
    return tables.ask(duck, moment, within or Within(10**9, 20, 10_000, None))


@pytest.mark.parametrize("sql", HOSTILE)
def test_duckdb_is_closed_off_even_without_the_wall_before_it(sql: str, tables: DuckTables) -> None:
    local_variable = {"a": [1]}
    with pytest.raises(duckdb.Error):
        tables._connection.execute(sql).fetchall()
    assert local_variable


@pytest.mark.parametrize("sql", ODD)
def test_a_query_that_was_not_made_here_is_not_asked(sql: str, tables: DuckTables) -> None:
    assert not is_harmless(sql)
    with pytest.raises(UnfitError):
        ask(tables, sql)


@pytest.mark.parametrize("name", list_programs())
def test_queries_that_were_made_here_are(name: str) -> None:
    duck = Program.compile(load_program(name).text).tuned["Robot"].duck
    assert duck is not None
    queries = [query for query in (duck.own, duck.memories, duck.all) if query]
    assert bool(queries) != bool(duck.unlike)
    assert all(map(is_harmless, queries))


NAMES = ("robot_name", "desire_0", "desire_1", "memory")


@pytest.mark.parametrize(
    ("names", "sql"),
    [
        (NAMES, "SELECT * FROM read_text('/etc/passwd')"),
        (NAMES, "SELECT s1.robot_name, 1, 1, 2, 999 FROM Sensor AS s1"),
        (NAMES, "SELECT s1.robot_name, 1, 1, 2, 'x' FROM Sensor AS s1"),
        (NAMES, "SELECT s1.robot_name, s1.id FROM Sensor AS s1"),
        (NAMES[:2], "SELECT s1.robot_name, 1, s1.id FROM Sensor AS s1"),
    ],
)
def test_a_program_from_a_cache_that_somebody_wrote_to_thinks_with_sqlite(
    names: tuple[str, ...], sql: str, answered: Callable[[], int]
) -> None:
    program = Program.compile(ROBOT + "m = 1;")
    tuned = program.tuned["Robot"]
    bad = Duck(names, {"Sensor": ("robot_name",)}, own=sql)
    program = replace(program, tuned={"Robot": replace(tuned, duck=bad)})
    assert {d.memory for d in decisions(program, CROWD, {}, "duckdb")} == {1}
    assert answered() == 0


LONG = "SELECT count(*) FROM Ray AS s1, Ray AS s2, Ray AS s3, Ray AS s4 WHERE s1.ray < s2.distance"


def test_a_long_thought_ends_in_time(tables: DuckTables) -> None:
    began = monotonic()
    moment = Within(10**9, 0.3, 10_000, None)
    with pytest.raises(TooSlowError):
        ask(tables, LONG, moment)
    assert monotonic() - began < 3  # a tenth more on a machine that is not busy
    assert len(ask(tables, "SELECT s1.robot_name, s1.id FROM Sensor AS s1")) == len(CROWD) * 60


def test_a_thought_can_be_stopped(tables: DuckTables) -> None:
    stop = threading.Event()
    timer = threading.Timer(0.2, stop.set)
    timer.start()
    with pytest.raises(Stopped):
        ask(tables, LONG, Within(10**9, 60, 10_000, stop))
    timer.join()


def test_a_thought_that_is_too_long_is_told_as_with_sqlite(answered: Callable[[], int]) -> None:
    inner = "1"
    for name in "abcdefg":
        inner = f"Sum{{{name}.distance * {inner} :- {name} in sensor.radar}}"
    text = f"""{ROBOT} m = Sum{{a.distance * b.distance * c.distance * d.distance * e.distance
      * f.distance * g.distance :- a in sensor.radar, b in sensor.radar, c in sensor.radar,
      d in sensor.radar, e in sensor.radar, f in sensor.radar, g in sensor.radar}};"""
    program = Program.compile(text)
    assert not why_not_duckdb(program)
    ours, theirs = (
        decisions(
            program, CROWD, {}, engine, limits=Limits(think_steps=10_000_000, think_seconds=4)
        )
        for engine in ("sqlite", "duckdb")
    )
    assert theirs == ours
    assert {d.notices[0].kind for d in theirs} == {"failed"}
    assert answered() == 0


def test_memory_is_bounded() -> None:
    tables = DuckTables(Limits(mind_bytes=20_000_000))
    columns = "s1.ray, s1.sensor, s2.ray, s2.sensor, s3.ray"
    query = f"SELECT DISTINCT {columns} FROM Ray AS s1, Ray AS s2, Ray AS s3"
    with pytest.raises(UnfitError, match="emory"):
        ask(tables, query)
    tables.close()


def test_a_query_that_fails_again_and_again_is_not_tried_any_more(tables: DuckTables) -> None:
    failing = "SELECT CAST(s1.robot_name AS BIGINT) FROM Sensor AS s1"
    for _ in range(3):
        with pytest.raises(UnfitError, match="Conversion"):
            ask(tables, failing)
    with pytest.raises(UnfitError, match="no query"):
        ask(tables, failing)


def test_no_more_rows_are_fetched_than_a_thought_may_have(tables: DuckTables) -> None:
    query = "SELECT s1.ray, s1.sensor FROM Ray AS s1, Ray AS s2"
    assert len(ask(tables, query, Within(10**9, 20, 50, None))) == 51


def test_without_the_package_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    program = Program.compile(ROBOT + "m = 1;")
    monkeypatch.setitem(sys.modules, "duckdb", None)
    with pytest.raises(InputError, match=r"pip install logical-robots-tui\[duckdb\]"):
        Mind(program, engine="duckdb")
    Mind(program).close()


def test_a_duckdb_that_can_not_be_closed_off_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "_SETTINGS", ("no_such_setting = true",))
    with pytest.raises(InputError, match="can't be closed off"):
        DuckTables(Limits())


@pytest.mark.parametrize(
    ("what", "text"),
    [
        pytest.param(
            *(what, text), id=what, marks=[pytest.mark.proof] if outcome == "bounded" else []
        )
        for what, (outcome, text) in PROGRAMS.items()
        if outcome not in ("refused", "slow")
    ],
)
def test_hostile_programs_come_to_the_same(
    what: str, text: str, answered: Callable[[], int]
) -> None:
    try:
        program = Program.compile(text, limits=Limits(compile_seconds=30))
    except ProgramError:
        assert PROGRAMS[what][0] == "bounded"
        return
    if why_not_duckdb(program):
        return
    ours, theirs = (
        decisions(
            program, CROWD, {}, engine, limits=Limits(think_steps=10_000_000, think_seconds=4)
        )
        for engine in ("sqlite", "duckdb")
    )
    assert answered() == 1 or theirs == ours, what
    assert [d.memory for d in theirs] == [d.memory for d in ours] or not ours[0].desire
