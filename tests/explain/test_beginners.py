"""Beginners' mistakes: each is marked by `check`, or explained by the first question why."""

import re
from contextlib import closing
from typing import NamedTuple

import pytest

from logical_robots_tui.explain import Explanation
from logical_robots_tui.mind import Diagnostic, Mind, Program, ProgramError
from logical_robots_tui.values import spell
from tests.explain.asking import why
from tests.mind.rows import row

HEAD = (
    "Robot(robot_name:, desire: {left_engine: 0.5, right_engine: 0.5}, memory: m) :-\n"
    "  Sensor(robot_name:, sensor:), Memory(robot_name:, memory:),\n"
)
"""Two lines before the body of a mistake, which begins in column 3 of line 3."""


class Mistake(NamedTuple):
    """A mistake in a body, and what is told about it.

    Attributes:
        rules: What stands before the rule for Robot, in its first line.
        mark: Line and column, and pieces of message and hint; or "" if it can't be seen.
        explained: Pieces of lines of the explanation, for programs that run.
    """

    body: str
    mark: str
    explained: tuple[str, ...] = ()
    rules: str = ""


MISTAKES = [
    # A comparison that is to be a value.
    Mistake("m = sensor.forward_distance < 60",
        "3:3 '=' is read before '<' ... Put the comparison in parentheses: "
        "m = (sensor.forward_distance < 60).",
        ("+ m = sensor.forward_distance = 200", "- m = sensor.forward_distance < 60 "
         "(compares `m = sensor.forward_distance` (200) with 60)")),
    Mistake('m = sensor.forward_label == "wall" && sensor.clock > 0',
        '3:3 \'=\' is read before \'==\' ... (sensor.forward_label == "wall" && sensor.clock > 0).',
        ('(compares `m = sensor.forward_label` ("nothing") with "wall")',)),
    Mistake("m = sensor.clock > 5 || sensor.clock < 0",
        "3:3 '=' is read before '>' ... m = (sensor.clock > 5 || sensor.clock < 0).",
        ("(compares `m = sensor.clock` (1) with 5)",)),
    Mistake("F(1)", "1:6 more than one '=' ... in parentheses: = (x <= 3).", (), "F(x) = x <= 3;"),
    # '=' where a comparison is meant.
    Mistake("m = (if sensor.clock = 3 then 1 else 2)",
        "3:11 '=' does not compare here ... Compare with '==': sensor.clock == 3.",
        ("- sensor.clock = 3 (no match)", "sensor.clock = 1")),
    Mistake('m = 1, sensor.forward_label = "wall" && sensor.clock = 1',
        '3:10 \'=\' does not compare here ... sensor.forward_label == "wall" && sensor.clock == 1.',
        ('- sensor.forward_label = "wall"',)),
    Mistake("m = 1, sensor.clock % 2 = 0", "3:24 not an expression ... Compare with '=='"),
    Mistake("m = 1, sensor.clock => 3", "3:10 not a condition ... '>='"),
    Mistake("m = 1, sensor.clock =< 3", "3:24 not an expression ... '<='"),
    Mistake("m = 1, sensor.clock <> 3", "3:24 not an expression ... '!='"),
    # What '!', '~' and words belong to.
    Mistake('m = 1, !sensor.forward_label == "wall"',
        "3:11 ! takes a Boolean ... Put the condition after ! in parentheses"),
    Mistake('m = 1, ~sensor.forward_label == "wall"',
        "3:11 This is not a condition ... Put the condition after ~ in parentheses: ~(a == b)."),
    Mistake("m = 1, not sensor.clock == 3", "3:10 not an expression ... ~(a == b)"),
    Mistake("m = 1, sensor.clock > 1 and sensor.clock < 9", "3:25 '&&' within"),
    Mistake("m = 1, (sensor.clock < 1 or sensor.clock > 9)", "3:26 '||' within"),
    Mistake("m = 1, sensor.clock > 1 & sensor.clock < 9", "3:25 '&&' within"),
    Mistake("m = 1, 20 < sensor.clock < 60", "3:30 A Boolean is compared ... Compare twice"),
    # `if`.
    Mistake("m = if sensor.clock < 3 then 1 else 2", "3:10 This 'if' ... Put it in parentheses"),
    Mistake("m = (if sensor.clock < 3 then 1)", "3:11 This 'if' ... needs an 'else'"),
    Mistake("m = (if sensor.clock < 3 1 else 2)", "3:11 This 'if' ... needs a 'then'"),
    Mistake("m = (if sensor.clock < 3 then 1 elif memory then 2 else 3)", "3:11 'else if'"),
    Mistake("m = sensor.clock < 3 ? 1 : 2", "3:22 not an expression ... (if a < b then c else d)"),
    # Names.
    Mistake("m = sensor.forwarddistance", "3:14 no field forwarddistance ... forward_distance?"),
    Mistake("m = sensor.Clock", "3:7 lower case"),
    Mistake("Ray in sensor.radar, m = 1", "3:3 Ray is not defined ... variables are lower case"),
    Mistake("m = True", "3:7 True is not defined ... Write true."),
    Mistake("m = 1, robot_name == Ada", '3:24 Ada is not defined ... in quotes: "Ada".'),
    Mistake("m = 1, sensor.forward_label == wall", '3:10 always holds ... in quotes: "wall".'),
    Mistake("m = 1, sensor.forward_label != wall", '3:34 wall has no value ... in quotes: "wall".'),
    Mistake("m = {count = 1}", "3:8 '=' does not name a field ... Write count: 1."),
    Mistake("m = 1, sensor.radar[0].distance < 3", "3:10 Element(list, 0)"),
    # Types and null.
    Mistake('m = 1, sensor.clock == "3"', "3:26 with a string ... Write 3 without quotes."),
    Mistake("m = 1, memory.count == null", "3:10 never holds ... Write memory.count is null.",
        ("- memory.count == null (no match)", "memory.count = null")),
    Mistake("m = memory.count + 1", "", ("+ m = memory.count + 1 = null", "memory.count = null")),
    Mistake("m = sensor.clock / 2, m == 1", "", ("- m == 1 (no match)", "m = 0.5")),
    Mistake("m = 1, memory == 0", "", ("- memory == 0 (no match)", 'memory = ""')),
    # Variables and rows.
    Mistake("m = 1, n = sensor.clock, n = n + 1",
        "3:28 never holds ... a name of its own: new_n = n + 1.", ("- n = n + 1 (no match)",)),
    Mistake("ray in sensor.radar, m = ray.angle", "", ("(gives 31 rows; this is the last)",
        "Another row of this rule comes from (a condition, or distinct with an aggregation, ",
        "m = ray.angle = 1.0471975511965976")),
    Mistake("m = 1", "", ("(gives 1 row, but not the last)", "memory = 2",
        "(gives 1 row; this is the last)"),
        "Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: 2) :- "
        "Sensor(robot_name:);"),
    Mistake("m = Min{r.distance :- r in sensor.radar, r.distance < 9} + 1", "",
        ("is null (It aggregates no rows; Coalesce(Min{r.distance :- ",)),
    Mistake("m = 2 * Near(sensor.radar)", "",
        ("`Near(sensor.radar)` is null (`Min{r.distance :- r in radar, r.distance < 9}` aggregates "
        "no rows; Coalesce(Near(sensor.radar), 0) would be 0 then)",),
        "Near(radar) = Min{r.distance :- r in radar, r.distance < 9};"),
    Mistake("m = Sum{d}, r in sensor.radar, d = r.distance", "3:7 no body ... Sum{d :- ...}."),
    Mistake("m += r.distance :- r in sensor.radar", "3:19 two ':-' ... Aggregates use braces"),
    Mistake("m = ArgMax{r.angle :- r in sensor.radar}", "3:14 takes pairs ... what -> value"),
    Mistake("m = ArgMax{r.angle -> r.distance && true :- r in sensor.radar}",
        "3:14 '->' is read before '&&' ... r.angle -> (r.distance && true)."),
    Mistake("m = ArgMin{r.angle, r.distance :- r in sensor.radar}", "3:14 a pair: x -> y."),
    Mistake("P(1, n: m)", "1:1 `distinct` ... distinct :-", (), "P(x, n? += 1) :- x in [1];"),
    Mistake("m = Sum{1 :- Seen(kind)}", "", ("m = Sum{1 :- Seen(kind)} = 31", "aggregates 31 rows"),
        'Seen(r.object) :- Sensor(sensor:), r in sensor.radar;'),
    Mistake("m = 1, Near(9)", "3:10 always holds ... Near(9) == true.", (), "Near(x) = x < 5;"),
    Mistake("m = Count(sensor.radar)", "3:7 a single value ... braces and a body"),
    Mistake("m = Min{r.distance | r in sensor.radar}", "3:11 not an expression ... follows ':-'"),
    Mistake("m = Sum{1 :- r in radar}", "3:21 radar has no value ... Write sensor.radar."),
    # Signs between conditions and rules.
    Mistake("m = 1, sensor.clock /= 3", "3:23 no /= in Logica ... Write !="),
    Mistake("m = 3 - -2", "3:10 not an expression ... a * (-b)"),
    Mistake("m = 1, sensor.clock in (1, 2)", "3:27 not an expression ... x in [1, 2]"),
    Mistake("m = Speed()", "1:1 A rule starts ... Speed() = 0.5;", (), "Speed = 0.5;"),
    Mistake("m = 1", "1:9 in the head ... Write ':-'", (), "Near(r) <- r.distance < 60;"),
    Mistake("m = 1 sensor.clock > 3", "3:7 not an expression ... missing comma"),
    Mistake("m = 1; sensor.clock > 3", "3:10 A rule starts ... ',' between its conditions"),
    Mistake("m = 1,", "3:9 not a condition ... Remove the ','"),
    Mistake("m = 1  // the first", "3:11 not an expression ... Comments begin with '#'."),
]  # fmt: skip


