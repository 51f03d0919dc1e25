"""The page on the dialect and the help on functions: complete, true, readable."""

import json
import math
import re
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from logical_robots_tui import Program, ProgramError
from logical_robots_tui.language.definitions import built_in_names, prelude
from logical_robots_tui.language.reference import REFERENCE, find_help, similar
from logical_robots_tui.mind.compiling.dialect import runs as runs_here
from tests.mind.rows import ROBOT, all_remembered, python, row, slow, think

PAGE = " ".join((Path(__file__).parents[2] / "docs/dialect.md").read_text("utf-8").split())
NOTHING = "x in Range(0)"

STATEMENTS: list[tuple[str, str, Any, object]] = [
    ("`60 / 100` is `0.6`", "60 / 100", "", 0.6),
    ("A number divided by zero is infinite", "1 / 0 > 10 ^ 300", "", 1),
    ("Null goes in, null comes out", "Sqrt(null) is null", "", 1),
    ("`Greatest` ignore nulls", "Greatest(null, 2)", "", 2),
    ("An aggregate over nothing is null", f"Max{{x :- {NOTHING}}} is null", "", 1),
    ("so is `List{...}` of nothing", f"List{{x :- {NOTHING}}} is null", "", 1),
    ("`Count` of nothing is 0", f"Count{{x :- {NOTHING}}}", "", 0),
    ("`Like` are case-sensitive", '"a" == "A" || Like("a", "A")', "", 0),
    ("may be written with a space before the brace", "WeightedAverage {1 -> 2}", "", 2),
    ("`memory.count` is null while the memory is still", "memory.count is null", "", 1),
    (
        '`{count: 0, plan: {at: ""}, seen: [""]}`',
        'TryCast(memory, {count: 0, plan: {at: ""}, seen: [""]}).count + 1',
        {"count": "2", "other": 1},
        3,
    ),
    ("numbers become strings where a string is", 'TryCast(5, "") ++ "!"', "", "5!"),
    ("or null", "TryCast(memory, 0) is null", "x", 1),
    ("A type may also be written out: `Num`", "TryCast(memory, Num)", 5, 5),
    ("`Int`", "TryCast(memory, Int)", "7", 7),
    ("`Str`", "TryCast(memory, Str)", "a", "a"),
    ("`Bool`", "TryCast(memory, Bool)", "true", 1),
    (
        "`{count: Num, plan: {at: Str}}`",
        "TryCast(memory, {count: Num, plan: {at: Str}}).plan.at",
        {"count": 1, "plan": {"at": "home"}},
        "home",
    ),
    ("a list of a type `[Str]`", "Element(TryCast(memory, [Str]), 0)", ["a"], "a"),
    ('`"STRUCT(count DOUBLE)"`', 'TryCast(memory, "STRUCT(count DOUBLE)").count', {"count": 3}, 3),
    ("`Cast(2.5, Int)` is 3", "Cast(2.5, Int)", "", 3),
    ("`Cast(Sqrt(6.25), Int)` is 2", "Cast(Sqrt(6.25), Int)", "", 2),
    (
        "`{'n': 1, 's': 'it\\'s'}`",
        """ToString({n: 1, s: "it's"}) == "{'n': 1, 's': 'it\\'s'}\"""",
        "",
        True,
    ),
    ("Fields that the record lacks are null", "TryCast(memory, {a: Num}).a is null", {}, 1),
]
"""What the page says, an expression that shows it, with a memory, and its value."""


def test_the_statements_of_the_page_hold() -> None:
    assert [said for said, *_ in STATEMENTS if said not in PAGE] == []
    for memory in [memory for n, (*_, memory, _) in enumerate(STATEMENTS) if is_new(n, memory)]:
        expected = {text: value for _, text, with_, value in STATEMENTS if with_ == memory}
        assert all_remembered(expected, memory) == expected


def is_new(number: int, memory: object) -> bool:
    return memory not in [earlier for *_, earlier, _ in STATEMENTS[:number]]


