"""Recursion: who may say how far it goes, where it stops, and what it says if it is cut off."""

import pytest

from logical_robots_tui.mind import Program, ProgramError
from tests.mind.differential.comparing import here
from tests.mind.rows import ROBOT, row, slow, think

ONE = "A(0); A(n + 1) :- A(n), n < 5000;"
CIRCLE = "A(0); A(n + 1) :- C(n); B(n + 1) :- A(n); C(n + 1) :- B(n);"


def last(rules: str) -> object:
    """The largest number of the predicate A."""
    ((value,),) = here(f"{rules} Answer(value: Max{{n :- A(n)}});")
    return value


@pytest.mark.parametrize(("member", "found"), [("A", 30), slow("B", 33), ("C", 33)])
def test_any_member_of_a_circle_may_say_how_far_it_goes(member: str, found: int) -> None:
    assert last(f"@Recursive({member}, 10); {CIRCLE}") == found


STOPPED = {
    f"@Recursive(A, 100, stop: Found); {ONE} Found() :- A(n), n > 5;": 6,
    f"@Recursive(A, -1, stop: Found); {ONE} Found() :- A(n), n > 5;": 6,
    # What stops it may compare a step with the one before.
    "@Recursive(A, 50, stop: Found); A(0); A(n + 1) :- A(n), n < 5; A(n + 10) :- A(n), n > 99;"
    "Before(n) :- A(n); Found() :- Max{n :- A(n)} == Max{n :- Before(n)};": 5,
    f"@Recursive(B, 9, stop: Found); {ONE.replace('A', 'B')} Found() :- B(3); A := B();": 3,
}


@pytest.mark.parametrize("rules", STOPPED, ids=["steps", "no end", "the one before", "a copy"])
def test_a_recursion_stops_once_a_predicate_has_a_row(rules: str) -> None:
    assert last(rules) == STOPPED[rules]


@pytest.mark.parametrize("mode", ["iterative", "vertical", slow("diamond"), slow("horizontal")])
def test_each_way_to_iterate_gives_the_same(mode: str) -> None:
    assert last(f'@Recursive(A, 20, mode: "{mode}"); {ONE}') == 20


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("wings: 2", "@Recursive has no option wings"),
        ('mode: "sideways"', "@Recursive can't use this value of mode"),
        ("stop: 3", "@Recursive can't use this value of stop"),
    ],
)
def test_an_option_that_means_nothing_is_refused(option: str, message: str) -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile(f"\n@Recursive(A, 20, {option}); {ONE} {ROBOT}m = 1;")
    assert [(d.line, d.message) for d in caught.value.diagnostics] == [(2, message)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rules", "found"),
    [
        (ONE, 1000),
        ("A(0) distinct; A(n + 1) distinct :- A(n), n < 990;", 990),
        ("E(n, n + 1) :- n in Range(200); A(0) distinct; A(y) distinct :- A(x), E(x, y);", 200),
        ("E(n, 2 * n) :- n in Range(99); A(1) distinct; A(y) distinct :- A(x), E(x, y);", 128),
    ],
)
def test_a_thousand_steps_over_small_tables_are_within_the_budget(rules: str, found: int) -> None:
    text = f"@Recursive(A, 1000); {rules} {ROBOT}m == Max{{n :- A(n)}};"
    assert [decision.memory for decision in think(text, [row("Ada")], {})] == [found]


def test_a_recursion_that_is_cut_off_says_so_at_its_line_and_what_to_do() -> None:
    (decision,) = think(f"# far\n\n{ONE}\n{ROBOT}m == Max{{n :- A(n)}};", [row("Ada")], {})
    (notice,) = decision.notices
    assert notice.message == (
        "Line 3: The recursion of A was still growing after 32 steps; later rows are missing. "
        "Add a condition that ends it, or allow more steps with @Recursive(A, N)."
    )
    (warning,) = Program.compile(f"@Recursive(A, 5000); {ONE} {ROBOT}m = 1;").warnings
    assert (warning.line, warning.severity) == (1, "warning")
    assert "at most 1,000 steps" in warning.message
