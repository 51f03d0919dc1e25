"""Any query about a program: a call, an expression, conditions, whole rules; and its plan."""

from contextlib import closing
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Mind, Program, ProgramError, QueryError, ResultTable
from logical_robots_tui.mind.asking import plan_lines
from tests.mind.rows import PAPER, row, slow

PROGRAM = """\
# The last rule of this program has no semicolon, and then there is a comment.
Item("one", 1);
Item("two", 2);
Named(robot_name:, far: sensor.forward_distance) :- Sensor(robot_name:, sensor:);
Twice(x) = 2 * x;
Home() = "Base";
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :- Sensor(robot_name:)
# The end"""

IDLE = 'Robot(robot_name: "Ada", desire: {left_engine: 0, right_engine: 0}, memory: "");'
ROWS = [row("Ada"), row("Bo")]


def ask(query: str, text: str = PROGRAM, **visibility: Any) -> ResultTable:
    program = Program.compile(text)
    with closing(Mind(program, **(visibility or {"memory": "all", "sensor": "all"}))) as mind:
        return mind.ask(program.question(query), ROWS, {"Ada": {"seen": [1]}})


@pytest.mark.parametrize(
    ("query", "columns", "rows"),
    [
        ("Item(name, number)", ("name", "number"), (("one", 1), ("two", 2))),
        slow("Item(name, 2)", ("name",), (("two",),)),
        ("Item", ("col0", "col1"), (("one", 1), ("two", 2))),
        ("Memory", ("robot_name", "memory"), (("Ada", {"seen": [1]}), ("Bo", None))),
        ("Item(name, x), x > 1", ("name", "x"), (("two", 2),)),
        ("Item(name, x), y == Twice(x)", ("name", "x", "y"), (("one", 1, 2), ("two", 2, 4))),
        slow("Item(\n  name,\n  1)", ("name",), (("one",),)),
        ('Item("one", 1)', ("holds",), (("true",),)),
        ('Item("one", 2)', ("holds",), (("false",),)),
        ('~Item("one", 2)', ("holds",), (("true",),)),
        slow("1 < 2", ("holds",), (("true",),)),
        ('Item("one", 2) | Item("two", 2)', ("holds",), (("true",),)),
        slow('Item("one", 2) | 1 > 2', ("holds",), (("false",),)),
        ("1 + 1", ("value",), ((2,),)),
        ("Twice(21)", ("value",), ((42,),)),
        slow("Home()", ("value",), (("Base",),)),
        ("Sum{x :- Item(n, x)}", ("value",), ((3,),)),
        slow('if 1 < 2 then "a" else "b"', ("value",), (("a",),)),
        ("{a: 1, b: [2]}", ("value",), (({"a": 1, "b": [2]},),)),
        ("x in [1, 2], x != 1", ("x",), ((2,),)),
        ("Big(n) :- Item(n, x), x > 1", ("n",), (("two",),)),
        ("A(x) :- Item(n, x); B(x) :- A(x), x < 2;", ("x",), ((1,),)),
        ("# only a comment\nTwice(2) # and one more", ("value",), ((4,),)),
    ],
)
def test_what_is_asked_is_answered(query: str, columns: Any, rows: Any) -> None:
    table = ask(query)
    assert (table.columns, table.rows) == (columns, rows)


@pytest.mark.parametrize(
    ("query", "columns", "rows"),
    [
        ("sensor.clock", ("value", "robot_name"), ((1, "Ada"), (1, "Bo"))),
        ("robot_name", ("value", "robot_name"), (("Ada", "Ada"), ("Bo", "Bo"))),
        slow("Twice(sensor.clock)", ("value", "robot_name"), ((2, "Ada"), (2, "Bo"))),
        ("Sum{1 :- ray in sensor.radar}", ("value", "robot_name"), ((31, "Ada"), (31, "Bo"))),
        ("memory is null", ("robot_name",), (("Bo",),)),
        ("memory", ("value", "robot_name"), (({"seen": [1]}, "Ada"), (None, "Bo"))),
        ("sensor.clock < 2, x in [1]", ("x", "robot_name"), ((1.0, "Ada"), (1.0, "Bo"))),
        slow('robot_name == "Bo"', ("robot_name",), (("Bo",),)),
        ('Item("one", sensor.clock)', ("robot_name",), (("Ada",), ("Bo",))),
        ('Sensor(robot_name: "Bo", sensor:), x == sensor.clock', ("sensor", "x"), None),
        ("Sum{sensor.clock :- Sensor(sensor:)}", ("value",), ((2,),)),
        ("sensor in [1, 2]", ("sensor",), ((1.0,), (2.0,))),
    ],
)
def test_inputs_left_open_are_those_of_each_robot(query: str, columns: Any, rows: Any) -> None:
    found = ask(query)
    assert found.columns == columns
    assert rows is None or sorted(map(str, found.rows)) == sorted(map(str, rows))


