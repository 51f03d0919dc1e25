"""The questions of each lesson: each has an answer that has to be computed."""

import pytest

from logical_robots_tui.game.level_questions import Examiner, difference
from tests.levels.playing import LEVELS, load_level, slow

QUICK = "04"  # levels before this one have small programs
LONGEST = 180  # characters, three lines of a dialog
NOTHING = (None, False, 0, "")


@pytest.mark.sampled
@pytest.mark.parametrize("name", [pytest.param(name, marks=slow(name > QUICK)) for name in LEVELS])
async def test_a_query_answers_a_question_and_no_constant_does(name: str) -> None:
    level = load_level(name)
    assert 2 <= len({question.ask for question in level.questions}) <= 3
    examiner = Examiner(level)
    try:
        for question in level.questions:
            assert len(question.ask) <= LONGEST
            assert (await examiner.check(question, question.answer)).is_right
            first, *others = [
                await examiner.rows(question, question.answer, tick) for tick in question.ticks
            ]
            for right in (first, *others):
                assert any(value not in NOTHING for row in right.rows for value in row), question
            assert any(difference(first, other) for other in others), question
            predicates = await examiner.predicates(question)
            for predicate in (each.name for each in predicates if each.has_rows):
                there = await examiner.rows(question, predicate, question.ticks[0])
                assert difference(there, first), f"{predicate} answers {question.ask}"
    finally:
        await examiner.close()
