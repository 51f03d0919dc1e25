"""In what two futures differ, as a page to read."""

from logical_robots_tui.explain import Ask, Node
from logical_robots_tui.explain.why.probing import Span
from logical_robots_tui.game import Difference, Divergence
from logical_robots_tui.game.debugging.proof_difference import Comparison, ProofDifference
from logical_robots_tui.tui.timeline.divergence import derivation, describe_divergence
from logical_robots_tui.values import Desire


def test_each_difference_is_told_with_as_many_digits_as_it_needs() -> None:
    differences = (
        Difference("Ada", "desire", Desire(0.5, 1.0), None),
        Difference("Ada", "position", (1.0, 2.0, 0.0), (1.0 + 2**-30, 2.0, 0.0)),
        Difference("Bo", "memory", {"n": 1}, "none"),
        Difference("Bo", "notices", (), ("Robot has no row for Bo.",)),
    )
    assert "an area" in describe_divergence(Divergence(3, ())).plain, "only an area differs"
    assert describe_divergence(Divergence(7, differences)).plain.splitlines() == [
        "Ada",
        "  desire",
        "    here   left 0.5, right 1",
        "    there  none",
        "  position",
        "    here   1, 2, looking to 0°",
        "    there  1.0000000009313226, 2, looking to 0°",
        "",
        "Bo",
        "  memory",
        "    here   {n: 1}",
        '    there  "none"',
        "  notices",
        "    here   none",
        "    there  Robot has no row for Bo.",
    ]


def test_the_first_derivation_that_differs_is_told_with_lines_and_condition() -> None:
    here = Node("rule", "Drive(robot_name:) :- Explore()", holds=True, span=Span(0, 9, 35, ""))
    there = Node("rule", "Drive(robot_name:) :- Steer()", holds=True, span=Span(0, 9, 31, ""))
    differing = ProofDifference("rule", Ask("Drive", {"robot_name": "Ada"}), here, there)
    condition = Node("denial", "~Fresh(robot_name:)", holds=False)
    assert derivation(Comparison("Ada", differing, (condition, "there"))).plain.splitlines() == [
        'What Ada decides differs first in Drive(robot_name: "Ada")',
        "  here   line 35  Drive(robot_name:) :- Explore()",
        "  there  line 31  Drive(robot_name:) :- Steer()",
        "  ~Fresh(robot_name:) holds there and not here.",
    ]
    # A value, a failed step and nothing are told apart.
    asked, read = Ask("Robot", {}), Node("read", "memory.n", values=(3,))
    value = derivation(Comparison("Ada", ProofDifference("value", asked, read, None)))
    assert value.plain.splitlines()[1:] == ["  here   memory.n = 3", "  there  missing here"]
    failed, steer = Node("condition", "d < 20", holds=False), Ask("Steer", {"col0": 0.5})
    for difference, words in (
        (ProofDifference("step", asked, failed, None), "d < 20  does not hold"),
        (
            ProofDifference("step", steer, None, None),
            "What Ada decides differs first in Steer(0.5)",
        ),
        (None, "are equal"),
    ):
        assert words in derivation(Comparison("Ada", difference)).plain
