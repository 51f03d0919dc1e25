"""`x = a < b` is `(x = a) < b`: such places are marked, and the package is put in plain words."""

import ast
import re
from itertools import product
from pathlib import Path

import pytest
from logica import parser_py

from logical_robots_tui.language import tree
from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.definitions import Model
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.error_messages import _PLAIN
from logical_robots_tui.language.pitfalls import pitfalls
from logical_robots_tui.language.source_text import prepare

COMPARING = ["<", ">", "<=", ">=", "==", "!=", "in", "is", "is not"]
OPERATORS = [*COMPARING, "&&", "||", "->", "++", "+", "-", "*", "/", "%", "^"]
PLACES = [
    *("P() :- {};", "P(y) :- Q(y), {}, Q(y);", "P(y) :- Q(y) | {};", "P() :- ~({});"),
    *("P(y) :- y == {{f: {}}};", "P(y) :- y == [{}];", "P(y) :- y == F({});"),
    *("P(y) :- y == F(n: {});", "P(y) :- y == Sum{{1 :- z in [1], {}}};"),
    *("P(y) :- y == List{{{} :- z in [1]}};", "P(n: {});", "P(n? Max= ({})) distinct;"),
]


def found(text: str) -> list[Diagnostic]:
    parsed = parse(prepare(text))
    assert not parsed.problems, parsed.problems
    return list(pitfalls(Model(parsed.statements, parsed.source)))


def only(text: str) -> Diagnostic:
    marked = found(text)
    assert len(marked) == 1, text
    return marked[0]


def read(text: str) -> list[tree.Statement]:
    return parse(prepare(text)).statements


def is_read_first(place: str, operator: str) -> bool:
    """Whether the package's parser reads the equation before the operator."""
    plain, first = (place.format(f"{x} {operator} b") for x in ("x = a", "(x = a)"))
    return read(plain) == read(first)


CROSS = {(place, operator) for place in PLACES for operator in ("<", "in", "+")} | {
    (PLACES[0], operator) for operator in OPERATORS
}
"""Each place and each operator."""


