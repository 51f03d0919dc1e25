"""The constructs of Logica as a robot meets them, with recursion and predicates left open."""

from contextlib import closing
from pathlib import Path

import pytest

from logical_robots_tui.mind import Mind, Program, ProgramError, QueryError
from tests.mind.differential.comparing import here
from tests.mind.rows import ROBOT, all_remembered, remembered, row, slow, think

EXPRESSIONS = {
    "1 + 2 * 3": 7,
    "9007199254740993 % 10": 3,
    "-9007199254740993 % 10": -3,
    '"it\'s [bold]"': "it's [bold]",
    "List{x * 2 :- x in [4, 2]}": [8, 4],
    'ArgMin{n -> v :- n in ["a", "b"], v = (if n == "a" then 2 else 1)}': "b",
    'ArgMax{n -> v :- n in ["a", "b"], v = (if n == "a" then 2 else 1)}': "a",
}
NULL = [
    *('Join(null, "-")', 'Split(null, ",")', "Sort(null)", "Sqrt(null)", "Sqrt(-1)"),
    *("Log(0)", "(1 / 0) % 2", "Size(null)", "null / 2", "memory.a.b.c"),
    *("Element([1], 7)", "Min{x :- x in []}", "ArgMin{x -> x :- x in []}"),
]


def test_an_expression_has_its_value_and_null_gives_null() -> None:
    assert all_remembered(EXPRESSIONS) == EXPRESSIONS
    assert all_remembered(NULL) == dict.fromkeys(NULL)


RULES = Path(__file__).with_name("rules.l").read_text("utf-8")


def test_rules_mean_what_they_say() -> None:
    expected = {
        "Double(4)": 8,
        "Sum{1 :- P(x)}": 2,
        "List{x :- P(x), ~(x == 1)}": [2],
        "Sum{x :- Or(x)}": 11,
        "Total()": 3,
        "Sum{b :- Most(b:)}": 3,
        "Sum{x :- G(x)}": 5,
        "Best(1)": 4,
        "Size(List{b :- Reach(1, b)})": 2,
        "Sum{x :- Last(x)}": 3,
        "Angle(sensor.radar) > 1": True,
        "Sum{a + b :- Copy(a:, b:)}": 7,
    }
    assert all_remembered(expected, rules=RULES) == expected


def test_lists_of_records_can_be_searched_by_pattern() -> None:
    memory = {"edges": [{"u": "A", "v": "B", "d": 3.5}, {"v": "C", "u": "B", "d": 1}]}
    rules = (
        "Edge(r, u, v, d) :- Memory(robot_name: r, memory:), e in memory.edges, "
        "u = e.u, v = e.v, d = e.d;"
    )
    assert remembered('Sum{d :- Edge("Ada", u, v, d)}', memory, rules=rules) == 4.5


# What only the package of the web platform parses is here as well; it can't compile an implication
# in an aggregate.
ANSWERS: dict[str, list[object]] = {
    'P(x) order_by("col0") limit(2) :- x in [3, 1, 2]; Answer(value: List{x :- P(x)});': [[1, 2]],
    'P(x) distinct order_by("col0 DESC") limit(2) :- x in [3, 1, 2];'
    " Answer(value: Sum{x :- P(x)});": [5],
    "P(7) limit(1) :- x in Range(3); Answer(value: Sum{x :- P(x)});": [7],
    "-+-(left:, right:) = left * 10 + right; Answer(value: 3 -+- 4);": [34],
    "⊕(left:, right:) = left ++ right; Answer(value: 'a' ⊕ 'b');": ["ab"],
    "A(x) :- x in Range(3); B(..r) :- A(..r); Answer(value: Sum{x :- B(x)});": [3],
    "A(x) :- x in Range(3); B(..r) :- A(..r); Answer(x) :- B(x);": [0, 1, 2],
    "A(x) = x + 1 :- x in Range(3); B(..r) :- A(..r); Answer(value: Sum{B(x) :- B(x)});": [6],
    "A(c: 1, d: 2); F(..r) :- T(c:, ..r); G := F(T: A); Answer(value: d) :- G(d:);": [2],
    "T() ++= x :- x in ['ab', 'c']; Answer(value: Size(T()));": [3],
    "P(n: 1, l? ++= []) distinct; Answer(value: l) :- P(l:);": [[]],
    "T('a\\n b'); T('c'); Answer(value: Max{Length(x) :- T(x)});": [4],
    "Answer(value: Sum{x :- x in [1, 2, 3], (x > 1 => x >= 3)});": [4],
}
"""Heads with an order and a limit, operators of one's own, whole rows, texts of several lines."""


@pytest.mark.parametrize("rules", ANSWERS)
def test_rules_have_these_answers(rules: str) -> None:
    assert sorted(here(rules)) == [(value,) for value in ANSWERS[rules]]


ONE = "A(0); A(n + 1) :- A(n), n < 5000;"
CIRCLE = "A(0); A(n + 1) :- C(n); B(n + 1) :- A(n); C(n + 1) :- B(n);"


def last(rules: str) -> object:
    ((value,),) = here(f"{rules} Answer(value: Max{{n :- A(n)}});")
    return value


@pytest.mark.parametrize(("member", "found"), [("A", 30), slow("B", 33), ("C", 33)])
def test_any_member_of_a_circle_may_say_how_far_it_goes(member: str, found: int) -> None:
    assert last(f"@Recursive({member}, 10); {CIRCLE}") == found


