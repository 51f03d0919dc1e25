"""Thinking: decisions, and what is said when a program decides oddly."""

import math
import sqlite3
import threading
from contextlib import closing
from typing import Any

import pytest

from logical_robots_tui.mind import Decision, Limits, Mind, NoticeKind, Program, Stopped
from logical_robots_tui.mind.asking import in_plain_words
from logical_robots_tui.mind.sqlite.budget import _watchdog
from logical_robots_tui.values import Desire, Value
from tests.mind.rows import PAPER, ROBOT, remembered, row, think
from tests.waiting import PATIENCE, until

EVERYBODY = (
    "Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: 1) :- "
    "Sensor(robot_name:);"
)


def test_the_program_of_the_paper_steers_towards_the_weighted_mean_of_the_radar() -> None:
    rows = [row("Ada", sees={i: (20 + i, "wall", "wall") for i in range(15)})]
    (decision,) = think(PAPER, rows, {})
    radar = rows[0]["sensor"]["radar"]
    freedom = sum(r["distance"] * r["angle"] for r in radar) / sum(r["distance"] for r in radar)
    assert decision.desire is not None
    assert decision.desire.left_engine == pytest.approx(0.5 - freedom + 0.1)
    assert decision.desire.right_engine == pytest.approx(0.5 + freedom)
    assert (decision.memory, decision.notices) == ("I am a robot", ())


def test_each_robot_gets_one_decision_in_the_order_of_the_rows() -> None:
    decisions = think(PAPER, [row("Zoe"), row("Ada"), row("Bo")], {})
    assert [d.robot_name for d in decisions] == ["Zoe", "Ada", "Bo"]


@pytest.mark.parametrize(
    ("desire", "expected", "words"),
    [
        ("{left_engine: null, right_engine: 0.5}", Desire(0.0, 0.5), "left_engine is null"),
        ("{right_engine: 0.5}", Desire(0.0, 0.5), "left_engine is missing"),
        ("{left_engine: 0.5, right_engine: 1e999}", Desire(0.5, 0.0), "right_engine is"),
        ('{left_engine: "fast", right_engine: 1}', Desire(0.0, 1.0), 'left_engine is "fast"'),
        ("null", None, "The desire is null"),
        ("7", None, "The desire is not a record"),
    ],
)
def test_an_engine_without_number_stops(desire: str, expected: Desire | None, words: str) -> None:
    text = f"Robot(robot_name:, desire: {desire}, memory: 1) :- Sensor(robot_name:);"
    (decision,) = think(text, [row("Ada")], {})
    assert decision.desire == expected
    assert [n.kind for n in decision.notices] == ["bad engine"]
    assert words in decision.notices[0].message


BOTH = "{left_engine: 1, right_engine: 1}"


@pytest.mark.parametrize(
    ("text", "desire", "memory", "kinds"),
    [
        (ROBOT + "m = 1, sensor.clock > 100;", None, "before", ["no row"]),
        (ROBOT + "m in [1, 2, 3];", Desire(0.5, 0.5), 3, ["several rows"]),
        (
            f"Robot(robot_name:, desire: {BOTH}) :- Sensor(robot_name:);",
            *(Desire(1.0, 1.0), "before", ["no memory"]),
        ),
        (
            f'{EVERYBODY} Robot(robot_name: "Mallory", desire: null, memory: 1);',
            *(Desire(1.0, 1.0), 1, ["unknown robot"]),
        ),
        (
            f"{EVERYBODY} Robot(robot_name: null, desire: null, memory: 1);",
            *(Desire(1.0, 1.0), 1, ["null name"]),
        ),
        (ROBOT + 'm = Join("no list", "-");', None, "before", ["failed"]),
    ],
    ids=["no row", "several rows", "no memory", "unknown robot", "null name", "failed"],
)
def test_what_is_odd_about_the_rows_of_robots_is_told(
    text: str, desire: Desire | None, memory: Value, kinds: list[NoticeKind]
) -> None:
    (decision,) = think(text, [row("Ada")], {"Ada": "before"})
    assert (decision.desire, decision.memory) == (desire, memory)
    assert [notice.kind for notice in decision.notices] == kinds


def test_a_map_that_is_kept_as_text_is_not_forgotten() -> None:
    rule = """
    Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: ToString(new)) :-
      Memory(robot_name:, memory:),
      old = Coalesce(TryCast(memory, {seen: [""], n: 0}), {seen: ["it's, x"], n: 0}),
      new = {seen: old.seen ++ ["a b"], n: old.n + 1};
    """
    with closing(Mind(Program.compile(rule))) as mind:
        memories: dict[str, Value] = {"Ada": ""}
        for _ in range(3):
            (decision,) = mind.think([row("Ada")], memories)
            memories["Ada"] = decision.memory
    assert memories["Ada"] == r"{'seen': ['it\'s, x', a b, a b, a b], 'n': 3.0}"