@pytest.mark.parametrize("is_all", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_what_the_parser_reads_first_is_marked_in_its_column(*, is_all: bool) -> None:
    for place, operator in {*product(PLACES, OPERATORS)} if is_all else CROSS:
        text = place.format(f"x = a {operator} b")
        if not is_read_first(place, operator):
            assert found(text) == [], text
            continue
        one = only(text)
        assert (one.line, one.column) == (1, text.index("x = a") + 1)
        assert one.excerpt == f"x = a {operator} b"
        assert one.message.startswith(f"'=' is read before '{operator}'")
        assert one.hint.endswith(f"in parentheses: x = (a {operator} b).")
        assert found(place.format(one.hint.partition(": ")[2][:-1])) == [], text


def test_in_a_body_the_parser_reads_every_condition_and_arrow_after_an_equation() -> None:
    late = [operator for operator in OPERATORS if is_read_first(PLACES[0], operator)]
    assert late == ["<", ">", "<=", ">=", "==", "!=", "in", "&&", "||", "->"]


def test_in_an_if_every_equation_is_marked() -> None:
    for operator in OPERATORS:
        equation = f"x = a {operator} b"
        one = only(f"P(y) :- y == (if {equation} then 1 else 2);")
        assert (one.column, one.excerpt) == (18, equation)
        assert one.hint == f"Compare with '==': x == a {operator} b."
        for branches in (f"then {equation} else 2", f"then 2 else {equation}"):
            assert "x = a" in only(f"P(y) :- y == (if c < d {branches});").excerpt


HINTS = {
    "x = a < b && c": "the condition in parentheses: x = (a < b && c).",
    "x = (a) < (b)": "the comparison in parentheses: x = ((a) < (b)).",
    "x = F(a, b) < 3": "the comparison in parentheses: x = (F(a, b) < 3).",
    "x = a\n  < b": "the comparison in parentheses: x = (a < b).",
    "3 < a = x": "the comparison in parentheses: (3 < a) = x.",
    "x = !a == b": "the comparison in parentheses: x = (!a == b).",
    "ArgMax{a -> b && c :- a in b} == x": "the second part in parentheses: a -> (b && c).",
    f"x = {'long' * 30} < 3": "the comparison in parentheses.",
}
COMPARED = {
    "a = 3 && c == 4": "a == 3 && c == 4",
    "a = b || c = d": "a == b || c == d",
    "r.label = l && c": "r.label == l && c",
    "c && r.label = l": "c && r.label == l",
}


def test_the_advice_is_what_was_meant_and_among_conditions_a_comparison() -> None:
    for written, meant in HINTS.items():
        one = only(f"P(x) :- {written};")
        assert one.hint == f"Put {meant}"
        assert len(one.hint) <= 120
    for written, meant in COMPARED.items():
        one = only(f"P(x) :- Q(a, b, c, d, r, l), x == 1, {written};")
        assert one.message.startswith("'=' does not compare here"), written
        assert one.hint == f"Compare with '==': {meant}."


REACH = "@Recursive(P, 9); P(room: 1); P(room:) :- E(room:, other:), P(room: other); E(room: 1);"
BRANCHES = "P(y) :- y == (if c then x = 1 else x = 2);"


@pytest.mark.parametrize(
    ("text", "message", "hint"),
    [
        (BRANCHES, "This '=' applies even when another branch is chosen", "x = (if"),
        ("P(y) :- y == Count(list);", "Count(...) aggregates a single", "Count{x :- x in list}"),
        ("P(y) :- y -= 1;", "There is no -= in Logica", "y = x - 1"),
        ("P(y) :- y /= 1;", "There is no /= in Logica", "Write !="),
        ("P(x: 1),\n x = 1;", "This does not belong in the head of a rule", "Is a ';' missing"),
        ("P(x: 1) A(x) = 2;", "This does not belong in the head of a rule", "Is a ';' missing"),
        ("Q(n: 1); P() :- Q(n = 1);", "'=' does not name a column", "Write n: 1."),
        ("P(n = 1);", "'=' does not name a column", "Write n: 1."),
        ("P(n: {m = 1});", "'=' does not name a field of a record", "Write m: 1."),
        ("P(y) :- Q(y, z), z != null;", "A comparison with null never holds", "z is not null"),
        (REACH, "P uses itself and is not distinct", "Write distinct in all of its heads."),
        ("Q(1, 2); P(y) = P(x) + 1 :- Q(x, y);", "P uses itself and is not distinct", "distinct"),
        ("P(x) :- Q(x); Q(x) :- P(y), x in F(y);", "Q uses itself and is", "distinct"),
        ("P(x, z) :- P(x, y), P(y, z);", "P uses itself and is not", "distinct"),
        ("P(y) = (y == null);", "A comparison with null never holds", "Write y is null."),
    ],
)
def test_other_pitfalls_are_marked_once(text: str, message: str, hint: str) -> None:
    one = only(text)
    assert message in one.message
    assert hint in one.hint


def test_what_says_what_it_means_is_not_marked() -> None:
    programs = Path(__file__).with_name("silent.txt").read_text("utf-8").splitlines(keepends=True)
    assert {text: marked for text in programs if (marked := found(text))} == {}


@pytest.mark.parametrize(
    ("text", "negated", "column"),
    [
        ("Odd(n + 1) distinct :- Odd(n), n < 9, ~Odd(n - 1);", "Odd", 40),
        ("Out(x) :- R(x), ~In(x); In(x) :- S(x), Out(x);", "In", 18),
        ("P(x) :- R(x), ~(S(x), ~(S(x + 1), ~P(x)));", "P", 36),
        ("P(x) :- R(x), ~Q(x); Q := F(A: P); F(x) :- A(x);", "Q", 16),
        ("P(x) :- R(x), (P(x) => S(x));", "P", 16),
    ],
)
def test_a_predicate_on_its_own_negation_is_marked(text: str, negated: str, column: int) -> None:
    one = only(text)
    made = text.partition("(")[0]
    assert (one.line, one.column, one.severity) == (1, column, "warning")
    assert one.message == f"{made} depends on its own negation, ~{negated}"
    assert f"Negate only predicates that don't depend on {made}." in one.hint


PACKAGE = Path(parser_py.__path__[0]).parent
SAID = {
    re.sub(r">>|<<|\{(warning|end)\}", "", node.value)
    for path in PACKAGE.rglob("*.py")
    for node in ast.walk(ast.parse(path.read_bytes()))
    if isinstance(node, ast.Constant) and isinstance(node.value, str)
}


def test_each_message_is_one_of_the_package_and_has_a_hint() -> None:
    for pattern, _, hint in _PLAIN:
        for part in pattern.split("|^") if "(" not in pattern else [pattern]:
            literal = re.split(r"\s*[\\(\[|$.]", part.removeprefix("^"))[0].strip()
            literal = re.sub(r"( :| in)* \S+$", "", literal)  # what comes last may be filled in
            assert any(literal in said for said in SAID), literal
        assert re.fullmatch(r"[A-Z].*[.;?]", hint), hint
