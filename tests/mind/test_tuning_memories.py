"""Lists in memories, totals, what stays one object: the quick way gives what the plain one does."""

import json
import re
from collections import OrderedDict
from contextlib import closing
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.schemas import EXAMPLE, TYPE
from benchmarks.subjects import program_text
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.mind.sqlite import tables
from logical_robots_tui.mind.sqlite.layouts import insertions
from logical_robots_tui.mind.tuning import tune
from tests.mind.rows import ROBOT, nearly_same, remembered, row, slow, think

TOLD = Path(__file__).with_name("roads.l").read_text("utf-8")

number = st.integers(-3, 3) | st.sampled_from([0.5, -2.25, 1e15, float("inf"), float("-inf")])
value = st.none() | st.booleans() | number | st.sampled_from(["A", "B", "", "é", '{"a":1}'])
record = st.fixed_dictionaries(
    {}, optional={"start": value, "length": value | st.just({"deep": [1]}), "doubt": number | value}
)
usual = st.fixed_dictionaries(
    {"start": st.sampled_from("ABC"), "length": number, "doubt": st.integers(0, 2)}
)
roads = st.lists(usual, max_size=40) | st.lists(record, max_size=5)
odd = value | st.lists(record | value, max_size=4) | record
memory = st.fixed_dictionaries({}, optional={"report": roads | odd, "roads": roads}) | value


@pytest.mark.parametrize("visible", [slow("own"), "seen", "all"])
def test_whatever_lists_hold_both_ways_give_the_same(visible: Any) -> None:
    program = Program.compile(TOLD)
    tuned, plain = (Mind(program, memory=visible, plain=plain) for plain in (False, True))
    rows = [row("Ada", sees={3: (40, "robot", "Bo")}), row("Bo"), row("Cy")]

    @settings(deadline=None)
    @given(st.dictionaries(st.sampled_from(["Ada", "Bo", "Cy"]), memory))
    def same(memories: dict[str, Any]) -> None:
        quick, slow = (
            [asdict(replace(d, weight=0)) for d in m.think(rows, memories)] for m in (tuned, plain)
        )
        assert nearly_same(quick, slow)

    with closing(tuned), closing(plain):
        same()


def test_a_field_is_found_in_whatever_spells_a_record() -> None:
    for memory, turn in (
        (OrderedDict(turn=3), 3),
        ('{"turn": 3}', 3),
        ({"turn": {"turn": 3}}, {"turn": 3}),
        ({"turn": "[1"}, "[1"),
        *((memory, None) for memory in ("turn", [1], True)),
    ):
        assert remembered("{turn: memory.turn}", memory) == {"turn": turn}


def test_records_in_lists_are_not_passed_as_text_and_argmin_needs_no_function_of_ours() -> None:
    tuned = Program.compile(TOLD).tuned["Robot"]
    assert tuned.columns["Memory"] == ("robot_name",)
    assert {spelled.partition(":")[2] for spelled in tuned.columns["Item"]} == {
        f"{of}.{field}" for of in ("report", "roads") for field in ("start", "length", "doubt")
    }
    assert "ARG_M" not in tuned.sql.upper()
    assert "'arg'" not in tuned.sql


def test_argmin_beside_another_extreme_stays_a_function() -> None:
    text = f"""
    Road(start: r.start, best? ArgMin= r.length -> r.doubt, far? Max= r.length) distinct :-
      Memory(memory:), r in memory;
    {ROBOT} m = List{{{{start:, best:, far:}} :- Road(start:, best:, far:)}};
    """
    assert "ARG_MIN" in Program.compile(text).tuned["Robot"].sql.upper()
    roads = [{"start": "A", "length": n, "doubt": abs(n - 3)} for n in range(6)]
    (decision,) = think(text, [row("Ada")], {"Ada": roads})
    assert decision.memory == [{"start": "A", "best": 3, "far": 5}]


@pytest.mark.parametrize("visible", ["own", "seen", "all"])
def test_a_total_is_there_for_a_robot_that_has_nothing_to_count(visible: str) -> None:
    text = f"""@Visible(Memory, "{visible}");
    Near(robot_name:, label: ray.label) :-
      Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "robot";
    Number(n? Count= label, all? Set= label, turns? Sum= t) distinct :-
      Near(label:), Memory(memory:), t == memory.turn;
    {ROBOT} Number(n:, all:, turns:), m = {{n:, all:, turns:, again: Sum{{x :- Number(n: x)}}}};
    """
    rows = [row("Ada", sees={4: (20, "robot", "Bo"), 5: (20, "robot", "Cy")}), row("Bo"), row("Cy")]
    memories = {"Ada": {"turn": 1}, "Bo": {"turn": 2}, "Cy": {"turn": 4}}
    tuned = Program.compile(text).tuned["Robot"]
    assert tuned.together
    assert tuned.together_alike
    counted: list[Any] = [decision.memory for decision in think(text, rows, memories)]
    assert [memory["n"] for memory in counted] == [2, 0, 0]
    assert counted[1] == {"n": 0, "all": None, "turns": None, "again": 0}