STOPPED = {
    f"@Recursive(A, 100, stop: Found); {ONE} Found() :- A(n), n > 5;": 6,
    f"@Recursive(A, -1, stop: Found); {ONE} Found() :- A(n), n > 5;": 6,
    # What stops it may compare a step with the one before.
    "@Recursive(A, 50, stop: Found); A(0); A(n + 1) :- A(n), n < 5; A(n + 10) :- A(n), n > 99;"
    "Before(n) :- A(n); Found() :- Max{n :- A(n)} == Max{n :- Before(n)};": 5,
    f"@Recursive(B, 9, stop: Found); {ONE.replace('A', 'B')} Found() :- B(3); A := B();": 3,
}


@pytest.mark.parametrize("rules", STOPPED, ids=["steps", "no end", "the one before", "a copy"])
def test_a_recursion_stops_once_a_predicate_has_a_row(rules: str) -> None:
    assert last(rules) == STOPPED[rules]


@pytest.mark.parametrize("mode", ["iterative", "vertical", slow("diamond"), slow("horizontal")])
def test_each_way_to_iterate_gives_the_same(mode: str) -> None:
    assert last(f'@Recursive(A, 20, mode: "{mode}"); {ONE}') == 20


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("wings: 2", "@Recursive has no option wings"),
        ('mode: "sideways"', "@Recursive can't use this value of mode"),
        ("stop: 3", "@Recursive can't use this value of stop"),
    ],
)
def test_an_option_that_means_nothing_is_refused(option: str, message: str) -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile(f"\n@Recursive(A, 20, {option}); {ONE} {ROBOT}m = 1;")
    assert [(d.line, d.message) for d in caught.value.diagnostics] == [(2, message)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rules", "found"),
    [
        (ONE, 1000),
        ("A(0) distinct; A(n + 1) distinct :- A(n), n < 990;", 990),
        ("E(n, n + 1) :- n in Range(200); A(0) distinct; A(y) distinct :- A(x), E(x, y);", 200),
        ("E(n, 2 * n) :- n in Range(99); A(1) distinct; A(y) distinct :- A(x), E(x, y);", 128),
    ],
)
def test_a_thousand_steps_over_small_tables_are_within_the_budget(rules: str, found: int) -> None:
    text = f"@Recursive(A, 1000); {rules} {ROBOT}m == Max{{n :- A(n)}};"
    assert [decision.memory for decision in think(text, [row("Ada")], {})] == [found]


def test_a_recursion_that_is_cut_off_says_so_at_its_line_and_what_to_do() -> None:
    (decision,) = think(f"# far\n\n{ONE}\n{ROBOT}m == Max{{n :- A(n)}};", [row("Ada")], {})
    (notice,) = decision.notices
    assert notice.message == (
        "Line 3: The recursion of A was still growing after 32 steps; later rows are missing. "
        "Add a condition that ends it, or allow more steps with @Recursive(A, N)."
    )
    (warning,) = Program.compile(f"@Recursive(A, 5000); {ONE} {ROBOT}m = 1;").warnings
    assert (warning.line, warning.severity) == (1, "warning")
    assert "at most 1,000 steps" in warning.message


PATTERN = """
Station("Fire");
Mine("Mine");
Spot(robot_name:, ray:) :- Sensor(robot_name:, sensor:), ray in sensor.radar, Post(ray.label);
Worker(robot_name:, distance: ray.distance) :- Spot(robot_name:, ray:);
Firefighter := Worker(Post: Station);
Miner := Worker(Post: Mine);
"""
ROWS = [row("Ada", sees={3: (44, "beacon", "Fire"), 4: (55, "beacon", "Mine")})]

FROM_A_PATTERN = """
Team(robot_name:, distance:) :- Worker(robot_name:, distance:), Allowed(distance);
Quick := Team(Allowed: Near);
QuickMiner := Quick(Post: Mine);
Near(x) :- x in [55, 56];
"""


@pytest.mark.parametrize(
    ("rules", "trade", "distance"),
    [("", "Firefighter", 44), ("", "Miner", 55), (FROM_A_PATTERN, "QuickMiner", 55)],
)
def test_what_is_left_open_is_filled_in_from_outside(rules: str, trade: str, distance: int) -> None:
    (decision,) = think(f"{PATTERN}{rules}{ROBOT} {trade}(robot_name:, distance: m);", ROWS, {})
    assert (decision.memory, decision.notices) == (distance, ())


def test_a_pattern_has_no_rows_of_its_own_and_says_why() -> None:
    program = Program.compile(f"{PATTERN}{ROBOT} Miner(robot_name:, distance: m);")
    rows = {predicate.name: predicate.has_rows for predicate in program.predicates}
    assert (rows["Spot"], rows["Worker"], rows["Miner"]) == (False, False, True)
    refused = pytest.raises(QueryError, match="Worker uses Post, which is a parameter")
    with closing(Mind(program)) as mind, refused:
        mind.query("Worker", ROWS, {})


@pytest.mark.parametrize(
    "text",
    [
        f"{PATTERN}{ROBOT} Worker(robot_name:, distance: m);",
        PATTERN.replace("(Post:", "(Pots:") + f"{ROBOT} Miner(robot_name:, distance: m);",
    ],
    ids=["the robots use the pattern", "another name is filled in"],
)
def test_what_nobody_fills_in_is_not_defined(text: str) -> None:
    with pytest.raises(ProgramError) as refused:
        Program.compile(text)
    (problem,) = [d for d in refused.value.diagnostics if "Post is not defined" in d.message]
    assert problem.line == 4