def check(text: str) -> tuple[Diagnostic, ...]:
    try:
        return Program.compile(text).warnings
    except ProgramError as error:
        return error.diagnostics


def lines(explanation: Explanation) -> str:
    return "\n".join(
        f"{ {True: '+ ', False: '- ', None: ''}[node.holds] }{node.text}"
        + (f" = {spell(node.values[0])}" if node.values else "")
        + (f" ({node.remark})" if node.remark else "")
        for top in explanation.nodes
        for _, node in top.walk()
    )


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda each: each.body)
def test_a_mistake_is_marked_or_explained(mistake: Mistake) -> None:
    text = f"{mistake.rules} {HEAD}".lstrip() + f"  {mistake.body};\n"
    marks = check(text)
    place, _, words = mistake.mark.partition(" ")
    if mistake.mark:
        told = [(f"{d.line}:{d.column}", f"{d.message} ... {d.hint}") for d in marks]
        pattern = ".*".join(map(re.escape, words.split(" ... ")))
        assert any(at == place and re.search(pattern, text) for at, text in told), told
    else:
        assert marks == ()
    assert all(mark.hint and len(mark.hint) <= 120 for mark in marks)
    if any(mark.severity == "error" for mark in marks):
        assert not mistake.explained
        return
    with closing(Mind(Program.compile(text))) as mind:
        mind.think([row("Ada")], {"Ada": ""})
    assert mistake.mark or mistake.explained
    if mistake.explained:
        told_why = lines(why(text, memories={"Ada": ""}))
        for piece in mistake.explained:
            assert piece in told_why, told_why
