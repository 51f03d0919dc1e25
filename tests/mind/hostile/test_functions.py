"""No function that a program may call answers with too much, whatever it is given."""

import itertools
import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager

import pytest

from logical_robots_tui.mind import Limits
from logical_robots_tui.mind.sqlite import registry
from logical_robots_tui.mind.sqlite.budget import MAX_ITEMS, MAX_TEXT
from logical_robots_tui.mind.sqlite.database import BUILT_IN, Database, TooMuchError
from tests.mind.hostile.bounds import bounded_memory

ITEMS = MAX_ITEMS - 10
VALUES = {
    "text": "a" * (MAX_TEXT - 100),
    "nearly": ("a" * (MAX_TEXT // 2 - 100)) + "b",
    "wide": "\N{GRINNING FACE}" * (MAX_TEXT // 4 - 100),
    "odd": "".join(map(chr, range(0x100, 0x2000))),
    "ones": "[" + ",".join("1" * (MAX_TEXT // 2 - 100)) + "]",
    "items": json.dumps(list(range(ITEMS))),
    "texts": json.dumps([str(number) * 9 for number in range(ITEMS)]),
    "lists": json.dumps([[]] * (ITEMS // 2)),
    "pairs": json.dumps([{"arg": str(n), "value": n} for n in range(ITEMS // 3)]),
    "record": json.dumps({str(number): number for number in range(ITEMS)}),
    "deep": "[" * 900 + "]" * 900,
    "very deep": "[" * 100_000 + "]" * 100_000,
    "quotes": '"' * (MAX_TEXT // 2 - 100),
    "digits": "1" * (MAX_TEXT - 100),
    "wild": "%_a" * 300,
    "letter": "a",
    "path": "$[90000]",
    "format": f"%{MAX_TEXT - 10}s",
    "type": '{"a": "Str"}',
    "number": MAX_TEXT - 10,
    "large": 1e300,
}
PAIRED = ("text", "nearly", "wide", "odd", "items", "texts", "record", "wild", "letter", "number")
THREE = itertools.product(
    ("text", "nearly", "items"), ("nearly", "letter", "number"), ("text", "letter", "number")
)
ARGUMENTS = [(), *((v,) for v in VALUES), *itertools.product(PAIRED, repeat=2), *THREE]


@contextmanager
def filled() -> Iterator[Database]:
    with closing(Database(Limits(think_steps=10**12, think_seconds=60))) as database:
        database.load(list(VALUES.items()), [])
        yield database


@pytest.fixture(scope="module")
def database() -> Iterator[Database]:
    with filled() as database:
        yield database


FUNCTIONS = sorted(BUILT_IN | registry.NAMES)


@pytest.mark.sampled
@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_call_answers_with_too_much(name: str, database: Database) -> None:
    with bounded_memory():
        for arguments, length in called(name, database):
            assert (length or 0) <= MAX_TEXT, arguments


def called(name: str, database: Database) -> Iterator[tuple[tuple[str, ...], int | None]]:
    """Call a function with everything; how long each answer is as a text, None if there is none."""
    impossible = set()
    for arguments in ARGUMENTS:
        if len(arguments) in impossible:
            continue
        call = ", ".join(f"(SELECT sensor FROM Sensor WHERE robot_name = '{a}')" for a in arguments)
        length = None
        try:
            ((length,),) = database.ask(f"SELECT length({name}({call}))", max_rows=1)[1]
        except sqlite3.Error as error:
            if "wrong number" in str(error) or "no such function" in str(error):
                impossible.add(len(arguments))
        except TooMuchError:
            pass
        yield arguments, length


TOO_LARGE = [
    *(("ones", call) for call in ("try_cast(x, '[\"Num\"]')", "try_cast_like(x, '[1]')")),
    *(("ones", call) for call in ("to_text(x)", 'try_cast(x, \'{"a": "Num"}\')')),
    *(("very deep", call) for call in ("record_as_json(x)", "value_as_json(x)", "sort_list(x)")),
    *(
        ("very deep", call)
        for call in ("compare_values(x, x)", "list_has(x, 1)", "concatenate(x, x)")
    ),
    *(
        ("very deep", call)
        for call in ("least_nested(x)", "list_of_distinct(x)", "concat_lists(x)")
    ),
]


@pytest.mark.parametrize(("value", "call"), TOO_LARGE)
def test_what_has_too_many_items_or_levels_is_too_large(value: str, call: str) -> None:
    values = f"(SELECT sensor AS x FROM Sensor WHERE robot_name = '{value}')"
    # A database of its own: where memory runs out, SQLite takes back what was loaded.
    with filled() as database, pytest.raises(TooMuchError, match="a value became too large"):
        database.ask(f"SELECT {call} FROM {values}", max_rows=1)


LIKE = [
    *(("", "", True), ("", "%", True), ("a", "", False), ("abc", "abc", True)),
    *(("abc", "ABC", False), ("abc", "a%", True), ("abc", "%c", True), ("abc", "%b%", True)),
    *(("abc", "a_c", True), ("abc", "a__c", False), ("aba", "ab%ba", False)),
    *(("abba", "ab%ba", True), ("a.c", "a.c", True), ("abc", "a.c", False)),
    *(("aXbXc", "a%X_", True), ("line\nline", "l_ne%l%e", True), ("aaab", "%a%a%a%a%b", False)),
]


def test_like_is_like(database: Database) -> None:
    for text, pattern, wanted in LIKE:
        rows = database.ask(f"SELECT '{text}' LIKE '{pattern}'", max_rows=1)[1]
        assert rows == [(wanted,)], (text, pattern)


REPLACED = [
    *("instr('abc', 'c')", "instr('abc', '')", "instr('abc', 'x')", "instr(12345, 34)"),
    *("replace('abcabc', 'b', 'xy')", "replace('abc', '', 'x')", "replace(121, 1, 3)"),
    *("trim('  a ')", "ltrim('xxa', 'x')", "rtrim('axyx', 'xy')", "trim(NULL)"),
    *("replace('a', NULL, 'b')", "'50%' LIKE '50!%' ESCAPE '!'"),
]


def test_a_replaced_function_gives_what_that_of_sqlite_gives(database: Database) -> None:
    with closing(sqlite3.connect(":memory:")) as plain:
        for expression in REPLACED:
            wanted = plain.execute(f"SELECT {expression}").fetchone()
            assert database.ask(f"SELECT {expression}", max_rows=1)[1] == [wanted], expression
