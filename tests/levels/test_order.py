"""The course: it tells what the game tells, in order, with questions and rules for steering."""

import re
from collections.abc import Set
from functools import cache
from pathlib import Path

import pytest

from docs.learn import FOLDER, PICTURES, files
from logical_robots_tui.game.level_questions import Examiner, difference
from logical_robots_tui.language import tree
from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.reference import REFERENCE
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.tree import Rule
from tests.installed import CHECKOUT
from tests.levels.playing import LEVELS, load_level, program_text, slow, solution_of

NAMES = {entry.name for entry in REFERENCE if re.fullmatch("[A-Z][A-Za-z0-9]*", entry.name)}
MARKS = {
    "->": "->",
    "~": "~",
    ":=": ":=",
    "distinct": r"\bdistinct\b",
    "in": r"\bin\b",
    "if": r"\bif\b",
    "is null": r"\bis (not )?null\b",
    "==": "==",
    "!=": "!=",
    "&&": "&&",
    "||": r"\|\|",
    "+=": r"\+=",
    "++": r"\+\+",
    "@": r"@[A-Z]",
    "Memory": r"\bMemory\(",
}


def code_in(text: str) -> str:
    """The code of a lesson or a hint: its blocks but those of SQL, and what is in backticks."""
    blocks = re.findall(r"^```\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    return "\n".join([*blocks, *re.findall(r"`([^`\n]+)`", text)])


def used_in(code: str) -> set[str]:
    """The functions, aggregates and marks that occur in code, but for its comments and texts."""
    bare = re.sub(r'#.*|"[^"\n]*"', "", code)
    called = {name for name in NAMES if re.search(rf"\b{name}(\(| ?\{{|=)", bare)}
    return called | {mark for mark, pattern in MARKS.items() if re.search(pattern, bare)}


def told_in(lesson: str) -> set[str]:
    code = code_in(lesson)
    named = {name for name in NAMES if re.search(rf"\b{name}\b", lesson)}
    return named | {mark for mark, pattern in MARKS.items() if re.search(pattern, code)}


def test_nothing_is_used_before_its_lesson() -> None:
    told = set[str]()
    for level in map(load_level, LEVELS):
        told |= told_in(level.lesson)
        parts = {
            "briefing": level.briefing,
            "starter": program_text(level.starter),
            "solution": program_text(solution_of(level.name)),
            "hints": code_in("\n".join(level.hints)),
            "questions": "\n".join(question.answer for question in level.questions),
        }
        early = {part: used_in(code) - told for part, code in parts.items()}
        assert not any(early.values()), (level.name, early)


def misused_signs(scope: tree.Node, outer: Set[str] = frozenset({""})) -> list[str]:
    """The variables that `==` would give a value, and "=" for each condition with `=`."""
    nodes = list(tree.walk(tree.children(scope), lambda node: isinstance(node, tree.Aggregate)))
    atoms = [node for node in nodes if isinstance(node, tree.Atom)]
    calls = [atom for atom in atoms if atom.name[:1].isupper()]
    members = [node.element for node in nodes if isinstance(node, tree.Membership)]
    bound = {*outer, *map(tree.variable_of, tree.walk([*calls, *members]))}
    sides = [set(map(tree.variable_of, tree.operands(a.arguments))) for a in atoms if a.name == "="]
    misused = ["=" for pair in sides if pair <= bound]
    bound |= set().union(*sides)
    compared = {tree.variable_of(node.left) for node in nodes if isinstance(node, tree.Equation)}
    inner = [node for node in nodes if isinstance(node, tree.Aggregate)]
    return [*misused, *compared - bound, *(s for node in inner for s in misused_signs(node, bound))]


def pieces_of_the_course() -> list[str]:
    """The rules and bodies with an equals sign that a learner reads."""
    codes = re.findall(r"`([^`\n]+)`", (FOLDER / "learn.md").read_text("utf-8"))
    for page in FOLDER.glob("*.md"):
        blocks = re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
        codes += [code for language, code in blocks if language in ("", "prolog")]
    codes += [path.read_text("utf-8") for path in (CHECKOUT / "programs").rglob("*.l")]
    bare = (re.sub(r"^#.*\n?", "", code, flags=re.M) for code in codes)
    pieces = {piece.strip() for code in bare for piece in re.split(r";\s*$", code, flags=re.M)}
    return sorted(piece for piece in pieces if re.search(r"(:-.*|^\w+) ==? ", piece, re.S))


@pytest.mark.sampled
@pytest.mark.parametrize("piece", pieces_of_the_course(), ids=lambda text: text.split("(")[0])
def test_one_equals_sign_gives_a_value_and_two_compare(piece: str) -> None:
    text = piece if re.match(r"[A-Z]\w*\(", piece) else f"Piece() :- {piece}"
    rules = (rule for rule in parse(prepare(text)).statements if isinstance(rule, Rule))
    assert [sign for rule in rules for sign in misused_signs(rule)] == []


def test_the_course_is_up_to_date_and_has_no_picture_of_a_level_that_is_gone() -> None:
    for path, text in files().items():
        assert path.read_text("utf-8") == text, "`make learn` writes it anew"
    assert {p for p in files() if p.suffix == ".svg"} == set((FOLDER / PICTURES).iterdir())


def test_the_course_has_code_as_it_is_typed_and_no_solutions() -> None:
    page, solutions = (files()[FOLDER / name] for name in ("learn.md", "solutions.md"))
    for text in (program_text(solution_of(name)).strip() for name in LEVELS):
        assert text in solutions
        assert text not in page
    code = re.findall(r"`[^`\n]+`", page)
    assert code
    assert not [piece for piece in code if re.search("&(lt|gt|amp);", piece)]


QUICK = "04"  # levels before this one have small programs
LONGEST = 180  # characters, three lines of a dialog
NOTHING = (None, False, 0, "")


@pytest.mark.sampled
@pytest.mark.parametrize("name", [pytest.param(name, marks=slow(name > QUICK)) for name in LEVELS])
async def test_a_query_answers_a_question_and_no_constant_does(name: str) -> None:
    level = load_level(name)
    assert 2 <= len({question.ask for question in level.questions}) <= 3
    examiner = Examiner(level)
    try:
        for question in level.questions:
            assert len(question.ask) <= LONGEST
            assert (await examiner.check(question, question.answer)).is_right
            first, *others = [
                await examiner.rows(question, question.answer, tick) for tick in question.ticks
            ]
            for right in (first, *others):
                assert any(value not in NOTHING for row in right.rows for value in row), question
            assert any(difference(first, other) for other in others), question
            predicates = await examiner.predicates(question)
            for predicate in (each.name for each in predicates if each.has_rows):
                there = await examiner.rows(question, predicate, question.ticks[0])
                assert difference(there, first), f"{predicate} answers {question.ask}"
    finally:
        await examiner.close()


TAUGHT_BEFORE = {"Stop"}
"""What level 4 teaches and a starter may leave to the player."""


@cache
def rules_of(name: str) -> dict[str, list[Rule]]:
    """The rules of a program by the predicate that they define, but for Robot."""
    rules: dict[str, list[Rule]] = {}
    for each in parse(prepare(program_text(name))).statements:
        if isinstance(each, Rule) and each.name != "Robot":
            rules.setdefault(each.name, []).append(each)
    return rules


@pytest.mark.sampled
@pytest.mark.parametrize("name", LEVELS[4:])
def test_steering_is_given_and_the_same_in_every_level(name: str) -> None:
    library = rules_of("steering")
    assert library.keys() >= {"Freedom", "Steer", "FollowWall"}
    starter, solution = rules_of(load_level(name).starter), rules_of(solution_of(name))
    for program in (starter, solution):
        common = program.keys() & library.keys()
        assert {each: program[each] for each in common} == {each: library[each] for each in common}
    assert solution.keys() & library.keys() <= starter.keys() | TAUGHT_BEFORE


def test_the_documentation_lists_each_rule_with_its_arguments() -> None:
    page = (Path(__file__).parents[2] / "docs" / "dialect.md").read_text("utf-8")
    section = page.partition("\n## Steering\n")[2].partition("\n## ")[0]
    heads = re.findall(r"^(\w+\(.*?\)) =", program_text("steering"), re.MULTILINE)
    assert len(heads) == len(rules_of("steering"))
    assert re.findall(r"^\| `(.*?)` \|", section, re.MULTILINE) == heads
