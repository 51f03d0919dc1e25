"""Whatever a callback does ends in a notice, and is charged for."""

import builtins
import gc
import json
import operator
import sqlite3
import tracemalloc
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import thread_time
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.mind.sqlite import registry
from logical_robots_tui.mind.sqlite.budget import ChargedAggregate, MeteredWork, charge
from logical_robots_tui.mind.sqlite.registry import AGGREGATES
from logical_robots_tui.mind.sqlite.texts import REPLACED
from tests.mind.hostile.bounds import GROWTH, bounded_memory
from tests.mind.rows import ROBOT, decision_of, slow

SECONDS_OF_A_STEP = 4e-6
SECONDS_OF_A_CALL = 0.5  # whatever is parsed once
BYTES_OF_A_BYTE = 1.5
MANY = 10**12

EXCEPTIONS = [
    kind
    for _, kind in sorted(vars(builtins).items())
    if isinstance(kind, type)
    and issubclass(kind, Exception)
    and not issubclass(kind, UnicodeError | BaseExceptionGroup)
]
RAISED: list[Callable[[], BaseException]] = [
    KeyboardInterrupt,
    *EXCEPTIONS,
    lambda: UnicodeDecodeError("utf-8", b"\xed\xa0\x80", 0, 1, "invalid continuation byte"),
    lambda: UnicodeEncodeError("utf-8", "\ud800", 0, 1, "surrogates not allowed"),
    lambda: ExceptionGroup("several", [ValueError()]),
    SystemExit,
]

USES_ALL = f"""
{ROBOT} Memory(robot_name:, memory:), m = {{
  text: Upper(memory), all: Set{{x :- x in [2, 1]}}, first: AnyValue{{x :- x in [2, 1]}}
}};
"""


@pytest.fixture(scope="module")
def uses_all() -> Program:
    return Program.compile(USES_ALL)


def break_callback(mind: Mind, callback: str, error: Callable[[], BaseException]) -> None:
    def fail(*_: Any) -> Any:
        raise error()

    step = fail if callback == "step" else lambda *_: None
    finalize = fail if callback == "finalize" else lambda *_: "[]"
    aggregate = type("Failing", (), {"step": step, "finalize": finalize})
    tuned = mind._databases._tuned
    for database in (mind._databases.plain_tables, *([tuned._database] if tuned else [])):
        connection = database._connection
        if callback == "function":
            for name in ("upper_text", "upper"):
                connection.create_function(name, 1, fail)
        elif callback == "text":
            connection.text_factory = fail
        elif callback == "read":
            mind._databases._read_value = fail  # type: ignore[assignment]  # it is another function
        else:
            for name in ("list_of_distinct", "any_value"):
                connection.create_aggregate(name, 1, aggregate)


@pytest.mark.parametrize("callback", ["function", "step", "finalize", "text", "read"])
def test_every_exception_in_a_thought_is_a_notice(callback: str, uses_all: Program) -> None:
    for error in RAISED[:: 40 // settings().max_examples]:
        if callback in ("text", "read") and error in (KeyboardInterrupt, SystemExit, StopIteration):
            continue  # in our own code these have another meaning
        mind = Mind(uses_all)
        break_callback(mind, callback, error)
        decision = decision_of(mind)
        assert [n.kind for n in decision.notices] == ["failed"], error
        assert decision.memory == "kept"


HALF = (
    *("Set{Chr(55296) :- x in [1, 2]}", "Min{[Chr(55296)] :- x in [1, 2]}"),
    *("Upper(Chr(55296))", "{a: [Chr(56320), Chr(55296)]}"),
)


@pytest.mark.parametrize("memory", HALF)
def test_half_a_character_ends_no_game(memory: str) -> None:
    decision = decision_of(Mind(Program.compile(f"{ROBOT} m = {memory};")))
    assert decision.notices or "\ud800" not in str(decision.memory)


def test_a_function_of_another_kind_is_charged_for_as_well() -> None:
    work = MeteredWork(lambda: None)
    before = work.steps
    charge(lambda text: text * 2, work)("abcde")
    assert before - work.steps >= 15


ENTRIES = {
    **{name: arity for name, (arity, _) in {**registry._FUNCTIONS, **registry._MATHS}.items()},
    **{name: arities[-1] for name, (arities, _) in REPLACED.items()},
    **dict.fromkeys(registry._NULL_MEANS_ABSENT, 2),
}

NUMBERS = st.one_of(
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_infinity=True, allow_nan=False),
    st.sampled_from([0, -0.0, 1e300, 5e-324, 2**63 - 1, -(2**63), 1e308]),
)
ODD_TEXTS = ["", "a", "%s", "%2000000d", "%.99999999999f", "[", "{", "Inf", "NaN", "1e999"]
PARTS = ["a", "%d ", "%", "_a%", "ab", "\N{GRINNING FACE}", "ß", ",", "\x00", "9"]
TEXTS = st.one_of(
    st.text(max_size=50),
    st.sampled_from(ODD_TEXTS),
    st.builds(operator.mul, st.sampled_from(PARTS), st.integers(1, 20_000)),
)

