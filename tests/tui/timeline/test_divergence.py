"""In what two futures differ, as a page to read."""

from logical_robots_tui.game import Difference, Divergence
from logical_robots_tui.game.debugging.proof_difference import Comparison
from logical_robots_tui.tui.timeline.divergence import describe_comparison, describe_divergence
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


def test_lines_of_proofs_are_told_by_their_branch() -> None:
    lines = (" Robot()", "-  d < 20 does not hold", "+  d < 30 = true", "@", " [x]")
    assert describe_comparison(Comparison("Ada", lines)).plain.splitlines() == [
        "The proofs of what Ada decides differ:",
        "         Robot()",
        "  here     d < 20 does not hold",
        "  there    d < 30 = true",
        "  …      ",
        "         [x]",
    ]
    assert "are equal" in describe_comparison(Comparison("Ada", ())).plain
    many = describe_comparison(Comparison("Ada", ("+x",) * 1_300)).plain
    assert many.endswith("and 1,100 more lines")
