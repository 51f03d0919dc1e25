"""Questions of a player's own: a predicate with values, as Logica writes it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.explain import Ask, calls
from logical_robots_tui.explain.why.explanation import read_call, spell_call
from logical_robots_tui.language.diagnostics import ProgramError
from logical_robots_tui.values import Value

NAMES = st.text(st.sampled_from("az_09"), max_size=6).map(lambda rest: f"n{rest}")
LEAVES = (
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(-1e9, 1e9).map(lambda x: round(x, 6))
    | st.text(
        st.sampled_from("aZ09äß☃\U0001d538 \u00a0\n\t\x01\x7f\x85\u2028\"'`\\#/(){}[],.:;=-"),
        max_size=12,
    )
)
VALUES = st.recursive(
    LEAVES,
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, min_size=1, max_size=3)
    ),
    max_leaves=6,
)


@given(st.lists(VALUES, max_size=3), st.dictionaries(NAMES, VALUES, max_size=3))
def test_a_written_question_can_be_read_again(
    in_place: list[Value], named: dict[str, Value]
) -> None:
    columns = {f"col{place}": value for place, value in enumerate(in_place)}
    asked = Ask("Pred", {**columns, **named})
    called = calls.read_call(spell_call(asked))
    assert (called.predicate, called.given) == (asked.predicate, asked.given)


def test_what_has_no_value_is_left_open() -> None:
    for text, asked in {
        "Robot": Ask("Robot"),
        "Next(robot_name:, ray:)": Ask("Next"),
        "Speed(d)": Ask("Speed"),
        'Next(robot_name: "Crow", ray:)': Ask("Next", {"robot_name": "Crow"}),
        "Speed(-0.5) == 3": Ask("Speed", {"col0": -0.5, "logica_value": 3}),
    }.items():
        assert read_call(text) == asked


def test_nonsense_is_refused_with_the_reason() -> None:
    for text, message in {
        "": "The query is empty",
        "x > 5": "This is not a predicate with values",
        "12": "This is not a predicate with values",
        "A(1), B(2)": "These are several conditions",
        "Speed(1 + 2)": "This is not a value",
        "Speed(F(2))": "This is not a value",
        "Speed(1": "bracket",
        'Speed("a)': "This string is never closed",
        "Speed(1).x == 2": "This is not a predicate with values",
    }.items():
        with pytest.raises(ProgramError, match=message):
            read_call(text)