@pytest.mark.parametrize(
    ("said", "rule", "body", "is_right"),
    [
        ("`Love(sensor.radar)`", "Love(radar, name) = Size(radar)", "m = Love(sensor.radar)", True),
        ("`P()` of `P(1)` are correct", "P(1)", "P(), m = 1", True),
        ("`F()` of `F(x) = x + 1`", "F(x) = x + 1", "m = F()", False),
        ("or of `F(x) :- x > 3` is an error", "F(x) :- x > 3", "F(), m = 1", False),
    ],
)
def test_arguments_are_left_out_as_told(said: str, rule: str, body: str, is_right: bool) -> None:
    assert said in PAGE
    with nullcontext() if is_right else pytest.raises(ProgramError):
        Program.compile(f"{rule};\n{ROBOT} {body};")


@pytest.mark.parametrize(("asked", "depth"), [("", 32), slow("@Recursive(Far, 1000);", 1000)])
def test_recursion_goes_as_deep_as_the_page_says(asked: str, depth: int) -> None:
    assert "at most 32 steps after the first one, or as many as `@Recursive(P, depth)` says" in PAGE
    assert "(at most 1,000)" in PAGE
    rules = f"{asked} Far(x) distinct :- x in [0]; Far(x + 1) distinct :- Far(x);"
    (decision,) = think(f"{rules} {ROBOT} m = Max{{x :- Far(x)}};", [row("Ada")], {})
    assert decision.memory == depth


def test_every_refused_word_that_security_names_is_refused() -> None:
    page = (Path(__file__).parents[2] / "docs/security.md").read_text("utf-8")
    named = re.search(r"In Logica's words: (.*?)are refused", page, re.DOTALL)
    assert named
    for word in re.findall(r"`(\w+)`", named[1]):
        if word[0].isupper():
            with pytest.raises(ProgramError):
                Program.compile(f'{ROBOT} m = {word}("x");')


SPELT = {"Agg+": "+=", "Agg++": "++=", "1": "1="}


def same(value: Any, expected: Any) -> bool:
    if isinstance(expected, int | float) and isinstance(value, int | float):
        return math.isclose(value, expected, abs_tol=1e-9)
    return bool(value == expected)


@pytest.mark.sampled
@pytest.mark.parametrize("start", range(14))
def test_each_example_gives_the_result_that_is_told(start: int) -> None:
    entries = REFERENCE[start::14]  # more in one program are slower
    values = all_remembered([entry.example for entry in entries])
    for entry in entries:
        assert same(values[entry.example], json.loads(entry.result)), entry.name


def test_everything_that_compiles_is_explained_and_nothing_else() -> None:
    runs = {SPELT.get(name, name) for name in built_in_names() if runs_here(name)}
    library = {name for name in prelude().definitions if name.isidentifier()}
    assert {entry.name for entry in REFERENCE} == runs | library | {"->", "=>", "~", "if"}


def test_each_entry_is_one_short_line_and_mentions_its_name() -> None:
    assert len({entry.name for entry in REFERENCE}) == len(REFERENCE)
    for entry in REFERENCE:
        assert entry.name in entry.signature
        assert entry.summary
        assert max(map(len, (entry.signature, entry.summary, entry.example))) <= 100


def test_help_is_found_whatever_the_case_of_the_letters() -> None:
    assert find_help("argmin") == find_help("ArgMin")
    assert find_help("Wings") is None
    assert similar("Squrt") == "Sqrt"
    assert similar("Xyzzyx") == ""


def test_the_tables_of_the_docs_are_made_from_the_data() -> None:
    from docs.reference import PAGES

    for path, text in PAGES.items():
        assert path.read_text(encoding="utf-8") == text(), "run `make reference`"


def test_reading_the_help_needs_no_compiler() -> None:
    script = (
        "import sys, logical_robots_tui.language.reference as r; "
        "print(len(r.REFERENCE), 'logica' in sys.modules)"
    )
    assert python(script).split() == [str(len(REFERENCE)), "False"]
