"""Generated programs that remember: what they keep, how it is written, who reads it, and what says
its type, each with each.
"""

from itertools import product
from typing import NamedTuple

__all__ = ["PROGRAMS"]


class Shape(NamedTuple):
    """What is remembered: its type, an example, the start with empty lists, and what follows `m`.

    `lead` is what the reader looks at: its own memory, or that of the first robot.
    """

    kind: str
    example: str
    start: str
    following: str
    engine: str


_PLACE = '"p" ++ ToString(ToInt64(Floor(sensor.forward_distance / 40 + sensor.clock / 6)) % 5)'
SHAPES = {
    "a map": Shape(
        "{roads: [{a: Str, b: Str, d: Num}], n: Num}",
        '{roads: [{a: "", b: "", d: 0}], n: 0}',
        "{roads: [], n: 0}",
        "{roads: (if Size(m.roads) > 6 then [] else m.roads ++ "
        f'[{{a: "home", b: {_PLACE}, d: sensor.forward_distance / 4}}]), n: lead.n + 1}}',
        "Coalesce(Sum{x.d :- x in lead.roads, x.b != x.a}, 0) / 900",
    ),
    "a plan": Shape(
        "{plan: [{l: Num, r: Num}], now: {step: Num, why: Str}}",
        '{plan: [{l: 0, r: 0}], now: {step: 0, why: ""}}',
        '{plan: [], now: {step: 0, why: "start"}}',
        "{plan: (if m.now.step > 3 then [] else m.plan ++ [{l: 0.5, r: lead.now.step / 9}]), "
        "now: {step: (if m.now.step > 3 then 0 else m.now.step + 1), why: sensor.forward_object}}",
        "Coalesce(Max{x.r :- x in lead.plan}, 0.2)",
    ),
    "labels": Shape(
        "{seen: [Str], last: Str}",
        '{seen: [""], last: ""}',
        '{seen: [], last: "none, yet"}',
        f"{{seen: (if {_PLACE} in m.seen then m.seen else m.seen ++ [{_PLACE}]), "
        'last: lead.last ++ sensor.forward_object ++ "\'s"}',
        "Size(lead.seen) / 20",
    ),
    "numbers": Shape(
        "{heard: [Num], done: Bool}",
        "{heard: [0], done: true}",
        "{heard: [], done: false}",
        "{heard: (if Size(m.heard) > 5 then [] else m.heard ++ [sensor.forward_distance / 3]), "
        "done: !lead.done}",
        "Coalesce(Sum{x :- x in lead.heard}, 0) / 1000 + (if lead.done then 0.1 else 0)",
    ),
}

TYPINGS = {
    "by example": "m == Coalesce(TryCast(memory, {example}), {example})",
    "by ~": "e = {start}, e ~ {kind}, m == Coalesce(TryCast(memory, e), e)",
    "by ~ elsewhere": "m == Coalesce(TryCast(memory, Start()), Start())",
    "by type": "m == Coalesce(TryCast(memory, {kind}), {example})",
}
"""What says the type of what is remembered."""

WRITINGS = {"text": "ToString({})", "record": "{}", "JSON": "RecordAsJson({})"}
READERS = {"own": "robot_name", "another robot's": "First()"}

_PROGRAM = """
Start() = e :- e = {start}, e ~ {kind};
First() Min= robot_name :- Sensor(robot_name:);
Kept(robot_name:, m:) :- Memory(robot_name:, memory:), {typing};
Robot(robot_name:, desire: {{left_engine: 0.5, right_engine: {engine}}}, memory: {memory}) :-
  Sensor(robot_name:, sensor:), Kept(robot_name:, m:), Kept(robot_name: {reader}, m: lead);
"""

PROGRAMS = {
    f"{what} as {writing}, {typing}, of {reader} memory": _PROGRAM.format(
        **shape._asdict(),
        typing=TYPINGS[typing].format(**shape._asdict()),
        memory=WRITINGS[writing].format(shape.following),
        reader=READERS[reader],
    )
    for (what, shape), writing, typing, reader in product(
        SHAPES.items(), WRITINGS, TYPINGS, READERS
    )
}
"""Programs by title."""
