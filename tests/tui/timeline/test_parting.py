"""In what two futures differ, as a page to read."""

from __future__ import annotations

from logical_robots_tui.game import Difference, Parting
from logical_robots_tui.tui.timeline.parting import told
from logical_robots_tui.values import Desire


def test_each_difference_is_told_with_as_many_digits_as_it_needs() -> None:
    parting = Parting(
        7,
        (
            Difference("Ada", "desire", Desire(0.5, 1.0), None),
            Difference("Ada", "position", (1.0, 2.0, 0.0), (1.0 + 2**-30, 2.0, 0.0)),
            Difference("Bo", "memory", {"n": 1}, "none"),
            Difference("Bo", "notices", (), ("Robot has no row for Bo.",)),
        ),
    )
    assert told(parting).plain.splitlines() == [
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


def test_where_only_an_area_differs_that_is_said() -> None:
    assert "an area" in told(Parting(3, ())).plain
