"""Columns that are called like a word of SQL."""

from contextlib import closing

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import ROBOT, row, think

WAY = """
@Recursive(Reach, 3);
Step(from: "a", to: "b", order: 1);
Step(from: "b", to: "c", order: 2);
Far(to:, order? Max= order, set? List= from) distinct :- Step(from:, to:, order:);
Reach(from:, to:) distinct :- Step(from:, to:) | Step(from:, to: x), Reach(from: x, to:);
"""

TEXT = f"""{WAY}{ROBOT}
  Far(to:, order:, set:), to == "c",
  values == List{{x :- Reach(from: "a", to: x)}},
  where == Sum{{n :- Step(order: n)}},
  m = {{to:, order:, set:, values:, where:}};"""


def test_such_columns_are_columns_like_any_other_also_in_the_inspector() -> None:
    decisions = think(TEXT, [row("Ada"), row("Bo")], {})
    expected = {"to": "c", "order": 2, "set": ["b"], "values": ["b", "c"], "where": 3}
    assert [d.memory for d in decisions] == [expected, expected]
    for plain in (True, False):
        with closing(Mind(Program.compile(TEXT), plain=plain)) as mind:
            table = mind.query("Reach", [row("Ada")], {})
        assert table.columns == ("from", "to")
        assert set(table.rows) == {("a", "b"), ("a", "c"), ("b", "c")}