def test_where_robots_reason_apart_each_answers_for_itself() -> None:
    table = ask("Named(robot_name:, far:)", memory="own", sensor="own")
    assert (table.rows, table.viewers) == ((("Ada", 200), ("Bo", 200)), ("Ada", "Bo"))
    facts = ask("Item(name, number)", memory="own", sensor="own")  # which are the same for all
    assert (facts.rows, facts.viewers) == ((("one", 1), ("two", 2)), ())


@pytest.mark.parametrize(
    ("query", "line", "column", "told"),
    [
        ("Items(x, y)", 1, 1, "Did you mean Item"),
        ("Item(x,\n  Twoce(y))", 2, 3, "Did you mean Twice"),
        ("Named(robot_name:, fra:)", 1, 20, "Did you mean far"),
        ("Item(x, y", 1, 5, "never closed"),
        ("Count([1]) > 3", 1, 1, "can't be computed: an aggregate is used where a plain"),
        ("", 1, 1, "The query is empty"),
        slow("  # nothing", 1, 1, "The query is empty"),
        ("Twice(y)", 1, 7, "y has no value"),
        slow("Item(n, x), y > x", 1, 13, "y has no value"),
        ("Twice()", 1, 1, "Twice needs a value for x"),
        ("Item(n, x), Item", 1, 13, "Item is named without its arguments"),
        ("x in Item", 1, 6, "Item is named without its arguments, so it has no value"),
        slow("WeightedAverage", 1, 1, "WeightedAverage is named without its arguments"),
        ("Twice", 1, 1, "function of its arguments"),
        ("Item(x) :- Sensor(x)", 1, 1, "The program already defines"),
        slow("Sensor(x) :- Item(x, y)", 1, 1, "The program already defines"),
        ("what this", 1, 1, "not a condition"),
        ('ReadFile("/etc/passwd")', 1, 1, "not available to robots"),
        ('SqlExpr("1", {})', 1, 1, "can't use SQL"),
        ("@Ground(Item);", 1, 1, "defines no predicate"),
        ("import a.b;", 1, 1, "import"),
    ],
)
def test_a_wrong_query_is_told_in_place(query: str, line: int, column: int, told: str) -> None:
    with pytest.raises(ProgramError) as caught:
        ask(query)
    first = caught.value.diagnostics[0]
    assert told in str(first)
    assert (first.line, first.column) == (line, column)


def test_a_query_that_fails_at_this_tick_says_why_and_one_may_have_the_name_of_questions() -> None:
    with pytest.raises(QueryError, match="neither a record nor a list"):
        ask('x in ["a"], x.field == 2')
    text = PROGRAM + "\n;Asked(1);"
    assert ask("Asked(x)", text).rows == ((1,),)
    assert ask("1 + 1", text).rows == ((2,),)


@settings(deadline=None)
@given(st.text(alphabet='Item(x, y)12:-;{}[]"~|&<=># \n', max_size=30))
def test_nonsense_is_refused_or_answered_and_never_stumbles(query: str) -> None:
    try:
        assert ask(query).columns
    except QueryError:
        pass
    except ProgramError as error:
        wrong = error.diagnostics
        lines = query.count("\n") + 1
        assert all(1 <= d.line <= lines and "gave up" not in d.message for d in wrong), wrong


@pytest.mark.parametrize(
    ("rules", "columns"),
    [
        ("P(a, b) = a + b :- a in [1], b in [2]", ("a", "b", "value")),
        ("P(1, a) :- a == 3; P(b, 2) :- b == 1", ("b", "a")),
        ("P(a, a: 2) :- a == 3", ("col0", "a")),
        ("P(a, a) :- a == 3", ("a", "col1")),
        ("P(value: 1) = 2", ("value", "logica_value")),
        ("F(n) :- In(n); A(1); P := F(In: A)", ("n",)),
    ],
)
def test_columns_are_called_like_the_parameters(rules: str, columns: tuple[str, ...]) -> None:
    with closing(Mind(Program.compile(f"{rules};\n{IDLE}"))) as mind:
        assert mind.query("P", [row("Ada")], {}).columns == columns


@pytest.mark.parametrize("plain", [False, True])
def test_the_sql_and_the_plan_are_those_of_what_is_run(plain: bool) -> None:
    with closing(Mind(Program.compile(PAPER), plain=plain)) as mind:
        found = mind.query_plan("Robot", [row("Ada")], {})
    assert bool(found.tuned) is not plain
    assert "SELECT" in found.generated
    assert any("Sensor" in line for line in found.plan)
    assert found.milliseconds > 0


def test_a_function_and_an_input_have_no_plan_and_steps_of_one_are_indented() -> None:
    with closing(Mind(Program.compile(PAPER))) as mind:
        for predicate, reason in (("FreedomMotion", "function of its arguments"), ("Sensor", None)):
            with pytest.raises(QueryError, match=reason):
                mind.query_plan(predicate, [row("Ada")], {})
    rows = [(2, 0, 0, "outer"), (5, 2, 0, "inner"), (7, 0, 0, "next")]
    assert plan_lines(rows) == ("outer", "  inner", "next")
