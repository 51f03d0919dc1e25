"""The tree says what a program says: there and back, with each node at its place."""

from __future__ import annotations

import dataclasses
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.language import package_patches, tree
from logical_robots_tui.language.adapter import _Reader, _Writer, parse
from logical_robots_tui.language.source_text import prepare
from tests.mind.differential.corpus import CASES
from tests.mind.test_no_false_alarm import SUBTLE

package_patches.install()  # as in the compile process

FORMS = """
Fact("a", 1.5, {x: true, y: null}, [1, [2]]);
Sum(total? += x * 2, best? Max= x) distinct :- Fact(y, x) | Fact(x, y), ~Fact(x:);
Chosen(x) = (if x > 1 then "many" else if x == 1 then "one" else "none");
Double(x) --> x + x;
Rest(a:, ..r) :- Other(a:, ..r), Cast(a, "INT64") == 3;
Close(x) :- ((if x > 1 then 2 else x) ) is not null, (x + 1) * (x - 2) == (if x == 1 then x else 2),
  (Fact(x, y) | (y == 2)), x == ((1) + 2), ~(Fact(x, y), (x + 1) in [1]), ")" ++ x == (x ++ "(");
Made := Old(Near: Far, Limit: 3);
@Limit(Rest, 3);
@OrderBy(Rest, "a DESC");
Odd(x) couldbe :- x in [1, 3] && x != 2, n += (1 :- Odd(y)), z == ArgMax{y -> x :- Odd(y)};
"""


PAIR = re.compile(r"\([^(){}[\]]*\)|\[[^(){}[\]]*\]|{[^(){}[\]]*}")


def programs() -> list[str]:
    shipped = [load_program(name).text for name in list_programs()]
    return [FORMS, *shipped, *SUBTLE, *(text for _, text, _ in CASES)]


def statements(text: str) -> list[tree.Statement]:
    return parse(prepare(text)).statements


@pytest.mark.parametrize("text", programs())
def test_what_goes_to_the_package_comes_back_as_it_was(text: str) -> None:
    source = prepare(text)
    reader, writer = _Reader(source), _Writer(source.text)
    for statement in parse(source).statements:
        assert reader.statement(writer.statement(statement)) == statement


@pytest.mark.parametrize("text", programs())
def test_each_name_and_each_span_is_where_it_stands(text: str) -> None:
    source = prepare(text)
    for node in tree.walk(parse(source).statements):
        if node.span:
            assert 0 <= node.span.start <= node.span.stop <= len(text)
            piece = source.skeleton[slice(*node.span)]
            while PAIR.search(piece):
                piece = PAIR.sub("", piece)
            assert not {*"(){}[]"} & {*piece}
        for part in dataclasses.fields(node):
            value = getattr(node, part.name)
            if isinstance(value, tree.Name) and value.start >= 0:
                assert source.text.startswith(value, value.start)
        for inner in tree.children(node):
            if node.span and inner.span:
                assert node.span.start <= inner.span.start
                assert inner.span.stop <= node.span.stop


def test_a_rule_written_with_an_arrow_knows_its_place() -> None:
    text = "# a comment\nDouble(x) --> xx + x;"
    (found,) = [n for n in tree.walk(statements(text)) if tree.variable_of(n) == "xx"]
    assert found.span
    assert text[slice(*found.span)].strip() == "xx"


def test_spans_do_not_tell_nodes_apart() -> None:
    one, other = statements("P(x) :- Q(x);"), statements("\n P( x ) :-\n Q( x ) ;")
    assert one == other
    assert hash(one[0]) == hash(other[0])
    assert one[0].span != other[0].span


def test_a_node_that_does_not_change_is_the_same_node() -> None:
    (rule,) = statements("P(x) :- Q(x), R(y);")
    assert tree.rebuild(rule, lambda node: node) is rule
    assert tree.substitute(rule, {"z": tree.Number("1")}) is rule


def test_variables_are_substituted_everywhere_and_nothing_else_is() -> None:
    (rule,) = statements("P(x) :- y == Sum{x :- Q(x, y)}, R(x: z);")
    (expected,) = statements("P(9) :- y == Sum{9 :- Q(9, y)}, R(x: z);")
    assert tree.substitute(rule, {"x": tree.Number("9")}) == expected


def test_variables_inside_aggregates_are_their_own() -> None:
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