def test_a_huge_memory_is_refused_and_the_old_one_kept() -> None:
    text = ROBOT + "Memory(robot_name:, memory:), m = memory ++ memory;"
    (decision,) = think(text, [row("Ada")], {"Ada": "x" * 80}, limits=Limits(memory_bytes=100))
    assert decision.memory == "x" * 80
    assert [n.kind for n in decision.notices] == ["no memory"]


MEMORIES: list[Value] = [
    "I am a robot",
    "",
    7,
    -0.25,
    None,
    [1, "two", None],
    {"plan": [{"at": "A", "seen": {"B": 2}}], "näme": "Zoë 东"},
    {"quote": 'say "hi"', "slash": "\\"},
    "\x1b]0;owned\x07[red]",
    float(2**70),
]


def test_a_memory_survives_many_ticks_unchanged() -> None:
    mind = Mind(Program.compile(ROBOT + "Memory(robot_name:, memory:), m = memory;"))
    for memory in [*MEMORIES, 2**70]:
        kept = memory
        for _ in range(5):
            (decision,) = mind.think([row("Ada")], {"Ada": kept})
            kept = decision.memory
        assert kept == memory
    assert isinstance(kept, float)
    mind.close()


DEEP = "@Ground(Deep); Deep(r: {a: {b: [1, {c: 2}]}}); TheDeep() = r :- Deep(r:);"
NESTED = {"a": {"b": [1, {"c": 2}]}}


@pytest.mark.parametrize(
    ("expression", "memory", "value"),
    [
        ("1 < 2", "", True),
        ("!(1 < 2)", "", False),
        ("null", "something", None),
        ("Coalesce(memory.count, 0) + 1", "I am a robot", 1),
        ("Coalesce(memory.count, 0) + 1", {"count": 4}, 5),
        ("{kept: memory, deep: TheDeep()}", {"x": [1]}, {"kept": {"x": [1]}, "deep": NESTED}),
        ("Element(sensor.radar, 0).angle", "", pytest.approx(math.pi / 3, abs=1e-12)),
    ],
)
def test_what_is_to_be_remembered_is(expression: str, memory: Value, value: Any) -> None:
    found = remembered(expression, memory, rules=DEEP)
    assert found == value
    assert not isinstance(value, bool) or found is value


ENDLESS = """
N(x) :- x in Range(3000); Big(s? += a * b) distinct :- N(a), N(b), N(c);
Robot(robot_name:, desire: {left_engine: s, right_engine: 0}, memory: 1) :-
  Sensor(robot_name:), Big(s:);
"""


def test_a_thought_can_be_stopped_from_another_thread() -> None:
    with closing(Mind(Program.compile(ENDLESS))) as mind:
        stop = threading.Event()

        def stop_it() -> None:
            until(lambda: _watchdog._pending)
            stop.set()

        other = threading.Thread(target=stop_it)
        other.start()
        with pytest.raises(Stopped):
            mind.think([row("Ada")], {}, stop=stop)
        other.join(PATIENCE)
        assert mind.query("Sensor", [row("Ada")], {}).rows


JOINED = (
    "Heard(text) :- Memory(robot_name:, memory:), text = Join(memory, memory);"
    "Known(text) :- Heard(text);\n"
)
FAILING: dict[str, Any] = {"Ada": "no list", "Bo": None}


def decisions(**visible: Any) -> list[Decision]:
    return think(JOINED + ROBOT + "Known(m);", [row("Ada"), row("Bo")], FAILING, **visible)


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
    "limits", [Limits(value_bytes=5_000), Limits(think_steps=20_000)], ids=["bytes", "steps"]
)
def test_a_failure_says_that_the_rows_of_a_recursion_multiply(limits: Limits) -> None:
    rules = "E(1, 2); E(2, 1); E(1, 1); E(2, 2); Far(1); Far(y) :- Far(x), E(x, y);"
    text = f"{rules}{ROBOT}m = Count{{x :- Far(x)}};"
    ((notice,),) = (d.notices for d in think(text, [row("Ada")], {}, limits=limits))
    assert "Far uses itself and is not distinct" in notice.message
    assert notice.message.endswith("in each round. Write distinct in all of its heads.")


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
