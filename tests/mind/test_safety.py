"""A program can do nothing but think."""

import sqlite3
import threading
from contextlib import closing
from dataclasses import replace
from typing import Any

import pytest

from logical_robots_tui.mind import Limits, Mind, Program, QueryError, Stopped
from logical_robots_tui.mind.sqlite import registry
from logical_robots_tui.mind.sqlite.budget import STEPS_AT_ONCE, MeteredWork
from logical_robots_tui.mind.sqlite.database import Database
from tests.mind.rows import ROBOT, decision_of, python, row, think
from tests.waiting import PATIENCE


@pytest.fixture(scope="module")
def program() -> Program:
    return Program.compile(ROBOT + "m = 1;")


def test_a_refusal_reaches_the_player_as_a_notice_without_sql(program: Program) -> None:
    decision = decision_of(forced(program, "SELECT readfile('/etc/passwd')"))
    assert (decision.memory, decision.notices[0].kind) == ("kept", "failed")
    message = decision.notices[0].message
    assert "readfile" not in message or "no function" in message


NUMBERS = "WITH RECURSIVE t_0_N(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM t_0_N) "
BIG = "printf('%1900000s', 'x')"
ENDLESS = NUMBERS + "SELECT count(*) FROM t_0_N"
# Each calls `noted` for one step after the other.
SLOW = {
    "SQL": NUMBERS + "SELECT count(noted(n)) FROM t_0_N",
    "a function of SQLite": NUMBERS + f"SELECT sum(length(upper({BIG} || noted(n)))) FROM t_0_N",
    "a function of ours": NUMBERS
    + "SELECT sum(length(sort_list(number_range(19000 + noted(n) % 9)))) FROM t_0_N",
    "one row of many functions": "SELECT "
    + " + ".join(f"length(upper(s || noted({i})))" for i in range(900))
    + f" FROM (SELECT {BIG} AS s)",
}


def forced(program: Program, sql: str, **limits: Any) -> Mind:
    return Mind(replace(program, statements={"Robot": sql}, tuned={}), limits=Limits(**limits))


