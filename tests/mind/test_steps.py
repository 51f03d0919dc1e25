"""Steps decide when a thought is ended; the clock is a guard, and marks what it ends."""

import threading
from contextlib import closing, nullcontext
from dataclasses import replace

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.mind import Limits, Mind, Program, QueryError
from logical_robots_tui.mind.sqlite import budget
from logical_robots_tui.mind.sqlite.budget import (
    STEPS_AT_ONCE,
    MeteredWork,
    QueryBudget,
    StepBudget,
)
from logical_robots_tui.mind.sqlite.database import Database, TooSlowError
from tests.mind.rows import ROBOT, decision_of, row
from tests.waiting import PATIENCE, until

COUNTS = (
    "WITH RECURSIVE t_0_N(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM t_0_N LIMIT {}) "
    "SELECT robot_name, max(n) AS memory FROM Sensor, t_0_N"
)


@pytest.fixture(scope="module")
def program() -> Program:
    return Program.compile(ROBOT + "m = 1;")


def ends(mind: Mind) -> str:
    (decision,) = mind.think([row("Ada")], {"Ada": "kept"})
    return "failed" if any("steps" in n.message for n in decision.notices) else "thought"


@pytest.mark.slow
def test_a_thought_near_its_bound_ends_the_same_whatever_was_thought_before(
    program: Program,
) -> None:
    counts = replace(program, statements={"Robot": COUNTS.format(30_000)}, tuned={})
    verdicts = set()
    for extra in range(0, 200 * STEPS_AT_ONCE, 10 * STEPS_AT_ONCE + STEPS_AT_ONCE // 2):
        with closing(Mind(counts, limits=Limits(think_steps=580 * STEPS_AT_ONCE + extra))) as mind:
            found = {ends(mind) for _ in range(7)}
        assert len(found) == 1, extra
        verdicts |= found
    assert verdicts == {"failed", "thought"}


def test_between_two_thoughts_nothing_is_counted_or_ended() -> None:
    work = MeteredWork(lambda: None)
    budget = StepBudget(STEPS_AT_ONCE, 1.0)
    work.begin(budget, None)
    assert [work.count_steps(), work.count_steps()] == [False, True]
    work.end()
    assert budget.steps == -STEPS_AT_ONCE
    assert not work.count_steps()


def test_calls_of_functions_and_what_passes_through_them_are_counted(program: Program) -> None:
    text = "SELECT 'Ada' AS robot_name, natural_hash(printf('%1000000s', 'x')) AS memory"
    forced = replace(program, statements={"Robot": text}, tuned={})
    for steps, wanted in ((900_000, "failed"), (1_100_000, "thought")):
        with closing(Mind(forced, limits=Limits(think_steps=steps))) as mind:
            assert ends(mind) == wanted


def test_what_the_clock_ends_is_marked(program: Program) -> None:
    slow = replace(program, statements={"Robot": COUNTS.format(10**9)}, tuned={})
    decision = decision_of(Mind(slow, limits=Limits(think_steps=10**12, think_seconds=0.1)))
    (notice,) = decision.notices
    assert (notice.kind, decision.memory, decision.is_reliable) == ("late", "kept", False)
    assert "after 0.1 seconds" in notice.message


def test_the_guard_counts_no_time_in_which_it_could_not_look() -> None:
    halted: list[bool] = []
    work = MeteredWork(lambda: halted.append(True))
    budget = StepBudget(1, 1.0)
    work.begin(budget, None)
    work.end()
    for _ in range(9):
        work.spend_seconds(0.1)
    assert not halted
    work.spend_seconds(0.2)
    assert halted
    assert budget.is_late


def test_what_was_computed_while_nothing_was_watched_is_nobodys_work(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    computed = [0.0]
    monkeypatch.setattr(budget, "process_time", lambda: computed[0])
    watchdog = budget._Watchdog()
    monkeypatch.setattr(budget, "_watchdog", watchdog)
    asleep, wait = threading.Event(), watchdog._wake.wait

    def sleep() -> None:
        asleep.set()
        wait()
        asleep.clear()

    monkeypatch.setattr(watchdog._wake, "wait", sleep)
    looks: list[float] = []
    monkeypatch.setattr(MeteredWork, "spend_seconds", lambda _work, seconds: looks.append(seconds))
    for _ in range(2):
        work = MeteredWork(lambda: None)
        work.begin(StepBudget(1, 1.0), None)
        looks.clear()
        until(lambda: len(looks) > 1)
        work.end()
        assert sum(looks) == 0.0
        assert asleep.wait(PATIENCE)
        computed[0] += 100.0


def test_functions_that_are_offered_and_aggregates_are_counted() -> None:
    text = "printf('%1000000s', 'x')"
    for sql in (f"SELECT measured({text})", f"SELECT list_of_distinct({text})"):
        for steps, is_enough in ((900_000, False), (1_500_000, True)):
            with closing(Database(Limits())) as database:
                database.register("measured", len)
                within = QueryBudget(steps, 30.0, 10, None)
                with nullcontext() if is_enough else pytest.raises(TooSlowError):
                    database.ask(sql, max_rows=10, budget=within)
                assert not within.remainder.is_late


NESTED = "".join(f"F{n}(x) = F{n + 1}(x);\n" for n in range(12)) + "F12(x) = Length(x);\n"


def test_what_a_proof_does_between_its_queries_is_counted() -> None:
    """Each call of the chain has a text of 100,000 characters as its argument."""
    program = Program.compile(NESTED + ROBOT + "Memory(robot_name:, memory: t), m = F0(t);")
    found = {}
    for steps in (1_000_000, 200_000_000):
        with closing(Mind(program, limits=Limits(query_steps=steps))) as mind:
            try:
                proof = Explainer(mind, "Ada", [row("Ada")], {"Ada": "x" * 100_000}).proof()
                said = [f"{n.text}: {n.remark}" for root in proof.nodes for _, n in root.walk()]
                found[steps] = [words for words in said if "steps" in words]
            except QueryError as error:
                found[steps] = [str(error)]
    assert found[200_000_000] == []
    assert "more than 1,000,000 steps" in found[1_000_000][0]
