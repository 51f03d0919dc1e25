"""The common type of several is a least upper bound, whatever their order."""

from functools import reduce

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.language.types import (
    SENSOR,
    Decimal,
    Kind,
    ListOf,
    Plain,
    RecordOf,
    common,
    parse_spelling,
    spell,
)

KINDS: st.SearchStrategy[Kind] = st.recursive(
    st.sampled_from(Plain) | st.builds(Decimal, st.integers(0, 5), st.integers(1, 9)),
    lambda inner: (
        st.builds(ListOf, inner)
        | st.dictionaries(st.sampled_from("abc"), inner, max_size=3).map(
            lambda fields: RecordOf(tuple(fields.items()))
        )
    ),
    max_leaves=6,
)


def ordered(kind: Kind) -> object:
    """A type without the order of fields, which says nothing about values."""
    if isinstance(kind, RecordOf):
        return {name: ordered(of) for name, of in kind.fields}
    return [ordered(kind.element)] if isinstance(kind, ListOf) else kind


@given(st.lists(KINDS, min_size=1, max_size=4))
def test_the_order_does_not_matter(kinds: list[Kind]) -> None:
    assert ordered(common(kinds)) == ordered(common(reversed(kinds)))


@given(KINDS)
def test_a_type_has_itself_in_common_with_itself_and_is_read_back_as_spelled(kind: Kind) -> None:
    assert common([kind, kind]) == kind
    assert common([kind, Plain.NULL]) == kind
    assert spell(parse_spelling(spell(kind))) == spell(kind)


@given(KINDS, KINDS)
def test_what_is_common_to_both_is_common_to_it_and_either(one: Kind, other: Kind) -> None:
    both = common([one, other])
    assert ordered(common([both, one])) == ordered(both)
    assert ordered(reduce(lambda a, b: common([a, b]), (one, other, one))) == ordered(both)


def test_the_sensor_has_the_fields_of_the_schema() -> None:
    assert isinstance(SENSOR, RecordOf)
    radar = SENSOR.field("radar")
    assert isinstance(radar, ListOf)
    assert isinstance(radar.element, RecordOf)
    assert radar.element.field("label") is Plain.TEXT
    assert SENSOR.field("no such field") is Plain.ANY
