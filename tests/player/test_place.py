"""Where a game stands, as another session reads it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.player.recovery import GamePosition

texts = st.text(st.characters(codec="utf-8"))
teams = st.dictionaries(texts, texts, min_size=1, max_size=3)


@st.composite
def places(draw: st.DrawFn) -> GamePosition:
    later = draw(st.sets(st.integers(2, 20_000), max_size=4))
    programs = tuple((begin, draw(teams)) for begin in (1, *sorted(later)))
    last = programs[-1][0]
    return GamePosition(
        draw(texts), draw(texts), draw(texts), draw(st.integers(last, last + 100)), programs
    )


@given(places())
def test_a_place_is_read_as_it_was_written(place: GamePosition) -> None:
    assert GamePosition.from_text(place.as_text()) == place


@given(places())
def test_the_programs_follow_each_other_up_to_the_tick(place: GamePosition) -> None:
    stretches = place.segments()
    assert [each for each, _ in stretches] == [each for _, each in place.programs]
    assert stretches[-1][1] == place.tick
    assert [end + 1 for _, end in stretches[:-1]] == [begin for begin, _ in place.programs[1:]]


@given(texts)
def test_nonsense_is_not_a_place(text: str) -> None:
    with pytest.raises(ValueError, match="not a place"):
        GamePosition.from_text(text)


def place_at_5(rest: str) -> GamePosition:
    return GamePosition.from_text(f'{{"level": "", "title": "", "program": "", "tick": 5, {rest}}}')


def test_programs_out_of_order_are_not_place() -> None:
    twice, late, empty = '[[1, ""], [1, ""]]', '[[1, ""], [9, ""]]', '[[1, ""], [2, {}]]'
    for programs in ("[]", '[[2, ""]]', twice, late, "[[1, {}]]", empty):
        with pytest.raises(ValueError, match="out of order"):
            place_at_5(f'"programs": {programs}')


def test_a_speed_that_there_is_not_is_the_usual_one() -> None:
    for speed, wanted in (("160.0", 160.0), ("null", None), ("41.0", 40.0)):
        assert place_at_5(f'"programs": [[1, ""]], "speed": {speed}').speed == wanted
