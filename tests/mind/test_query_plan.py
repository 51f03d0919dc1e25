"""How a predicate is computed: its SQL, the plan, the time."""

from contextlib import closing

import pytest

from logical_robots_tui.mind import Mind, Program, QueryError
from logical_robots_tui.mind.asking import plan_lines
from tests.mind.rows import PAPER, row


@pytest.mark.parametrize("plain", [False, True])
def test_the_sql_and_the_plan_are_those_of_what_is_run(plain: bool) -> None:
    with closing(Mind(Program.compile(PAPER), plain=plain)) as mind:
        found = mind.query_plan("Robot", [row("Ada")], {})
    assert bool(found.tuned) is not plain
    assert "SELECT" in found.generated
    assert any("Sensor" in line for line in found.plan)
    assert found.milliseconds > 0


def test_a_function_and_an_input_have_no_plan_and_steps_of_one_are_indented() -> None:
    with closing(Mind(Program.compile(PAPER))) as mind:
        for predicate, reason in (("FreedomMotion", "function of its arguments"), ("Sensor", None)):
            with pytest.raises(QueryError, match=reason):
                mind.query_plan(predicate, [row("Ada")], {})
    rows = [(2, 0, 0, "outer"), (5, 2, 0, "inner"), (7, 0, 0, "next")]
    assert plan_lines(rows) == ("outer", "  inner", "next")
