"""Each robot reasons over exactly the rows that it may see."""

from contextlib import closing
from dataclasses import replace
from typing import Any, Literal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.mind import Mind, Program, ResultTable
from logical_robots_tui.values import Value
from tests.mind.rows import row, think

PROGRAM = """
Names(l? List= n) distinct :- Sensor(robot_name: n);
Minds(l? List= n) distinct :- Memory(robot_name: n);
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: {sensors: s, memories: m}) :-
  Sensor(robot_name:), Names(l: s), Minds(l: m);
"""
ROWS = [row("Ada", sees={3: (40, "robot", "Bo"), 4: (40, "beacon", "Cy")}), row("Bo"), row("Cy")]


def _seen(text: str, **options: Any) -> dict[str, Any]:
    decisions = think(text, ROWS, {"Ada": 1, "Bo": 2, "Cy": 3}, **options)
    return {d.robot_name: d.memory for d in decisions}


def test_a_robot_sees_its_own_rows_and_more_only_where_the_level_says_so() -> None:
    names = ["Ada", "Bo", "Cy"]
    assert _seen(PROGRAM) == {name: {"sensors": [name], "memories": [name]} for name in names}
    # Those of robots on the radar, but not of beacons of that name.
    seen = _seen(PROGRAM, memory="seen")
    assert seen["Ada"] == {"sensors": ["Ada"], "memories": ["Ada", "Bo"]}
    assert seen["Bo"] == {"sensors": ["Bo"], "memories": ["Bo"]}
    seen = _seen(PROGRAM, memory="all", sensor="all")
    assert seen == {name: {"sensors": names, "memories": names} for name in names}


@pytest.mark.parametrize("memory", ["own", "seen", "all"])
def test_a_program_overrides_the_level(memory: str) -> None:
    seen = _seen(f'@Visible(Memory, "{memory}");\n@Visible(Sensor, "all");{PROGRAM}', memory="own")
    expected = {"own": ["Ada"], "seen": ["Ada", "Bo"], "all": ["Ada", "Bo", "Cy"]}
    assert seen["Ada"] == {"sensors": ["Ada", "Bo", "Cy"], "memories": expected[memory]}


def test_a_query_says_in_whose_reasoning_a_row_holds() -> None:
    with closing(Mind(Program.compile(PROGRAM), memory="seen")) as mind:
        table = mind.query("Minds", ROWS, {})
    assert table.columns == ("l",)
    assert dict(zip(table.viewers, table.rows, strict=True)) == {
        "Ada": (["Ada", "Bo"],),
        "Bo": (["Bo"],),
        "Cy": (["Cy"],),
    }


OWN, TWICE, OTHER = ("Ada", 1), ("Bo", 2), ("Bo", 3)


@pytest.mark.parametrize(
    ("rows", "viewers", "once"),
    [
        ([OWN, TWICE, TWICE], "Ada Ada Bo", ([OWN, TWICE], "")),
        ([OWN, OWN], "Bo Cy", ([OWN], "Bo")),
        ([OWN, OWN, OWN], "Ada Ada Bo", ([OWN, OWN], "")),  # a row that is repeated in a mind
        ([OWN, TWICE, OTHER], "Ada Ada Bo", ([OWN, TWICE, OTHER], "Ada Ada Bo")),
        ([OWN, TWICE], "", ([OWN, TWICE], "")),
    ],
)
def test_a_row_that_several_minds_have_counts_once(
    rows: list[tuple[Value, ...]], viewers: str, once: tuple[list[tuple[Value, ...]], str]
) -> None:
    table = ResultTable(("robot_name", "n"), tuple(rows), tuple(viewers.split()))
    assert table.once() == ResultTable(table.columns, tuple(once[0]), tuple(once[1].split()))
    unnamed = replace(table, columns=("who", "n"))
    assert unnamed.once() == unnamed, "a column says in whose mind it is"


@settings(max_examples=min(20, settings().max_examples), deadline=None)
@given(
    hidden=st.recursive(
        st.none() | st.integers(-9, 9) | st.text(max_size=5),
        lambda inner: st.lists(inner, max_size=2) | st.dictionaries(st.just("k"), inner),
        max_leaves=4,
    ),
    clock=st.integers(1, 99),
    visibility=st.sampled_from(["own", "seen"]),
)
def test_a_decision_depends_on_nothing_hidden(
    hidden: Any, clock: int, visibility: Literal["own", "seen"]
) -> None:
    with closing(Mind(Program.compile(PROGRAM), memory=visibility)) as mind:
        before = mind.think(ROWS, {"Ada": 1, "Bo": 2, "Cy": 3})
        changed = [ROWS[0], ROWS[1], row("Cy", clock=clock)]
        after = mind.think(changed, {"Ada": 1, "Bo": 2, "Cy": hidden})
    assert after[:2] == before[:2]
