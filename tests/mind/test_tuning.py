"""The quick way of evaluating a program gives what the plain one gives, and is taken."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

import pytest

from logical_robots_tui.mind import Mind, Program
from tests.mind.rows import PAPER, ROBOT, VISIBILITIES, row, slow, think

SEEN = {3: (40, "robot", "Bo"), 7: (33, "beacon", "A"), 9: (12, "wall", "wall")}
CLOSEST = "Closest(radar) = ArgMin{ray -> ray.distance :- ray in radar};"
HEADINGS = """
Angle(radar, label) = ArgMin{r.angle -> r.distance :- r in radar, r.label == label};
Aim(sensor) = Coalesce(Angle(sensor.radar, "A"), Angle(sensor.radar, "wall"));
"""


def test_what_a_program_says_several_times_is_computed_once_from_columns_that_are_read() -> None:
    program = Program.compile(PAPER)
    assert program.statements["Robot"].count("json_extract(Sensor.sensor, '$.radar')") == 2
    tuned = program.tuned["Robot"]
    assert tuned.sql.count("FROM Ray") == 1
    assert dict(tuned.columns) == {"Sensor": ("robot_name",), "Ray": ("angle", "distance")}


def test_what_does_not_depend_on_a_ray_is_not_computed_for_every_ray() -> None:
    text = f"""
    Best(x? Max= x) distinct :- x in [1, 2];
    {ROBOT} m = Sum{{ray.distance * Max{{x :- Best(x:), x < sensor.clock + 5}} :-
      ray in sensor.radar}};
    """
    assert [d.memory for d in think(text, [row("Ada", clock=3)], {})] == [31 * 200 * 2]
    first, _, rest = Program.compile(text).tuned["Robot"].sql.partition("FROM Ray")
    assert "Best" in first
    assert "Best" not in rest


EXPRESSIONS = [
        "sensor.forward_distance + sensor.clock",
        "sensor",
        "sensor.radar",
        "sensor.self",
        "sensor.self.battery_level",
        "Closest(sensor.radar)",
        "Closest(sensor.radar).label",
        "List{ray :- ray in sensor.radar, ray.object != \"none\"}",
        "List{{ray.label, ray.distance} :- ray in sensor.radar, ray.distance < 50}",
        "Sum{1 :- ray in sensor.radar}",
        "Sum{Sum{a.distance - b.distance :- a in sensor.radar} :- b in sensor.radar}",
        "{here: Aim(sensor), there: {again: Aim(sensor), list: [Aim(sensor), Aim(sensor)]}}",
        "if Aim(sensor) > 0 then {turn: Aim(sensor)} else {turn: -1 * Aim(sensor)}",
        "Element(sensor.radar, 3).label",
        "Max{x.turn :- Memory(memory: x)}",
        "memory.plan",
        "{plan: memory.plan, again: memory.plan}",
        "Count{ray.label :- ray in sensor.radar}",
]  # fmt: skip


@pytest.mark.parametrize(
    "expressions",
    [EXPRESSIONS, *(slow([text]) for text in EXPRESSIONS)],
    ids=["all in one", *EXPRESSIONS],
)
def test_both_ways_give_the_same_of(expressions: list[str]) -> None:
    values = expressions[0]
    if len(expressions) > 1:
        values = f"{{{', '.join(f'c{n}: ({text})' for n, text in enumerate(expressions))}}}"
    text = f"{CLOSEST}{HEADINGS}{ROBOT} Memory(robot_name:, memory:), m = ({values});"
    assert "Robot" in Program.compile(text).tuned
    memory = {"turn": 0.5, "plan": {"spot": "A", "steps": [1, {"x": 2}]}}
    (decision,) = think(text, [row("Ada", sees=SEEN)], {"Ada": memory})
    assert not decision.notices


def test_what_fails_only_where_nobody_asks_for_it_does_not_fail() -> None:
    text = f"""
    Sorted(memory) = Sort(memory.items);
    {ROBOT} Memory(robot_name:, memory:),
      m = (if memory.ready then {{a: Sorted(memory), b: Sorted(memory)}} else "not yet");
    """
    for ready, expected in ((False, "not yet"), (True, {"a": ["a"], "b": ["a"]})):
        memory = {"ready": ready, "items": ["a"] if ready else "no list"}
        (decision,) = think(text, [row("Ada")], {"Ada": memory})
        assert (decision.memory, decision.notices) == (expected, ())


OTHER_SHAPES: list[Callable[[Any], object]] = [
    lambda sensor: sensor.update(radar=sensor["radar"][:5]),
    lambda sensor: sensor.update(radar=sensor["radar"] * 3),
    lambda sensor: sensor.update(radar=[]),
    lambda sensor: sensor["radar"][4].update(distance=[1, 2]),
    lambda sensor: sensor["radar"][4].pop("label"),
    lambda sensor: sensor["radar"][4].update(distance=2**70),
    lambda sensor: sensor.pop("clock"),
]


def test_sensors_of_another_shape_are_thought_about_too() -> None:
    text = f"""{ROBOT} m = {{
      clock: sensor.clock, labels: List{{ray.label :- ray in sensor.radar}},
      far: Max{{ray.distance :- ray in sensor.radar}}}};"""
    for change in OTHER_SHAPES:
        rows = [row("Ada"), row("Bo", sees=SEEN)]
        change(rows[1]["sensor"])
        think(text, rows, {})


@pytest.mark.parametrize(("memory", "sensor"), VISIBILITIES)
def test_a_crowd_is_thought_about_as_a_few_are(memory: Any, sensor: Any) -> None:
    text = f"""
    Known(robot_name:, turn: memory.turn) :- Memory(robot_name:, memory:);
    Near(robot_name:, n? Sum= 1) distinct :-
      Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "robot";
    {ROBOT} m = {{
      turn: Sum{{t :- Known(robot_name: x, turn: t)}},
      mine: Max{{t :- Known(robot_name:, turn: t)}},
      near: Sum{{n :- Near(robot_name:, n:)}},
      all: Sum{{n :- Near(robot_name: r, n:)}}}};
    """
    names = [f"R{i}" for i in range(40)]
    rows = [
        row(name, sees={k: (20, "robot", names[(7 * i + k) % 40]) for k in range(i % 4)})
        for i, name in enumerate(names[:31])
    ] + [row(name) for name in names[31:]]
    memories = {name: {"turn": i} for i, name in enumerate(names)}
    crowd = think(text, rows, memories, memory=memory, sensor=sensor)
    assert len({str(decision.memory) for decision in crowd}) > 1
    with closing(Mind(Program.compile(text), memory, sensor)) as mind:
        for some in (rows[:3], rows, rows[5:9]):
            assert len(mind.think(some, memories)) == len(some)


def test_the_same_names_with_other_rays_are_other_thoughts() -> None:
    with closing(Mind(Program.compile(PAPER))) as mind:
        moments = [[row("Ada", sees=seen)] for seen in ({}, SEEN, {0: (5, "wall", "wall")}, {})]
        desires = [mind.think(rows, {})[0].desire for rows in moments]
        assert desires[0] == desires[3]
        assert len(set(map(str, desires))) == 3


CROWD = """
Near(robot_name:, label: ray.label) distinct :-
  Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "robot";
