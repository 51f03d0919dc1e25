"""Answers to the questions of a level are right by their rows, and wrong ones are told apart."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game.level_questions import Examiner, difference, mistake_lines
from logical_robots_tui.mind import ProgramError, ResultTable
from logical_robots_tui.values import Value
from logical_robots_tui.world import LevelError, load_level
from logical_robots_tui.world.level import LevelQuestion

AHEAD = LevelQuestion(
    "How far?", "Way(far: sensor.forward_distance) :- Sensor(sensor:)", (100, 300)
)
VALUES = st.one_of(
    *(st.none(), st.booleans(), st.integers(-3, 3), st.sampled_from(["Ada", "Bob", ""])),
    st.floats(-1e6, 1e6),
    st.dictionaries(st.sampled_from(["angle", "label"]), st.integers(0, 2)),
)


@st.composite
def tables(draw: st.DrawFn) -> ResultTable:
    columns = draw(st.permutations(["robot_name", "label", "far"]))[: draw(st.integers(1, 3))]
    rows = draw(st.lists(st.tuples(*[VALUES] * len(columns)), min_size=1, max_size=5))
    return ResultTable(tuple(columns), tuple(rows))


RIGHT = ResultTable(("robot_name", "far"), (("Ada", 1.5), ("Bob", 2), ("Cat", 2)))


@given(tables(), st.randoms(use_true_random=False))
def test_order_and_names_of_rows_and_columns_do_not_matter(
    right: ResultTable, random: Random
) -> None:
    rows, places = list(right.rows), list(range(len(right.columns)))
    random.shuffle(rows)
    random.shuffle(places)
    turned = tuple(tuple(row[place] for place in places) for row in rows)
    assert not difference(
        ResultTable(tuple(right.columns[place] for place in places), turned), right
    )
    assert not difference(ResultTable(tuple(f"col{place}" for place in places), turned), right)


@given(tables(), st.integers(0, 4))
def test_a_row_less_or_more_is_a_difference(right: ResultTable, place: int) -> None:
    place %= len(right.rows)
    assert difference(replace(right, rows=right.rows[:place] + right.rows[place + 1 :]), right)
    again = replace(right, rows=(*right.rows, right.rows[place]))
    assert "add distinct" in difference(again, right)


DAN: tuple[Value, ...] = ("Dan", 3)
WRONG: list[tuple[list[tuple[Value, ...]], str]] = [
    ([("Bob", 2), ("Ada", 1.5)], "its rows are right, but 1 row is missing."),
    ([*RIGHT.rows, DAN, ("Eve", 4)],
     'all the right rows are there, but 2 rows are too many, such as ("Dan", 3).'),
    ([("Ada", 1.5), DAN],
     '1 row is right, 1 row is too many, such as ("Dan", 3), and 2 rows are missing.'),
    ([*RIGHT.rows, ("Ada", 1.5)], "the rows are right, but 1 row is repeated: add distinct"),
    ([], "it gives no rows; 3 rows are expected."),
    ([DAN], "your only row is wrong; 3 rows are expected."),
    ([("Ada", 9), ("Bob", 9)], "all its 2 rows are wrong; 3 rows are expected."),
    ([("Ada", 1.5, 0)], "its rows have 3 columns instead of 2."),
]  # fmt: skip


def test_wrong_answers_are_told_apart_by_their_rows() -> None:
    for rows, said in WRONG:
        columns = ("robot_name", "far", "n")[: len(rows[0]) if rows else 2]
        assert difference(ResultTable(columns, tuple(rows)), RIGHT).startswith(said)


def test_columns_are_compared_by_name_and_one_that_a_query_names_by_itself_is_not() -> None:
    right = ResultTable(("one", "other"), (("Ada", "Bob"),))
    assert difference(ResultTable(("one", "other"), (("Bob", "Ada"),)), right)
    assert not difference(ResultTable(("other", "one"), (("Bob", "Ada"),)), right)
    right = ResultTable(("far",), ((200,),))
    assert not difference(ResultTable(("value", "robot_name"), ((200, "Ada"),)), right)
    for extra, said in ((), "your only row is wrong"), (("n",), "its rows have 2 columns instead"):
        columns, row = ("value", *extra, "robot_name"), (199, *extra, "Ada")
        assert difference(ResultTable(columns, (row,)), right).startswith(said)


def test_sums_of_the_same_numbers_are_equal_in_any_order() -> None:
    one, other = 0.1 + 0.2 + 0.3, 0.3 + 0.2 + 0.1  # sum() of Python 3.12 makes up for it
    assert one != other
    assert not difference(
        ResultTable(("n",), ((one,), (1e-14,))), ResultTable(("n",), ((other,), (0,)))
    )


@asynccontextmanager
async def examining(level: str) -> AsyncIterator[Examiner]:
    examiner = Examiner(load_level(level))
    try:
        yield examiner
    finally:
        await examiner.close()


async def test_an_answer_has_to_be_right_at_every_tick_and_what_is_wrong_is_shown() -> None:
    async with examining("1") as examiner:
        ticks: list[int] = []
        verdict = await examiner.check(AHEAD, "sensor.forward_distance", ticks.append)
        assert (verdict.is_right, verdict.words) == (
            True,
            "Right at ticks 100 and 300; these rows are from tick 300.",
        )
        assert not ticks or ticks[-1] == 300
        verdict = await examiner.check(AHEAD, "Way(far: 200);")
        assert (verdict.is_right, verdict.tick) == (False, 300)
        assert verdict.words.startswith("Right at tick 100, but at tick 300 your only row is wrong")
        verdict = await examiner.check(AHEAD, "Sensor(robot_name:)")
        assert verdict.table is not None
        assert verdict.table.rows == (("Ada",),)
        assert verdict.words == "At tick 100 your only row is wrong; 1 row is expected."
        too_much = ", ".join(f"{letter} in sensor.radar" for letter in "abcdefg")
        verdict = await examiner.check(AHEAD, f"Sensor(sensor:), {too_much}")
        assert not verdict.is_right
        assert "At tick 100 it gives" in verdict.words
        query = "Way(far: sensor.forward) :- Sensors(sensor:)"
        with pytest.raises(ProgramError) as caught:
            await examiner.check(AHEAD, query)
        line, caret, message = mistake_lines(query, caught.value)
        assert line == query
        assert caret.index("^") == query.index("Sensors")
        assert "Sensors" in message
        with pytest.raises(LevelError, match="own answer"):
            await examiner.check(AHEAD._replace(answer="Nonsense"), "sensor.forward_distance")


async def test_a_query_may_use_the_rules_of_the_program_and_sees_all_robots() -> None:
    question = LevelQuestion("Who is there?", "Sensor(robot_name:)", (120,))
    async with examining("5") as examiner:
        usable = {predicate.name for predicate in await examiner.predicates(question)}
        assert {"Sensor", "Memory", "Light", "Course", "Steer"} <= usable
        number = "Number(n? += 1) distinct :- Sensor(robot_name:)"
        assert (await examiner.rows(question, number, 120)).rows == ((3,),)
