"""The line of the timeline, and in what two futures differ, as it is drawn."""

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game import MARK_KINDS, BranchDifference, Divergence, MarkKind
from logical_robots_tui.game.debugging.proof_difference import Comparison
from logical_robots_tui.tui.timeline.breakpoints import tick_of
from logical_robots_tui.tui.timeline.divergence import describe_comparison, describe_divergence
from logical_robots_tui.tui.timeline.widget import (
    DIVERGENCE,
    SIGNS,
    TRACKS,
    Scale,
    TimelineSpan,
    track,
)
from logical_robots_tui.values import Desire


def test_the_signs_can_be_told_apart_without_colours_and_are_one_column_wide() -> None:
    signs = [sign for sign, _, _ in (*SIGNS.values(), DIVERGENCE, *TRACKS)]
    assert (len(set(signs)), set(SIGNS)) == (len(signs), set(MARK_KINDS))
    assert all(len(sign) == 1 for sign in signs)


def test_the_past_the_known_and_the_other_future_look_different_and_where_one_stands() -> None:
    line = track(TimelineSpan(0, 5, 2, other_last=8, diverged=None), 12, lambda *_: False)
    assert line.plain == "━━━───┄┄┄   "
    line = track(TimelineSpan(0, 5, 2), 12, lambda *_: False)
    (reversed_,) = [span for span in line.spans if "reverse" in str(span.style)]
    assert (reversed_.start, reversed_.end) == (2, 3)
    # Of several marks in a column the most telling is shown.
    marks = {"memory": {0, 1, 2, 3, 4}, "notice": {1, 4}, "victory": {4}, "breakpoint": {2}}

    def has(kind: MarkKind, first: int, last: int) -> bool:
        return any(first <= tick <= last for tick in marks.get(kind, ()))

    assert track(TimelineSpan(0, 5, 5), 8, has).plain == "┷!◉┷★━  "
    assert track(TimelineSpan(0, 5, 5, diverged=1), 8, has).plain == "┷≠◉┷★━  "
    assert track(TimelineSpan(0, 5, 5), 3, has).plain == "!◉★"


OTHER = st.none() | st.integers(0, 90_000)


@given(st.integers(0, 50_000), st.integers(0, 40_000), OTHER, st.integers(1, 300))
def test_every_tick_has_its_column(first: int, ticks: int, other: int | None, width: int) -> None:
    last = first + ticks
    scale = Scale.to_hold(TimelineSpan(first, last, last, other), width)
    assert str(scale.ticks_per_column).rstrip("0") in ("1", "2", "5")
    for tick in {first, last, first + ticks // 3, max(other or 0, first)}:
        column = scale.column(tick)
        begin, end = scale.ticks(column)
        assert begin <= tick <= end
        assert 0 <= column < width


def test_a_tick_is_typed_as_a_number_or_as_so_many_ticks_from_here() -> None:
    ticks = {"120": 120, " 1,200 ": 1200, "+50": 150, "-50": 50, "- 5": 95}
    ticks_and_nonsense = ticks | dict.fromkeys(("", "ten", "1.5", "٣", "-"))
    assert {text: tick_of(text, 100) for text in ticks_and_nonsense} == ticks_and_nonsense


def test_each_difference_is_told_with_as_many_digits_as_it_needs() -> None:
    differences = (
        BranchDifference("Ada", "desire", Desire(0.5, 1.0), None),
        BranchDifference("Ada", "position", (1.0, 2.0, 0.0), (1.0 + 2**-30, 2.0, 0.0)),
        BranchDifference("Bo", "memory", {"n": 1}, "none"),
        BranchDifference("Bo", "notices", (), ("Robot has no row for Bo.",)),
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