Turn(robot_name:, turn: memory.turn) :- Memory(robot_name:, memory:);
Mixed(x:) distinct :- Turn(turn: x) | x in [3];
"""


@pytest.mark.sampled
@pytest.mark.parametrize("memory", ["own", "seen", "all"])
@pytest.mark.parametrize(
    "body",
    [
        "m = sensor.clock",
        "m = Count{x :- Near(robot_name:, label: x)}",
        "m = Sum{t :- Turn(robot_name: x, turn: t), Near(robot_name:, label: x)}",
        "m = List{t :- Turn(turn: t)}",
        "Turn(robot_name:, turn:), m = turn",
        "Turn(robot_name: other, turn:), other != robot_name, m = turn",
        "m = Sum{x :- Mixed(x:)}",
        'Near(robot_name:, label: "Bo"), m = "Bo is here"',
        '~Near(robot_name:, label: "Bo"), m = "Bo is not here"',
        "m = Sum{Sum{t + u :- Turn(turn: u)} :- Turn(turn: t)}",
        "m = Sum{1 :- ray in sensor.radar, ray.object == \"robot\" || ray.object == \"beacon\"}",
        'm = List{r.label :- r in sensor.radar, r.object == "beacon", r.distance < 100}',
        'm = Max{r.distance :- r in sensor.radar, "wall" == r.object}',
        'm = List{r.object :- r in sensor.radar, r.object == "beacon"}',
        'm = Count{r.label :- r in sensor.radar, r.object != "robot"}',
    ],
)  # fmt: skip
def test_all_robots_together_think_what_each_would_alone(body: str, memory: str) -> None:
    text = f'@Visible(Memory, "{memory}");\n{CROWD}{ROBOT} {body};'
    rows = [
        row("Ada", clock=3, sees={4: (20, "robot", "Bo"), 9: (30, "beacon", "A")}),
        row("Bo", sees={0: (5, "wall", "wall"), 1: (9, "robot", "Cy"), 30: (8, "robot", "Ada")}),
        row("Cy", sees=SEEN),
    ]
    assert len(think(text, rows, {"Ada": {"turn": 1}, "Bo": {"turn": 2}, "Cy": {"turn": 0.5}})) == 3
    tuned = Program.compile(text).tuned["Robot"]
    assert tuned.together
    bounds = [tuned.for_all(alike=alike)[1] for alike in (False, True)]
    assert bounds == ([5, 4] if "Memory" in tuned.columns else [2, 2])


def test_rules_for_single_robots_are_asked_together_too() -> None:
    text = """
    Robot(robot_name: "Ada", desire: {left_engine: 1, right_engine: 0}, memory: 1);
    Robot(robot_name:, desire: {left_engine: 0, right_engine: 1}, memory: sensor.clock) :-
      Sensor(robot_name:, sensor:), robot_name != "Ada";
    """
    ada, bo = think(text, [row("Ada", clock=8), row("Bo", clock=9)], {})
    # Each sees the rule for Ada, which is a stranger to Bo.
    assert [(d.memory, d.notices) for d in (ada, bo)] == [(1, ()), (9, ())]


def test_of_several_rows_for_a_robot_the_same_one_counts() -> None:
    decisions = think(f"{ROBOT} x in [3, 1, 2], m = x;", [row("Ada"), row("Bo")], {})
    assert {d.memory for d in decisions} == {2}
    assert all("3 rows" in d.notices[0].message for d in decisions)


def test_rays_to_beacons_stand_apart_when_nothing_else_is_asked_for() -> None:
    beacons = 'r in sensor.radar, r.object == "beacon"'
    text = f"{ROBOT} m = [Min{{r.distance :- {beacons}}}, Count{{r.label :- {beacons}}}];"
    program = Program.compile(text)
    assert dict(program.tuned["Robot"].columns) == {
        "Sensor": ("robot_name",),
        "BeaconRay": ("distance", "label"),
    }
    rows = [row("Ada", sees=SEEN), row("Bo")]
    assert [d.memory for d in think(text, rows, {})] == [[33, 1], [None, 0]]
    with closing(Mind(program)) as mind:
        counts = [mind.think([row("Ada", sees=s)], {})[0].memory for s in (SEEN, {}, {}, SEEN, {})]
        assert counts == [[33, 1], [None, 0], [None, 0], [33, 1], [None, 0]]


NEAREST = [
    f"{CLOSEST}{ROBOT} m = Closest(sensor.radar);",
    f"{CLOSEST}{ROBOT} n = Closest(sensor.radar), m = {{far: n.distance, seen: n}};",
    f"""
    Nearest(robot_name:, ray? ArgMin= ray -> ray.distance, far? Max= ray.distance) distinct :-
      Sensor(robot_name:, sensor:), ray in sensor.radar, ray.object == "beacon";
    {ROBOT} Nearest(robot_name:, ray:, far:), m = [ray, far];
    """,
]


@pytest.mark.parametrize("text", NEAREST)
@pytest.mark.parametrize("robots", [3, 40])
def test_of_all_rays_only_the_nearest_is_written_as_a_whole(text: str, robots: int) -> None:
    seen = {3: (40, "beacon", "Ä"), 4: (12, "beacon", '"q'), 9: (12, "beacon", "B")}
    rows = [row(f"R{n}", sees=seen if n % 2 else {1: (n, "wall", "wall")}) for n in range(robots)]
    columns = Program.compile(text).tuned["Robot"].columns
    is_kept = "far?" in text  # MAX beside it leaves open which row another column comes from
    assert any("value" in names for names in columns.values()) == is_kept
    think(text, rows, {})
