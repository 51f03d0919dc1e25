"""The calls of a function in a robot's reasoning."""

from contextlib import closing

import pytest

from logical_robots_tui.explain import Explainer
from logical_robots_tui.mind import Mind, Program, QueryError
from tests.explain.asking import REST
from tests.mind.rows import row

TEXT = f"""
F(a) = a + 1;
G(a) = F(a) * 2;
Unused(a) = a;
P(x, F(x)) :- x in [1, 2, 1];
Q(F(5));
S(s) :- s == Sum{{G(x) :- x in [7, 8]}};
{REST}"""


def test_each_call_is_told_once_with_its_result_also_within_functions_and_aggregates() -> None:
    with closing(Mind(Program.compile(TEXT))) as mind:
        explainer = Explainer(mind, "Ada", [row("Ada")], {})
        assert {*explainer.calls("F").rows} == {(1, 2), (2, 3), (5, 6), (7, 8), (8, 9)}
        assert len(explainer.calls("F").rows) == 5
        assert sorted(explainer.calls("G").rows) == [(7, 16), (8, 18)]
        assert not explainer.calls("Unused").rows
        with pytest.raises(QueryError, match="P is not a function"):
            explainer.calls("P")
