"""A pin finds its value again at any tick, or says why there is none."""

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game import MIND, Pin, PinReading, pin_of_cell, read
from logical_robots_tui.mind import QueryError, ResultTable

SCALARS = st.none() | st.booleans() | st.integers(-3, 3) | st.sampled_from(["a", "b", ""])
NAMES = ("robot_name", "label", "x", "y")


@st.composite
def tables(draw: st.DrawFn) -> ResultTable:
    columns = tuple(draw(st.lists(st.sampled_from(NAMES), min_size=1, unique=True)))
    row = st.tuples(*[SCALARS | st.lists(SCALARS, max_size=2) for _ in columns])
    return ResultTable(columns, tuple(draw(st.lists(row, min_size=1, max_size=6))))


@given(tables(), st.data())
def test_a_pinned_value_is_read_off_its_own_row(table: ResultTable, data: st.DataObject) -> None:
    row = data.draw(st.integers(0, len(table.rows) - 1))
    column = data.draw(st.sampled_from(table.columns))
    pin = pin_of_cell("P", table.columns, table.rows, row, column)
    if pin is not None:
        assert read(pin, table) == PinReading(table.rows[row][table.columns.index(column)])
        assert hash(pin) == hash(pin), "a pin is a key"
    elif len(table.rows) == 1:
        raise AssertionError("a single row can always be found")


@given(st.recursive(SCALARS, lambda v: st.lists(v) | st.dictionaries(st.text(), v)), st.data())
def test_a_part_of_a_value_is_found_by_its_way(value: object, data: st.DataObject) -> None:
    pin, part = Pin("P", "x"), value
    while isinstance(part, dict | list) and part:
        steps = list(part) if isinstance(part, dict) else list(range(len(part)))
        step = data.draw(st.sampled_from(steps))
        pin, part = pin.deeper((step,)), part[step]
    table = ResultTable(("x",), ((value,),))  # type: ignore[arg-type] # of any values
    assert read(pin, table) == PinReading(part)  # type: ignore[arg-type] # a part of it


def test_rows_are_counted_of_one_mind_or_of_all() -> None:
    table = ResultTable(("x",), ((1,), (2,), (2,)), viewers=("Ada", "Ada", "Bob"))
    assert read(Pin("P"), table).number == 3
    assert read(Pin("P", where=((MIND, "Ada"),)), table).number == 2
    assert read(Pin("P", "x", ((MIND, "Bob"),)), table).value == 2
    sighted = ResultTable(("robot_name", "x"), (("Bob", 2), ("Bob", 2)), viewers=("Ada", "Bob"))
    assert read(Pin("P"), sighted).number == 1
    assert read(Pin("P", "x", (("robot_name", "Bob"),)), sighted).value == 2
    assert Pin("P", "x", ((MIND, "Bob"), ("d", 4)), ("a", 1)).words == "P.x.a[1] for Bob, d 4"


def test_what_cant_be_read_says_why() -> None:
    table = ResultTable(("x", "y"), ((1, {"a": [1]}), (2, "text")))
    assert read(Pin("P"), QueryError("The program has no predicate P.")).problem
    assert read(Pin("P", "z"), table).problem == "P has no column z."
    assert read(Pin("P", "x", (("x", 3),)), table).problem == "No row."
    assert read(Pin("P", "y"), table).problem == "2 rows."
    for path in (("b",), ("a", 1), ("a", "b"), (0,)):
        assert read(Pin("P", "y", (("x", 1),), path), table).problem
    assert read(Pin("P", "y", (("x", 2),), (0,)), table).problem, "a text is not a list"
    assert pin_of_cell("P", ("x",), ((1,), (2,)), 0, "x") is None, "nothing else tells the rows"


def test_only_finite_numbers_and_truths_are_numbers() -> None:
    assert [PinReading(value).number for value in (True, 2)] == [1, 2]
    for value in ("2", None, [1], float("inf"), 10**400):
        assert PinReading(value).number is None