def test_what_all_see_alike_is_computed_once_for_all() -> None:
    text = f"""Known(far? Min= p.far) distinct :- Memory(memory:), p in memory.places;
    {ROBOT} Known(far:), m = far + sensor.clock;"""
    tuned = Program.compile(text).tuned["Robot"]
    assert "?5" in tuned.together
    assert "?5" not in tuned.together_alike
    assert (tuned.for_all(alike=False)[1], tuned.for_all(alike=True)[1]) == (5, 4)
    memories = {"Ada": {"places": [{"far": 3}]}, "Bo": {"places": [{"far": 2}, {"near": 1}]}}
    found = think(text, [row("Ada", clock=10), row("Bo", clock=20)], memories, memory="all")
    assert [decision.memory for decision in found] == [12, 22]


def test_a_total_over_a_query_written_in_place_is_of_what_its_viewer_sees() -> None:
    statement = """WITH t_1_All AS (
      SELECT SUM(u.c) AS n FROM (SELECT T.clock AS c FROM Sensor AS T) AS u
    ) SELECT S.robot_name AS r, (SELECT MAX(N.n) AS x FROM t_1_All AS N) AS m FROM Sensor AS S"""
    tuned = tune(statement, for_all=True)
    assert tuned is not None
    assert "T.id BETWEEN S.id AND S.id" in tuned.together


@pytest.mark.parametrize(
    "text",
    [
        "Schema() = {clock: 0, beacons: [{label: '', way: 0}], edges: [{u: '', v: '', d: 0}]};"
        f"{ROBOT}Memory(robot_name:, memory:), m = {EXAMPLE};",
        slow(program_text("schema")),
    ],
    ids=["short", "as measured"],
)
def test_an_example_costs_what_a_type_costs(text: str) -> None:
    assert EXAMPLE in text
    example, written = map(_shape, (text, text.replace(EXAMPLE, TYPE)))
    assert "TRY_CAST(" in example
    assert example == written


def _shape(text: str) -> str:
    """The query of a program without numbers, and types with their fields in order."""
    sql = re.sub(r"\d+", "", Program.compile(text).tuned["Robot"].sql)
    return re.sub(r"'(\{.*?\})'", lambda m: json.dumps(json.loads(m[1]), sort_keys=True), sql)


@pytest.mark.slow
def test_memories_too_large_for_the_tables_are_tried_once_for_all_robots(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried: list[str] = []

    def noted(table: str, *rest: Any) -> Any:
        tried.append(table)
        return insertions(table, *rest)

    monkeypatch.setattr(tables, "insertions", noted)
    names = [f"Bee {number}" for number in range(40)]
    rows = [row(name) for name in names]
    found = ROBOT + 'Memory(robot_name:, memory:), m = [memory.clock + 1, Like(memory.text, "x%")];'
    for size, times in ((100, 1), (500_000, 2)):
        tried.clear()
        memories = {name: {"clock": at, "text": "x" * size} for at, name in enumerate(names)}
        decisions = think(found, rows, memories, memory="all")
        assert [decision.memory for decision in decisions] == [[at + 1, True] for at in range(40)]
        assert tried.count("Memory") <= times


@pytest.mark.parametrize("visible", ["seen", slow("all")])
def test_lists_that_stayed_the_same_objects_count_as_they_would_anew(visible: Any) -> None:
    program = Program.compile(TOLD)
    lasting, fresh = (Mind(program, memory=visible, frozen=frozen) for frozen in (True, False))
    robots = [row("Ada", sees={3: (40, "robot", "Cy")}), row("Bo"), row("Cy")]
    some = st.integers(0, 3)
    moments = st.lists(
        st.tuples(st.integers(1, 3), st.lists(st.tuples(some, some), min_size=3, max_size=3)),
        min_size=2,
        max_size=6,
    )

    @settings(max_examples=min(60, settings().max_examples), deadline=None)
    @given(st.lists(roads | roads | odd, min_size=4, max_size=4), moments)
    def same(lists: list[Any], moments: list[tuple[int, list[tuple[int, int]]]]) -> None:
        for count, chosen in moments:
            memories: dict[str, Any] = {
                name: {"report": lists[report], "roads": lists[roads]}
                for name, (report, roads) in zip(("Ada", "Bo", "Cy"), chosen, strict=True)
            }
            rows = robots[-count:]
            assert lasting.think(rows, memories) == fresh.think(rows, memories)

    with closing(lasting), closing(fresh):
        same()


def test_a_value_of_the_same_text_is_the_same_object_where_nobody_changes_it() -> None:
    program = Program.compile(f"{ROBOT} m = {{all: Range(60), n: sensor.clock}};")
    for frozen in (True, False):
        with closing(Mind(program, frozen=frozen)) as mind:
            found: list[Any] = [
                decision.memory
                for clock in (1, 2)
                for decision in mind.think([row("Ada", clock=clock), row("Bo", clock=clock)], {})
            ]
        assert [memory["n"] for memory in found] == [1, 1, 2, 2]
        assert all(memory["all"] == list(range(60)) for memory in found)
        assert (len({id(memory["all"]) for memory in found}) == 1) == frozen


def test_equal_numbers_in_memories_are_told_apart() -> None:
    program = Program.compile(f"{ROBOT} Memory(robot_name:, memory:), m = {{n: memory.n}};")
    with closing(Mind(program)) as mind:
        for n in (0, 0.0, -0.0, False, 0, 1, True, 1.0, None, "1", 1):
            rows, memories = [row("Ada")], {"Ada": {"n": n}}
            with closing(Mind(program)) as fresh:
                assert repr(mind.think(rows, memories)) == repr(fresh.think(rows, memories))