ITEMS = st.sampled_from(
    ["1", '"a"', "null", "{}", "[]", '{"a":null}', '{"b":1,"a":[1]}', "1e999", "[[[]]]", '"[1]"']
)
NESTED = st.one_of(
    st.builds(lambda item, n: f"[{','.join([item] * n)}]", ITEMS, st.integers(0, 9_000)),
    st.builds(
        lambda item, n: "{" + ",".join(f'"{i}":{item}' for i in range(n)) + "}",
        ITEMS,
        st.integers(0, 9_000),
    ),
    st.builds(lambda n: "[" * n + "]" * n, st.integers(0, 9_000)),
    st.builds(lambda n: '{"a":' * n + "1" + "}" * n, st.integers(0, 3_000)),
    st.builds(
        lambda n: json.dumps([{"arg": str(i), "value": -i} for i in range(n)]),
        st.integers(0, 6_000),
    ),
    st.builds(lambda n: json.dumps([[1] * (n % 40) + [-i] for i in range(n)]), st.integers(0, 900)),
    st.lists(NUMBERS, max_size=20).map(json.dumps),
)
VALUES = st.one_of(st.none(), NUMBERS, TEXTS, NESTED)

NULLS = json.dumps(dict.fromkeys(map(str, range(9_000))))


@pytest.mark.sampled
@pytest.mark.parametrize("name", sorted(ENTRIES))
@given(data=st.data())
def test_a_call_takes_no_longer_than_it_is_charged_for(name: str, data: st.DataObject) -> None:
    count = ENTRIES[name] if ENTRIES[name] >= 0 else data.draw(st.integers(0, 6))
    check_call(name, [data.draw(VALUES) for _ in range(count)])


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("list_has", [f"[{','.join(['{}'] * 19_000)}]", NULLS]),
        ("sort_list", [json.dumps([[1] * 10 + [-i] for i in range(1_500)])]),
        ("formatted", ["%1999999d" * 50, *[1] * 50]),
        ("decimal_to_text", [1.5, 2_000_000_000]),
        ("regexp_extract", ["a" * 20_000, "(a?){500}b"]),
        ("round_to", [200, 2**63 - 1]),
        ("round_to", [2.5, -(2**63)]),
        ("compare_values", [NULLS, NULLS]),
    ],
)
def test_a_call_that_is_meant_to_take_long_is_charged_for(name: str, arguments: list[Any]) -> None:
    check_call(name, arguments)


def check_call(name: str, arguments: list[Any]) -> None:
    called = _registered.functions[name, len(arguments)]
    with charged_for_its_time(), suppress(Exception):
        called(*arguments)
    if None not in arguments:
        assert MANY - WORK.steps >= sum(len(a) for a in arguments if isinstance(a, str))


WORK = MeteredWork(lambda: None)


