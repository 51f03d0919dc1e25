"""Names are found where they are used, and renaming them changes nothing else."""

import re
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.errors import InputError
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.language.services.symbols import changed, renaming, sections, symbol_at
from tests.language.test_tree import FORMS, parsed
from tests.mind.test_broken import PROGRAMS, diagnostics

TEXTS = [FORMS, *(load_program(name).text for name in list_programs())]
SPAN = re.compile(r"span=(None|Span\(start=\d+, stop=\d+\))")


def meaning(text: str) -> str:
    return SPAN.sub("", repr(parsed(text).statements))


@given(st.sampled_from(TEXTS), st.data())
def test_a_renamed_program_means_the_same_and_back_it_is_the_same(
    text: str, data: st.DataObject
) -> None:
    offset = data.draw(st.sampled_from([m.start() for m in re.finditer(r"\b[A-Za-z_]", text)]))
    symbol = symbol_at(text, offset)
    new = "Qz" if symbol is not None and symbol.is_predicate else "qz"
    try:
        changes = renaming(text, offset, new)
    except InputError:
        return
    assert symbol is not None
    renamed = changed(text, changes)
    assert re.sub(rf"\b{new}\b", symbol.name, meaning(renamed)) == meaning(text)
    place = re.search(rf"\b{new}\b", renamed)
    assert place is not None
    back = changed(renamed, renaming(renamed, place.start(), symbol.name))
    assert meaning(back) == meaning(text)
    spelled = {c.start for c in changes if c.start == c.stop}  # `name:` was not one name
    assert back == changed(
        text, [replace(c, text=f" {symbol.name}") for c in changes if c.start in spelled]
    )


TEXT = """\
A(x:, n? += y) distinct :- B(x, y), z == "x", sensor.x > `x`, C(..z);
A(x) :- B(x), x == Min{y :- B(x, y)};
"""


@pytest.mark.parametrize(
    ("word", "new", "result"),
    [
        ("x:", "v", "A(x: v, n? += y) distinct :- B(v, y), z"),
        ("z", "v", 'v == "x", sensor.x > `x`, C(..v);'),
        ("y :-", "_v", "x == Min{_v :- B(x, _v)};"),
        ("A", "D", "D(x:, n?"),
        *(("A", new, "another predicate here") for new in "BC"),
        *(("A", new, "A predicate's name starts with a capital") for new in ("b", "Ä", "B c", "")),
        *(("A", new, "is a word of the language") for new in ("Max", "Sensor")),
        *(("x:", new, "A variable's name starts") for new in ("B", "x_1", "é", "1")),
        *(("x:", new, "another variable") for new in "yz"),
        ("x:", "in", "is a word of the language"),
        *((word, "v", "Put the cursor on") for word in ("n?", '"x', "x >", "Min", "distinct", ";")),
    ],
)
def test_a_new_name_that_would_mean_something_else_is_refused(
    word: str, new: str, result: str
) -> None:
    try:
        text = changed(TEXT, renaming(TEXT, TEXT.index(word), new))
    except InputError as error:
        text = error.message
    assert result in text


@given(st.text('Ax_1.:(){}";#`@, \n-=?~é🤖'), st.integers(0, 20))
def test_any_text_has_sections_in_order_and_names_where_they_stand(text: str, offset: int) -> None:
    places = [(section.start, section.stop) for section in sections(text)]
    assert places == sorted(places)
    for name, start, stop in sections(text):
        assert text.replace("\r", "\n")[start:stop].startswith(name)
    if symbol := symbol_at(text, offset):
        assert all(text.startswith(symbol.name, place) for place in symbol.places)


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_a_hint_proposes_corrects_the_mistake(name: str) -> None:
    text = PROGRAMS[name][0]
    mistakes = diagnostics(text)
    for mistake in mistakes:
        if mistake.fix:
            others = diagnostics(changed(text, [mistake.fix]))
            assert len(others) <= len(mistakes)
            assert mistake not in others


def test_a_missing_semicolon_hides_no_statement() -> None:
    assert [
        name for name, *_ in sections("A(1);\nB(x) :- A(x)\nC(x) :-\n  A(x);\n@Limit(C, 1)")
    ] == [
        *"ABC",
        "@Limit",
    ]
