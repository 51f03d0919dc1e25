"""The rewritten functions of the package do what its own do."""

import copy
import importlib.util
from types import ModuleType
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from logica.compiler import rule_translate
from logica.parser_py import parse

from logical_robots_tui.language import package_patches


def unchanged(module: ModuleType) -> Any:
    origin = str(module.__file__)
    spec = importlib.util.spec_from_file_location(f"{module.__package__}.unchanged", origin)
    assert spec is not None
    assert spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


RULES, PARSE = unchanged(rule_translate), unchanged(parse)

variables = st.sampled_from("xyz").map(lambda name: {"variable": {"var_name": name}})
trees = st.recursive(
    variables | st.integers() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["a", "b", "combine"]), inner, max_size=3)
    ),
    max_leaves=12,
)


@st.composite
def tangled(draw: st.DrawFn) -> list[Any]:
    parts = draw(st.lists(trees, min_size=1, max_size=3))
    places = draw(st.lists(st.sampled_from(range(len(parts))), min_size=1, max_size=5))
    return [parts[place] for place in places]


@settings(deadline=None)
@given(tangled(), trees)
def test_a_variable_is_replaced_everywhere(tree: list[Any], new: Any) -> None:
    if "x" in RULES.AllMentionedVariables(new, dive_in_combines=True):
        new = 7  # would be replaced without end
    theirs = copy.deepcopy(tree)
    RULES.ReplaceVariable("x", new, theirs)
    package_patches.replace_variable("x", new, tree)
    assert tree == theirs


@settings(deadline=None)
@given(tangled(), st.booleans(), st.booleans())
def test_the_same_variables_are_found(tree: list[Any], dive: bool, is_select: bool) -> None:
    select = {"variable": tree} if is_select else tree
    arguments = {"dive_in_combines": dive, "this_is_select": is_select}
    assert package_patches.mentioned_variables(select, **arguments) == RULES.AllMentionedVariables(
        select, **arguments
    )


@settings(deadline=None)
@given(st.text(max_size=20), st.lists(st.tuples(st.integers(0, 25), st.integers(-5, 25))))
def test_a_part_of_a_text_knows_where_it_stands(text: str, cuts: list[tuple[int, int]]) -> None:
    package_patches.install()
    ours, theirs = parse.HeritageAwareString(text), PARSE.HeritageAwareString(text)
    for start, stop in cuts:
        ours, theirs = ours[start:stop], theirs[start:stop]
        assert str(ours) == str(theirs)
        places = [(part.start, part.stop, part.heritage) for part in (ours, theirs)]
        assert places[0] == places[1]
    assert all(ours[place] == theirs[place] for place in range(len(ours)))


@settings(deadline=None)
@given(tangled())
def test_a_copy_is_equal_and_tangled_alike_and_has_no_node_of_what_it_is_of(
    tree: list[Any],
) -> None:
    copied = package_patches.deep_copy(tree)
    assert copied == tree
    ours, theirs = nodes(copied), nodes(tree)
    assert not set(ours) & set(theirs)
    assert [ours.index(node) for node in ours] == [theirs.index(node) for node in theirs]


def nodes(tree: Any) -> list[int]:
    """What tells the dictionaries and lists of a tree apart, once for each place."""
    if not isinstance(tree, dict | list):
        return []
    inner = tree.values() if isinstance(tree, dict) else tree
    return [id(tree), *(node for part in inner for node in nodes(part))]


pieces = st.sampled_from([*'abc|,;:-#()[]{}`"\n', "||", ":-", "->", '"""', "/*", "*/"])


@given(
    st.lists(pieces, max_size=20).map("".join),
    st.sampled_from([",", ";", "|", "||", ":-", "->", ":", "-"]),
)
def test_a_text_is_split_at_the_same_places(text: str, separator: str) -> None:
    package_patches.install()
    found: list[object] = []
    for parser, split in ((parse, parse.SplitRaw), (PARSE, PARSE.SplitRaw)):
        try:
            parts = split(parser.HeritageAwareString(text), separator)
        except parser.ParsingException as error:
            found.append((str(error), error.location.start, error.location.stop))
        except StopIteration:
            found.append("a separator that a comment divides")
        else:
            found.append([(str(part), part.start, part.stop) for part in parts])
    assert found[0] == found[1]
