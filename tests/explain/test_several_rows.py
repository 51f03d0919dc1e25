"""Why `Robot` has a row, where it has several."""

from __future__ import annotations

from contextlib import closing

from logical_robots_tui.explain import Explainer
from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import row


def test_of_several_rows_of_robot_the_last_one_is_explained_because_it_counts() -> None:
    rules = "".join(
        f"Robot(robot_name:, desire: {{left_engine: {n}, right_engine: 0}}, memory: {n}) :- "
        "Sensor(robot_name:);\n"
        for n in (1, 2)
    )
    with closing(Mind(Program.compile(rules))) as mind:
        explanation = Explainer(mind, "Ada", [row("Ada")], {}).why()
        (decision,) = mind.think([row("Ada")], {})
    assert explanation.row is not None
    assert explanation.row["memory"] == decision.memory == 2
    assert [rule.node.said for rule in explanation.rules] == [
        "gives 1 row, but not the last",
        "gives 1 row; this is the last",
    ]
