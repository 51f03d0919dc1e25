"""Indexes and materialized predicates: made where they pay, and robots think the same."""

from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import ROBOT, row, slow, think

LISTS = Path(__file__).with_name("lists.l").read_text("utf-8")


@pytest.mark.parametrize(
    ("visible", "robots"),
    [("own", 3), ("seen", 33), ("all", 3), slow("own", 33), slow("seen", 3), slow("all", 33)],
)
def test_lists_are_joined_as_the_plain_way_does(visible: Any, robots: int) -> None:
    names = [f"R{i}" for i in range(robots)]
    rows = [
        row(name, sees={2: (30, "robot", names[i - 1]), 5: (9, "beacon", f"B{i % 4}")})
        for i, name in enumerate(names)
    ]
    memories: dict[str, Any] = {
        name: {
            "roads": [{"start": f"B{k}", "finish": f"B{(k * i) % 5}"} for k in range(i % 6)],
            "places": [{"label": f"B{k % 7}", "far": k + i} for k in range(9)],
        }
        for i, name in enumerate(names)
    }
    found: list[Any] = [d.memory for d in think(LISTS, rows, memories, memory=visible)]
    assert all(memory["far"] for memory in found[1:3])
    assert any(memory["loops"] for memory in found)
    assert any(memory["mine"] for memory in found)
    assert any(memory["ahead"] for memory in found)


def test_few_robots_have_an_index_for_lists_alone_and_without_lists_a_crowd_asks_as_they_do() -> (
    None
):
    program = Program.compile(LISTS)
    made = automatic(program, [row("Ada"), row("Bo")], {})
    assert made
    assert not [line for line in made if "Sensor" in line or "Near" in line or "Memory" in line]
    robot = program.tuned["Robot"]
    assert "(NOT " in robot.sql
    assert "(NOT " not in robot.for_crowd().sql
    text = f"Turn(n? Sum= memory.n) distinct :- Memory(memory:); {ROBOT} m = Sum{{n :- Turn(n:)}};"
    robot = Program.compile(text).tuned["Robot"]
    assert robot.for_crowd() is robot


def automatic(program: Program, rows: list[Any], memories: Any, memory: Any = "own") -> Any:
    with closing(Mind(program, memory)) as mind:
        plan = mind.query_plan("Robot", rows, memories).plan
    return [line for line in plan if "AUTOMATIC" in line]


@pytest.mark.parametrize("told", [30, "30", 30.0, "30.0", True, None])
def test_numbers_and_texts_are_compared_as_ever_beside_a_join_of_lists(told: Any) -> None:
    text = f"""
    Road(start: r.start, finish: r.finish) distinct :- Memory(memory:), r in memory.roads;
    Seen(text: ToString(ray.distance), number: ToInt64(ray.distance)) distinct :-
      Sensor(sensor:), ray in sensor.radar, ray.object == "beacon";
    Told(value: t) distinct :- Memory(memory:), t == memory.told;
    {ROBOT} m = {{
      loops: Sum{{1 :- Road(start: a, finish: b), Road(start: b, finish: a)}},
      texts: Sum{{1 :- Seen(text:), Told(value: text)}},
      numbers: Sum{{1 :- Seen(number:), Told(value: number)}}}};
    """
    assert "(NOT " in Program.compile(text).tuned["Robot"].together
    roads = [{"start": f"B{n}", "finish": f"B{n}"} for n in range(5)]
    rows = [row("Ada", sees={3: (30, "beacon", "B1")}), row("Bo")]
    think(text, rows, {"Ada": {"roads": roads, "told": told}})


@pytest.mark.parametrize("robots", [3, 33])
@pytest.mark.parametrize(
    "rule",
    [
        'Sensor(robot_name:, sensor:), x in sensor.radar, x.object == "wall"',
        "Sensor(robot_name:, sensor:), x in sensor.radar, x.object == sensor.forward_object",
        'Memory(robot_name:, memory:), x in memory.seen, x.object == "wall"',
        "Memory(robot_name:, memory:), x in memory.seen, x.object == memory.wanted",
    ],
)
def test_a_crowd_finds_rays_and_records_in_order_and_among_its_own(rule: str, robots: int) -> None:
    text = f"""
    Mine(robot_name:, all? List= x.distance, first? ArgMin= x.label -> x.distance) distinct :-
      {rule};
    {ROBOT} Mine(robot_name:, all:, first:), m = {{all:, first:}};
    """
    places = range(0, 31, 2)
    rows = [
        row(f"R{n}", sees={i: ((i * 7 + n) % 4 + 1, "wall", f"W{i}") for i in places})
        for n in range(robots)
    ]
    memories: dict[str, Any] = {
        each["robot_name"]: {"seen": each["sensor"]["radar"], "wanted": "wall"} for each in rows
    }
    for each in rows:
        each["sensor"]["forward_object"] = "wall"
    for decision, each in zip(think(text, rows, memories), rows, strict=True):
        mine = [ray for ray in each["sensor"]["radar"] if ray["object"] == "wall"]
        assert decision.memory == {
            "all": [ray["distance"] for ray in mine],
            "first": min(mine, key=lambda ray: ray["distance"])["label"],
        }
    made = automatic(Program.compile(text), rows, memories)
    assert not [line for line in made if " x_" in line]


