"""When thinking fails: which predicate it was, on whose rows, in plain words."""

import sqlite3
from typing import Any

import pytest

from logical_robots_tui.mind import Decision
from logical_robots_tui.mind.asking import in_plain_words
from tests.mind.rows import ROBOT, row, think

RULES = (
    "Heard(text) :- Memory(robot_name:, memory:), text = Join(memory, memory);"
    "Known(text) :- Heard(text);\n"
)
MEMORIES: dict[str, Any] = {"Ada": "no list", "Bo": None}


def decisions(**visible: Any) -> list[Decision]:
    return think(RULES + ROBOT + "Known(m);", [row("Ada"), row("Bo")], MEMORIES, **visible)


BLAMED = "Heard failed on the rows of Ada: "


def test_a_notice_names_the_predicate_that_failed_first_and_on_whose_rows() -> None:
    ada, bo = decisions()
    (notice,) = ada.notices
    assert notice.kind == "failed"
    assert notice.message == (
        f"{BLAMED}a function was given a value that it can't use, "
        "such as a string instead of a list."
    )
    assert [notice.kind for notice in bo.notices] in ([], ["no row"])
    for decision in decisions(memory="all", sensor="all"):
        (notice,) = decision.notices
        assert notice.message.startswith(BLAMED)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("malformed JSON", "neither a record nor a list"),
        ("user-defined function raised exception", "a value that it can't use"),
        ("parser stack overflow", "nested too deeply"),
        ("no such column: t_1_P.size", "a column size is used that does not exist"),
        ("no such column: P.col3", "a positional column is used that does not exist"),
        ("no such function: FARM_FINGERPRINT", "there is no function FARM_FINGERPRINT"),
        ('too many references to "json_each": max 65535', "combines too many predicates"),
        ("at most 64 tables in a join", "combines too many predicates"),
        ("too many arguments on function JSON_ARRAY", "has too many parts"),
        ("misuse of aggregate: SUM()", "an aggregate is used where"),
        ('near ".": syntax error', "it passes on a whole record"),
        ('near "SELECT": syntax error', "it can't be computed"),
    ],
)
def test_what_sqlite_says_is_told_in_plain_words(said: str, told: str) -> None:
    words = in_plain_words(sqlite3.OperationalError(said))
    assert told in words
    assert "SELECT" not in words
