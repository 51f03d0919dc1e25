"""Compiling: what a player is told about a program that is wrong."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.language.diagnostics import MOST_DIAGNOSTICS, count_words
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.mind import Diagnostic, Program, ProgramError, compilation
from tests.mind.rows import PAPER, ROBOT, remembered

GOOD = ROBOT + "m = 1;"
M = len(ROBOT) + 1  # column of what follows


def complaint(text: str) -> Diagnostic:
    with pytest.raises(ProgramError) as caught:
        Program.compile(text)
    return caught.value.diagnostics[0]


DEEP = "(-" * 2_000 + "1" + ")" * 2_000


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("A(1);\n" + GOOD + "\n# ) fine\nB(1));", 4, 5, "')' closes nothing"),
        ("Big(x) :- x > 1;\n" + ROBOT + "m = 1, Big();", 2, M + 7, "Big needs a value for x"),
        ("A(1);\n" + ROBOT + "m = 1, A;", 2, M + 7, "A is named without its arguments"),
        (ROBOT + "m = 1, sensor.clock + 1;", 1, M + 7, "+ gives a value; it is not a condition"),
        (ROBOT + "m = 1, Abs(m);", 1, M + 7, "Abs gives a value; it is not a condition"),
        (ROBOT + "m = 1 | A(m), m > 1;\nA(1);", 1, 7, "no value in one of the alternatives"),
        (ROBOT + "\nm = x, `(select 1 as x)`(x:);", 2, 8, "can't use SQL"),
        ("A(1);\n\0", 2, 1, "not text"),
        (f"{ROBOT}m = -{DEEP};", 1, M + 125, "nested too deeply"),
        (f"{ROBOT}m = {'1 + ' * 10_000}1;", 1, 1, "nested too deeply"),
        (
            '# a ( comment\n/* { */ A("# no comment; } (");\n' + ROBOT + "m = Wings(1);",
            3,
            M + 4,
            "",
        ),
        ("F(x) = y;" + ROBOT + "F(1, 2, m);", 1, M + 9, ""),
    ],
)
def test_a_mistake_is_told_with_its_place_and_without_terminal_codes(
    text: str, line: int, column: int, words: str
) -> None:
    first = complaint(text)
    assert words in f"{first.message} {first.hint}"
    assert (first.line, first.column) == (line, column)
    assert "\x1b" not in str(first)


@pytest.mark.parametrize(
    ("text", "more"),
    [(");" * 1_000, 900), ("".join(f"A(x) :- Foo{n}(x);\n" for n in range(117)), 18)],
)
def test_the_first_hundred_problems_are_shown_and_the_number_of_the_others(
    text: str, more: int
) -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile(text)
    *shown, last = caught.value.diagnostics
    assert len(shown) == MOST_DIAGNOSTICS
    assert last.message == f"{more} more problems not shown"
    assert count_words(caught.value.diagnostics) == f"100 errors, {last.message}"


def test_a_program_of_a_megabyte_is_refused_before_anything_reads_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compilation, "_compiler", None)
    assert "1,000,000 characters" in complaint("x" * 1_000_000).message


def test_the_listing_of_the_paper_compiles_as_printed() -> None:
    program = Program.compile(PAPER)
    robot, motion = program.predicate("Robot"), program.predicate("FreedomMotion")
    assert robot is not None
    assert robot.has_rows
    assert motion is not None
    assert (motion.line, motion.has_rows) == (1, False)
    assert "function of its arguments" in motion.reason


def test_predicates_come_in_the_order_of_the_text_after_the_inputs() -> None:
    program = Program.compile("B(1);\n\nA(2) :- B(1);\nC(x) += 1 :- A(x);\n" + GOOD)
    own = [(p.name, p.line) for p in program.predicates if p.kind == "program"]
    assert own == [("B", 1), ("A", 3), ("C", 4), ("Robot", 5)]
    assert [p.name for p in program.predicates[:2]] == ["Sensor", "Memory"]
    assert "WeightedAverage" in [p.name for p in program.predicates if p.kind == "prelude"]


def test_a_program_may_define_what_the_prelude_has() -> None:
    own = "WeightedAverage(pair) = Sum(pair.arg) * 100;"
    assert remembered("WeightedAverage{1 -> x :- x in [5, 6]}", rules=own) == 200
    assert remembered("WeightedAverage{1 -> x :- x in [5, 6]}") == 5.5


def test_a_recursion_that_ends_or_that_no_robot_needs_is_met_with_silence() -> None:
    rules = (
        "E(1, 2); E(2, 3); E(3, 1); D(x) Min= 0 :- x == 1; D(y) Min= D(x) + 1 :- E(x, y);"
        "Reach(x, y) distinct :- E(x, y); Reach(x, z) distinct :- Reach(x, y), E(y, z);"
    )
    assert remembered("D(3) + Sum{1 :- Reach(x, y)}", rules=rules) == 11
    assert remembered("1", rules="Step(0); Step(n + 1) :- Step(n);") == 1


@pytest.mark.parametrize(
    ("rule", "named"),
    [
        ("F(x) :- Sensor(sensor:), x in Range;", ["Range"]),
        ("F(x) = x; G(x) = F;", ["F"]),
        ("F(x) = Range(x); G() = F;", ["F"]),
        ("F(x) = Range(x);", []),
        ("F(x) = TryCast(x, Num); @NoInject(F); P() = 1; G() = P(); H := G(P: P);", []),
    ],
)
def test_a_function_without_its_arguments_is_told(rule: str, named: list[str]) -> None:
    warnings = Program.compile(f"{rule}\n{GOOD}").warnings
    assert [w.message.split()[0] for w in warnings if "without its arguments" in w.message] == named


def test_warnings_come_with_the_program() -> None:
    text = "Next(neighbor) :- Edge(neighbor), Edge(neighbour);\nEdge(1);\n" + GOOD
    (warning,) = Program.compile(text).warnings
    assert (warning.severity, warning.line, warning.column) == ("warning", 1, 40)
    assert Program.compile(GOOD).warnings == ()


def test_what_robot_leans_on_comes_before_what_leans_on_it() -> None:
    program = Program.compile("B(1); A(x) :- B(x); C(2); F(x) = x;\n" + ROBOT + "A(m), F(m) > 0;")
    assert program.needed == ("B", "A", "Robot")


def test_applying_the_same_text_again_gives_the_same_program() -> None:
    assert Program.compile(PAPER) is Program.compile(PAPER)


def test_a_space_before_the_brace_of_an_aggregate_is_allowed_only_there() -> None:
    for text, value in (
        ('"Sum {x}"', "Sum {x}"),
        ("Sum   {x :- x in [1, 2]}", 3),
        ("Sum\n  {x :- x in [1, 2]}", 3),
    ):
        assert remembered(text) == value


@settings(deadline=None)
@given(st.text(alphabet='aZ_ \n#"`/*(){}[];:-,=.|~1', max_size=60))
def test_preparing_keeps_the_length_and_the_lines(text: str) -> None:
    prepared = prepare(text)
    assert len(prepared.text) == len(prepared.skeleton) == len(text)
    assert [i for i, c in enumerate(prepared.skeleton) if c == "\n"] == [
        i for i, c in enumerate(text) if c == "\n"
    ]


@settings(max_examples=40, deadline=None)
@given(st.text(alphabet='AaRobt_ \n#"(){}[];:-,=.|~1+', max_size=40))
def test_nonsense_is_always_a_diagnostic_inside_the_text(nonsense: str) -> None:
    text = nonsense + "\n" + "Rob"
    with pytest.raises(ProgramError) as caught:
        Program.compile(text)
    lines = text.split("\n")
    for diagnostic in caught.value.diagnostics:
        assert 1 <= diagnostic.line <= len(lines)
        assert 1 <= diagnostic.column <= len(lines[diagnostic.line - 1]) + 1
        assert diagnostic.message


STILL = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-
  Sensor(robot_name:);
"""


def test_each_team_has_its_own_program_and_one_alone_is_that_of_any_team() -> None:
    texts = {"red": STILL, "blue": STILL + "Extra(1);\n"}
    program = Program.compile(texts)
    assert program.texts == texts
    assert (program.team, program.text) == ("red", STILL)
    blue = program.for_team("blue")
    assert (blue.texts, blue.text) == (texts, texts["blue"])
    assert blue.predicate("Extra")
    assert not program.predicate("Extra")
    assert blue.for_team("red") == blue.first == program
    assert blue.for_team("green") is blue
    assert blue.question("Extra(x)").gives == "rows"
    with pytest.raises(ProgramError):
        program.question("Extra(x)")
    program = Program.compile(STILL)
    assert program.texts == {"": STILL}
    assert program == Program.compile({"": STILL})
    assert program.for_team("red") is program.first is program


def test_an_error_names_the_team_and_the_line_in_its_program() -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile({"red": STILL, "blue": STILL + "Wrong(x :- ;\n"})
    assert caught.value.team == "blue"
    assert caught.value.diagnostics[0].line == STILL.count("\n") + 1