@pytest.mark.parametrize("robots", [3, 33])
def test_memories_are_found_by_name_and_not_by_a_constant_in_them(robots: int) -> None:
    text = f"""
    Settled(robot_name:, angle? Avg= ray.angle, distance? Min= ray.distance) distinct :-
      Sensor(robot_name:, sensor:), Memory(robot_name: other, memory:),
      other != robot_name, memory.settled == true, ray in sensor.radar, ray.label == other;
    {ROBOT} m = {{
      angle: AnyValue{{a :- Settled(robot_name:, angle: a)}},
      distance: AnyValue{{d :- Settled(robot_name:, distance: d)}}
    }};
    """
    names = [f"R{n}" for n in range(robots)]
    rows = [
        row(name, sees={i: (20 + i, "robot", names[(n + i) % robots]) for i in range(9)})
        for n, name in enumerate(names)
    ]
    memories: dict[str, Any] = {name: {"settled": n % 2 == 0} for n, name in enumerate(names)}
    found: list[Any] = [d.memory for d in think(text, rows, memories, memory="seen")]
    assert all(memory["distance"] for memory in found)
    made = automatic(Program.compile(text), rows, memories, "seen")
    assert not [line for line in made if "Settled" not in line]


GAPS = Path(__file__).with_name("gaps.l").read_text("utf-8")
"""The widest gap between what is near: for each pair of rays it is asked what is between them."""


def looking(count: int) -> list[Any]:
    near = (20, "wall", "wall")
    return [row(f"R{n}", sees={n % 9: near, 12 + n % 17: near}) for n in range(count)]


@pytest.mark.parametrize(
    ("visible", "robots"),
    [("own", 3), ("all", 3), slow("own", 1), slow("seen", 1), slow("all", 1), slow("seen", 3)],
)
def test_gaps_are_found_as_the_plain_way_finds_them(visible: Any, robots: int) -> None:
    found = think(GAPS, looking(robots), {}, memory=visible)
    assert len({decision.memory for decision in found}) == robots
    assert not [decision.notices for decision in found if decision.notices]


@pytest.mark.parametrize("robots", [3, 33])
def test_a_query_that_is_asked_for_each_pair_is_computed_once(robots: int) -> None:
    program = Program.compile(GAPS)
    with closing(Mind(program)) as mind:
        plan = mind.query_plan("Robot", looking(robots), {}).plan
    assert [line for line in plan if "MATERIALIZE" in line and "Blocked" in line]
    (asked,) = [line for line in plan if "SEARCH" in line and "Blocked" in line]
    assert "AUTOMATIC COVERING INDEX" in asked
    for text in (program.tuned["Robot"].together, *program.tuned["Robot"].crowd):
        assert text.count("Blocked AS MATERIALIZED") == 1


def test_each_robot_of_a_crowd_has_its_own_gaps() -> None:
    crowd = looking(33)
    with closing(Mind(Program.compile(GAPS))) as mind:
        assert mind.think(crowd, {}) == [mind.think([one], {})[0] for one in crowd]


def test_a_query_that_is_asked_once_a_robot_is_computed_once_where_all_see_everything() -> None:
    text = f"""
    Near(robot_name:, distance? Min= r.distance) distinct :-
      Sensor(robot_name:, sensor:), r in sensor.radar;
    {ROBOT} m = Max{{d :- Near(robot_name:, distance: d)}};
    """
    robot = Program.compile(text).tuned["Robot"]
    assert "Near AS MATERIALIZED" in robot.sql
    assert "Near AS MATERIALIZED" not in robot.together
    for sql in (robot.sql, robot.together):
        assert "JSON_EACH" not in sql
    found = think(text, looking(7), {}, memory="all", sensor="all")
    assert [decision.memory for decision in found] == [20] * 7