@contextmanager
def charged_for_its_time() -> Iterator[None]:
    """Assert that a block takes no longer than it is charged for, in this thread.

    Garbage is collected outside: how long that takes depends on all tests of this process.
    """
    WORK.steps = WORK.bytes = MANY
    gc.disable()
    try:
        start = thread_time()
        yield
        seconds, steps = thread_time() - start, MANY - WORK.steps
    finally:
        gc.enable()
    assert seconds <= SECONDS_OF_A_CALL + steps * SECONDS_OF_A_STEP, (seconds, steps)


class _Registered:
    """What is registered with a connection, to be called without one."""

    def __init__(self) -> None:
        self.functions: dict[tuple[str, int], Callable[..., Any]] = {}
        self.aggregates: dict[str, Callable[[], Any]] = {}

    def execute(self, _: str) -> Any:
        raise sqlite3.OperationalError  # as if SQLite had no mathematical functions

    def create_function(self, name: str, arity: int, function: Any, **_: Any) -> None:
        for count in range(60) if arity < 0 else (arity,):
            self.functions[name, count] = function

    def create_aggregate(self, name: str, _: int, make: Any) -> None:
        self.aggregates[name] = make


_registered = _Registered()
registry.install(_registered, WORK)  # type: ignore[arg-type]  # all that it uses


ROWS = st.lists(st.tuples(VALUES, VALUES, st.integers(-1, 5)), max_size=12)


@pytest.mark.sampled
@pytest.mark.parametrize("name", sorted(AGGREGATES))
@given(rows=ROWS, times=st.integers(1, 60))
@example(rows=[(NULLS, NULLS, 1), *[("{}", "{}", 1)] * 50], times=2)
@example(rows=[('[{"a":[1]},{"b":[2]}]', 1, 2)] * 100, times=10)
def test_an_aggregate_costs_its_work(name: str, rows: list[tuple[Any, ...]], times: int) -> None:
    made = _registered.aggregates[name]
    arity = AGGREGATES[name][0]
    assert isinstance(made(), ChargedAggregate)
    with charged_for_its_time():
        aggregate = made()
        for arguments in rows * times:
            with suppress(Exception):
                aggregate.step(*arguments[:arity])
        held = MANY - WORK.bytes
        with suppress(Exception):
            aggregate.finalize()
    assert held >= 0


@pytest.mark.sampled
@pytest.mark.parametrize("name", sorted(AGGREGATES))
@pytest.mark.parametrize(
    "item",
    ['{"a":{},"b":%d}', "[[%d]]", '"%d"', "%d", '[{"a":[]},%d]', "text%d", '[" \N{SNOWMAN}%d"]'],
)
def test_an_aggregate_holds_no_more_than_it_is_charged_for(name: str, item: str) -> None:
    made, arity = _registered.aggregates[name], AGGREGATES[name][0]
    values = [item % n for n in range(50 * settings().max_examples)]
    WORK.steps = WORK.bytes = MANY
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    aggregate = made()
    for value in values:
        with suppress(Exception):
            aggregate.step(*[value, value + " ", 5][:arity])
    held = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert held <= BYTES_OF_A_BYTE * (MANY - WORK.bytes) + 20_000


@pytest.mark.parametrize(
    ("count", "most", "growth"),
    [(8, 2 * 1024**2, 20 * 1024**2), slow(90, Limits().aggregate_bytes, GROWTH)],
)
def test_what_aggregates_hold_is_bounded(count: int, most: int, growth: int) -> None:
    sets = ", ".join(f"s{n}? Set= {{a: {{b: {{}}, c: x + {n}}}}}" for n in range(count))
    program = Program.compile(
        f"All({sets}) distinct :- x in Range(19000); {ROBOT} All(s0:), m = Size(s0);"
    )
    mind = Mind(program, limits=Limits(think_seconds=60, aggregate_bytes=most))
    with bounded_memory(growth):
        decision = decision_of(mind)
    assert [n.kind for n in decision.notices] == ["failed"]
    assert f"aggregates collect more than {most:,} bytes" in decision.notices[0].message
