"""The tree says what a program says, whatever its blanks are: each node is at its place."""

import dataclasses
import re
import unicodedata
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.language import package_patches, tree
from logical_robots_tui.language.adapter import Parsed, _TreeReader, _Writer, parse
from logical_robots_tui.language.source_text import Prepared, prepare
from logical_robots_tui.language.tree import Statement
from tests.mind.differential.corpus import CASES
from tests.mind.test_no_false_alarm import SUBTLE

package_patches.install()  # as in the compile process

FORMS = Path(__file__).with_name("forms.l").read_text("utf-8")

PAIR = re.compile(r"\([^(){}[\]]*\)|\[[^(){}[\]]*\]|{[^(){}[\]]*}")

TEXTS = {
    "forms": [FORMS],
    "subtle programs": SUBTLE,
    "constructs": sorted({rules for _, rules, _ in CASES}),
}
"""Texts by what they are; any other name is that of a shipped program."""

PROGRAMS = [*TEXTS, *(pytest.param(name, marks=pytest.mark.sampled) for name in list_programs())]


@cache
def parsed(text: str) -> Parsed:
    return parse(prepare(text))


def texts(name: str) -> list[str]:
    return TEXTS[name] if name in TEXTS else [load_program(name).text]


def statements(text: str) -> list[tree.Statement]:
    return parsed(text).statements


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_goes_to_the_package_comes_back_as_it_was(name: str) -> None:
    for text in texts(name):
        source = parsed(text).source
        reader, writer = _TreeReader(source), _Writer(source.text)
        for statement in statements(text):
            assert reader.statement(writer.statement(statement)) == statement, text


@pytest.mark.parametrize("name", PROGRAMS)
def test_each_name_and_each_span_is_where_it_stands(name: str) -> None:
    for text in texts(name):
        source = parsed(text).source
        for node in tree.walk(statements(text)):
            assert stands_at_its_place(node, source), (text, node)


def stands_at_its_place(node: tree.Node, source: Prepared) -> bool:
    """Whether the span of a node is whole, has its children inside, and names are in the text."""
    names = [getattr(node, field.name) for field in dataclasses.fields(node)]
    are_there = all(
        source.text.startswith(name, name.start)
        for name in names
        if isinstance(name, tree.Name) and name.start >= 0
    )
    if not node.span:
        return are_there
    piece = source.skeleton[slice(*node.span)]
    while PAIR.search(piece):
        piece = PAIR.sub("", piece)
    return (
        are_there
        and 0 <= node.span.start <= node.span.stop <= len(source.text)
        and not {*"(){}[]"} & {*piece}
        and all(
            node.span.start <= inner.span.start and inner.span.stop <= node.span.stop
            for inner in tree.children(node)
            if inner.span
        )
    )


def test_a_rule_written_with_an_arrow_knows_its_place() -> None:
    text = "# a comment\nDouble(x) --> xx + x;"
    (found,) = [n for n in tree.walk(statements(text)) if tree.variable_of(n) == "xx"]
    assert found.span
    assert text[slice(*found.span)].strip() == "xx"


def test_spans_do_not_tell_nodes_apart_and_one_that_does_not_change_is_the_same() -> None:
    one, other = statements("P(x) :- Q(x);"), statements("\n P( x ) :-\n Q( x ) ;")
    assert one == other
    assert hash(one[0]) == hash(other[0])
    assert one[0].span != other[0].span
    assert tree.rebuild(one[0], lambda node: node) is one[0]
    assert tree.substitute(one[0], {"z": tree.Number("1")}) is one[0]


def test_variables_are_substituted_but_those_inside_aggregates_are_their_own() -> None:
    (rule,) = statements("P(x) :- y == Sum{x :- Q(x, y)}, R(x: z);")
    (expected,) = statements("P(9) :- y == Sum{9 :- Q(9, y)}, R(x: z);")
    assert tree.substitute(rule, {"x": tree.Number("9")}) == expected
    (rule,) = statements("P(x) :- x == Sum{y :- Q(y)}, ~R(z);")
    assert tree.variables(rule) == {"x"}
    assert tree.variables(rule, inside=True) == {"x", "y", "z"}


@given(st.integers(1, 40))
def test_a_walk_visits_outer_nodes_before_inner_ones_and_each_once(depth: int) -> None:
    (rule,) = statements(f"P({'[' * depth}1{']' * depth});")
    nodes = [*tree.walk(rule)]
    lists = [node for node in nodes if isinstance(node, tree.List)]
    assert len(lists) == depth
    assert [tree.children(one).__next__() for one in lists[:-1]] == lists[1:]
    assert isinstance(nodes[-1], tree.Number)


TEXT = "A(x) :- # a comment\n  x = (if 1 is null then 2 else 3), x in [2];\nB() = Sum{x :- A(x)};\n"
SPACES = [
    character
    for character in map(chr, range(128, 0x10000))
    if unicodedata.category(character) in ("Zs", "Zl", "Zp")
]


def read(text: str) -> list[Statement]:
    parsed = parse(prepare(text))
    assert parsed.problems == []
    return parsed.statements


def test_spaces_of_every_width_are_spaces() -> None:
    assert {"\u00a0", "\u2009", "\u3000", "\u2028"} < set(SPACES)
    for space in SPACES:
        assert read(TEXT.replace(" ", space)) == read(TEXT)


@pytest.mark.parametrize("end", ["\r", "\r\n"])
def test_every_end_of_a_line_ends_it(end: str) -> None:
    (problem,) = parse(prepare(f"{TEXT}C(x) :- x = ;".replace("\n", end))).problems
    assert (problem.line, problem.column) == (4, 12)
    assert len(read(TEXT.replace("\n", end))) == 2
