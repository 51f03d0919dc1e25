"""Text for a terminal can hold anything and do nothing."""

import json

from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.cli.command import columns, harmless, line_of_json


@given(st.text())
def test_made_harmless_or_json_a_text_is_printable(text: str) -> None:
    line = line_of_json({"memory": text})
    assert line.isprintable()
    assert json.loads(line) == {"memory": text}
    assert all(c.isprintable() or c in " \u00a0\u3000" or c.isspace() for c in harmless(text))
    assert not set(harmless(text)) & {"\x1b", "\x9b", "\r", "\n", "\t", "\x7f", "\u202e"}


@given(st.text(st.characters(categories=["L", "N", "P", "S"])))
def test_what_is_harmless_stays_as_it_is(text: str) -> None:
    assert harmless(text) == text


def test_control_characters_are_shown_by_their_code_and_letters_stay_letters() -> None:
    assert harmless("a\x1b[2J\nb\u202ec\ud800") == r"a\x1b[2J\nb\u202ec\ud800"
    assert line_of_json(["ü\x9b\x07\u202e"]) == r'["ü\u009b\u0007\u202e"]'


def test_columns_line_up_and_end_without_blanks() -> None:
    assert columns([("A", "B"), ("long", "x"), ("y", "")]) == ["A     B", "long  x", "y"]