@pytest.mark.parametrize("what", SLOW)
def test_a_stop_takes_effect_at_once_in_the_middle_of(
    what: str, program: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    stop, halted = threading.Event(), threading.Event()
    after_the_halt: list[int] = []
    halt, install = Database._halt, registry.install

    def noted_halt(database: Database) -> None:
        halt(database)
        halted.set()

    def noted(number: int) -> int:
        if halted.is_set():
            after_the_halt.append(number)
            assert len(after_the_halt) == 1
        elif number == 3:
            stop.set()
            assert halted.wait(PATIENCE)
        return number

    def with_noted(connection: sqlite3.Connection, work: MeteredWork) -> None:
        install(connection, work)
        connection.create_function("noted", 1, noted)

    monkeypatch.setattr(Database, "_halt", noted_halt)
    monkeypatch.setattr(registry, "install", with_noted)
    monkeypatch.setattr(registry, "NAMES", registry.NAMES | {"noted"})
    with closing(forced(program, SLOW[what], think_seconds=60, think_steps=10**12)) as mind:
        with pytest.raises(Stopped):
            mind.think([row("Ada")], {}, stop=stop)
        assert len(after_the_halt) <= 1
        assert mind.query("Sensor", [row("Ada")], {}).rows


def test_a_stop_that_came_before_the_thought_prevents_it(program: Program) -> None:
    with closing(Mind(program)) as mind:
        stop = threading.Event()
        stop.set()
        with pytest.raises(Stopped):
            mind.think([row("Ada")], {}, stop=stop)
        stop.clear()
        assert mind.think([row("Ada")], {}, stop=stop)[0].memory == 1


def test_steps_are_those_of_all_robots(program: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    counts: list[bool] = []
    count = MeteredWork.count_steps

    def noted_count(work: MeteredWork) -> bool:
        counts.append(count(work))
        return counts[-1]

    monkeypatch.setattr(MeteredWork, "count_steps", noted_count)
    with closing(forced(program, ENDLESS, think_steps=3_000_000)) as mind:
        decisions = mind.think([row(f"Robot {number}") for number in range(20)], {})
        assert len(counts) * STEPS_AT_ONCE < 3_200_000 * 2  # once more exactly
        assert all("more than 3,000,000 steps" in d.notices[0].message for d in decisions)
        assert all(decision.is_reliable for decision in decisions)


@pytest.mark.parametrize(
    ("sql", "limits", "said"),
    [
        (NUMBERS + "SELECT n FROM t_0_N", {"think_rows": 50}, "more than 50 rows"),
        (f"SELECT {BIG}, {BIG}", {"result_bytes": 3_000_000}, "more than 3,000,000 bytes"),
        (
            "SELECT printf('%4000d', 1) || printf('%4000d', 1)",
            *({"value_bytes": 5_000}, "may have 5,000 bytes"),
        ),
        (ENDLESS, {"think_steps": 1_000_000}, "more than 1,000,000 steps"),
        ("SELECT '[[[[1]]]]' AS memory", {"depth": 3}, "nested too deeply"),
        (
            f"SELECT 'Ada' AS robot_name, substr({BIG}, 1, 200) AS memory",
            *({"memory_bytes": 100}, "more than 100"),
        ),
    ],
)
def test_each_limit_is_told(sql: str, limits: dict[str, Any], said: str, program: Program) -> None:
    decision = decision_of(forced(program, sql, **limits))
    assert decision.memory == "kept"
    assert any(said in notice.message for notice in decision.notices), decision.notices


def test_a_query_has_its_own_steps_and_shows_its_first_rows(program: Program) -> None:
    endless = forced(program, ENDLESS, query_steps=1_000_000)
    with closing(endless), pytest.raises(QueryError, match="more than 1,000,000 steps"):
        endless.query("Robot", [row("Ada")], {})
    with closing(forced(program, NUMBERS + "SELECT n FROM t_0_N", rows=10)) as mind:
        table = mind.query("Robot", [row("Ada")], {})
    assert (len(table.rows), table.truncated) == (10, True)
    with pytest.raises(ValueError, match="depth can't be negative"):
        Limits(depth=-1)


def test_the_memory_of_a_mind_is_bounded_and_the_next_program_thinks() -> None:
    script = """if True:
        import resource
        from dataclasses import replace
        from logical_robots_tui.mind import Limits, Mind, Predicate, Program
        from tests.mind.rows import row
        small = Limits(mind_bytes=40_000_000)
        grows = (
            "WITH RECURSIVE t_0_N(n, s) AS (SELECT 1, '' UNION SELECT n + 1, printf('%9000d', n) "
            "FROM t_0_N) SELECT count(*) FROM t_0_N"
        )
        program = Program("", (), {"Robot": grows})
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        mind = Mind(program, limits=small)
        (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
        assert "needs more than 40,000,000 bytes of memory" in decision.notices[0].message
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000
        mind.close()
        good = {"Robot": "SELECT 'Ada' AS robot_name, 1 AS memory"}
        after = Mind(replace(program, statements=good, tuned={}))
        assert after.think([row("Ada")], {})[0].memory == 1
    """
    assert python(script) == ""


@pytest.mark.sampled
@pytest.mark.parametrize("plain", [False, True])
def test_a_thought_out_of_memory_leaves_the_next_ones_as_they_were(plain: bool) -> None:
    program = Program.compile(
        ROBOT + "Memory(robot_name:, memory:), m = (if sensor.clock == 2 "
        "then List{Range(99999) :- a in Range(99999)} "
        'else [memory, Min{r.distance :- r in sensor.radar, r.object == "wall"}]);'
    )
    with closing(Mind(program, limits=Limits(think_steps=10**10), plain=plain)) as mind:
        rows = [row("Ada", clock=n, sees={3: (50, "wall", "wall")}) for n in range(4)]
        decisions = [mind.think([seen], {"Ada": "m"})[0] for seen in rows]
    assert [[n.kind for n in d.notices] for d in decisions] == [[], [], ["failed"], []]
    assert [decision.memory for decision in decisions] == [["m", 50], ["m", 50], "m", ["m", 50]]


def test_names_that_are_half_characters_do_no_harm(program: Program) -> None:
    assert decision_of(Mind(program), "\udfff", sees={1: (5, "area", "\ud800")}).memory == 1


@pytest.mark.parametrize("text", ['"a" ++ Chr(0) ++ "b"', '"{" ++ Chr(0)', "Chr(0)"])
def test_a_text_with_nul_is_read_as_it_was_written(text: str) -> None:
    program = (
        f"{ROBOT} Memory(robot_name:, memory:), m = {{written: {text}, read: memory.written}};"
    )
    first: Any = think(program, [row("Ada")], {"Ada": ""})[0].memory
    assert "\N{REPLACEMENT CHARACTER}" in first["written"]
    then: Any = think(program, [row("Ada")], {"Ada": first})[0].memory
    assert then["read"] == first["written"]
