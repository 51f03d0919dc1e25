"""Each program of the corpus is refused or bounded, and the game goes on."""

import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import pytest

from logical_robots_tui.mind import Decision, Limits, Mind, Program, ProgramError, QueryError
from logical_robots_tui.mind.program import Tuned
from logical_robots_tui.mind.sqlite.budget import MAX_TEXT, MeteredWork
from logical_robots_tui.mind.sqlite.database import Database, TooMuchError, TooSlowError
from tests.mind.hostile.bounds import bounded_memory
from tests.mind.hostile.programs import PROGRAMS
from tests.mind.hostile.statements import REFUSED, RUNAWAY
from tests.mind.rows import ROBOT, decision_of, row

LIMITS = Limits(
    compile_seconds=0.3,
    think_steps=3_000_000,
    think_seconds=1.0,
    query_steps=3_000_000,
    query_seconds=1.0,
)
COMPILES = replace(LIMITS, compile_seconds=30.0)
LAST_CALL = 127 * MAX_TEXT  # steps: the characters of all arguments that a call may have

# Other limits, and whatever is cut short, begin a new compile process.
SLOW_LAST = sorted(PROGRAMS, key=lambda name: PROGRAMS[name][0] == "slow")
SEES = {3: (50, "area", "\x1b[31m[red]")}
SEEN = [row("Ada", sees=SEES)]

PASSWORDS = Path("/etc/passwd").read_text(encoding="utf-8").split("\n", 1)[0]


@pytest.fixture(scope="module")
def next_program() -> Program:
    return Program.compile(ROBOT + "m = 1;")


@contextmanager
def nothing_touched(folder: Path) -> Iterator[None]:
    """Assert that a block ends within its steps, without a file and with little memory."""
    with in_folder(folder), bounded_memory(), bounded_steps():
        yield
    assert list(folder.iterdir()) == []


@contextmanager
def bounded_steps() -> Iterator[None]:
    left: list[int] = []
    end = MeteredWork.end

    def noted_end(work: MeteredWork) -> None:
        left.append(work.steps)
        end(work)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(MeteredWork, "end", noted_end)
        yield
    assert min(left, default=0) > -LAST_CALL


@contextmanager
def in_folder(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def goes_on(program: Program) -> bool:
    return decision_of(Mind(program), "").memory == 1


def outcome(text: str, limits: Limits) -> tuple[str, list[Decision]]:
    refusal = ""
    try:
        program = Program.compile(text, limits=limits)
    except ProgramError as error:
        refusal = str(error)
    if refusal:
        assert refusal.replace("\n", "").isprintable()
        return "refused", []
    decision = decision_of(Mind(program, limits=LIMITS), sees=SEES)
    assert all(notice.message.isprintable() for notice in decision.notices)
    failed = any(notice.kind in ("failed", "late", "no memory") for notice in decision.notices)
    assert not failed or decision.memory == "kept"
    return "failed" if failed else "harmless", [decision]


@pytest.mark.sampled
@pytest.mark.parametrize("name", SLOW_LAST)
def test_a_hostile_program_is_bounded(name: str, tmp_path: Path, next_program: Program) -> None:
    assert len(PROGRAMS) >= 150
    wanted, text = PROGRAMS[name]
    limits = LIMITS if wanted == "slow" else COMPILES
    with nothing_touched(tmp_path):
        became, decisions = outcome(text, limits)
    assert wanted in (became, "bounded", "slow")
    assert PASSWORDS not in repr(decisions)
    assert goes_on(next_program)


def refuses(database: Database, sql: str) -> bool:
    try:
        database.ask(sql, max_rows=10)
    except (sqlite3.Error, sqlite3.Warning):
        return True
    return False


def test_sql_that_does_more_than_read_is_refused(tmp_path: Path) -> None:
    with closing(Database(LIMITS)) as database:
        database.load([("Ada", "{}")], [("Ada", "kept")])
        for sql in REFUSED:
            with nothing_touched(tmp_path):
                assert refuses(database, sql), sql
            assert database.ask("SELECT memory FROM Memory", max_rows=10)[1] == [("kept",)], sql


@pytest.mark.sampled
@pytest.mark.parametrize("name", RUNAWAY)
def test_runaway_sql_ends(name: str, tmp_path: Path) -> None:
    with closing(Database(LIMITS)) as database:
        database.load([("Ada", "{}")], [("Ada", "kept")])
        with (
            nothing_touched(tmp_path),
            suppress(sqlite3.Error, sqlite3.Warning, TooSlowError, TooMuchError),
        ):
            database.ask(RUNAWAY[name], max_rows=10_000)
        query = "SELECT memory, upper('abc') FROM Memory"
        assert database.ask(query, max_rows=10)[1] == [("kept", "ABC")]


@pytest.mark.sampled
@pytest.mark.parametrize(
    "sql",
    [
        *REFUSED,
        *(pytest.param(sql, marks=pytest.mark.proof, id=name) for name, sql in RUNAWAY.items()),
    ],
)
def test_sql_forced_into_a_program_is_a_notice_or_an_answer_and_into_the_quick_way_is_left(
    sql: str, tmp_path: Path, next_program: Program
) -> None:
    mind = Mind(replace(next_program, statements={"Robot": sql}, tuned={}), limits=LIMITS)
    with nothing_touched(tmp_path):
        (decision,) = mind.think(SEEN, {"Ada": "kept"})
    assert decision.memory == "kept"
    assert decision.notices
    assert all(n.message.isprintable() and "SELECT" not in n.message for n in decision.notices)
    with in_folder(tmp_path), suppress(QueryError):
        mind.query("Robot", SEEN, {"Ada": "kept"})
    mind.close()
    assert goes_on(next_program)
    forced = Tuned(sql, 0, {"Sensor": ("robot_name", "sensor")}, ())
    mind = Mind(replace(next_program, tuned={"Robot": forced}), limits=LIMITS)
    with nothing_touched(tmp_path):
        decision = decision_of(mind, sees=SEES)
    assert decision.desire is not None or decision.notices
    assert goes_on(next_program)
