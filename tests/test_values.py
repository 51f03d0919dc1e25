"""Values as programs write them."""

from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from logical_robots_tui.values import Value, read_value, spell

VALUES: st.SearchStrategy[Any] = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**63)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=12,
)


@given(VALUES)
@example({"a b": '{x: 1, "y": 2}', "true": 'x: "', "n": None})
def test_what_is_written_is_read_back(value: Value) -> None:
    written = spell(value)
    assert written.isprintable()
    assert read_value(written) == value


@pytest.mark.parametrize(
    ("value", "written"),
    [
        ({"ray": {"angle": 0.5}, "is near": None}, '{ray: {angle: 0.5}, "is near": null}'),
        ([True, "12", 12], '[true, "12", 12]'),
    ],
)
def test_records_and_lists_look_as_in_a_program(value: Value, written: str) -> None:
    assert spell(value) == written


def test_json_is_read_as_well() -> None:
    assert read_value('{"a": [1, {"b": null}]}') == {"a": [1, {"b": None}]}


@pytest.mark.parametrize(
    "text", ["'\\x1'", "'\n'", '"\\u12"', "[" * 100_000, "9" * 5_000, "'\ud800'"]
)
def test_what_is_not_a_value_is_refused(text: str) -> None:
    words = "escape|codec|Unterminated|unterminated|recursion|digits"
    with pytest.raises(ValueError, match=words):
        read_value(text)
