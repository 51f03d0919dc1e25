"""Programs of several teams kept as one text."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.mind.program import TeamProgram, join_teams, split_teams

STILL = """\
Robot(robot_name:, desire: {left_engine: 0, right_engine: 0}, memory: "") :-
  Sensor(robot_name:);
"""

texts = st.text(st.sampled_from('ab#\n{}": 1') | st.characters(codec="utf-8"), max_size=30)
teams = st.dictionaries(st.text(min_size=1, max_size=5), texts, min_size=1, max_size=4)


@given(teams)
def test_joined_texts_come_apart_again(parts: dict[str, str]) -> None:
    assert split_teams(join_teams(parts)) == parts
    assert list(split_teams(join_teams(parts)) or ()) == list(parts)


@given(teams, st.text(max_size=5), texts)
def test_no_text_reaches_into_another(parts: dict[str, str], other: str, text: str) -> None:
    """A part that pretends to be several teams stays one part."""
    nested = {**parts, "mine": join_teams({**parts, other: text})}
    assert split_teams(join_teams(nested)) == nested


@pytest.mark.parametrize(
    "text",
    [
        "",
        STILL,
        "# teams: ",
        "# teams: {}",
        "# teams: []\n",
        '# teams: {"red": 2}\nonly one',
        '# teams: {"red": 1}\none\ntwo',
        '# teams: {"red": true}\none',
        '# teams: {"red": 0, "blue": 1}\none',
        '# teams: {"red": -1, "blue": 2}\none',
        "# teams: {nonsense",
    ],
)
def test_another_text_is_one_program(text: str) -> None:
    assert split_teams(text) is None


def test_each_team_has_its_own_program() -> None:
    text = join_teams({"red": STILL, "blue": STILL + "Extra(1);\n"})
    program = Program.compile(text)
    assert isinstance(program, TeamProgram)
    assert program.text == text
    assert (program.team, program.own.text) == ("red", STILL)
    blue = program.for_team("blue")
    assert blue.text == text
    assert blue.predicate("Extra")
    assert not program.predicate("Extra")
    assert blue.for_team("red") is program.for_team("red")
    assert blue.for_team("green") is blue
    assert blue.question("Extra(x)").gives == "rows"
    with pytest.raises(ProgramError):
        program.question("Extra(x)")


def test_an_error_names_the_team_and_the_line_in_its_program() -> None:
    with pytest.raises(ProgramError) as caught:
        Program.compile(join_teams({"red": STILL, "blue": STILL + "Wrong(x :- ;\n"}))
    assert caught.value.team == "blue"
    assert caught.value.diagnostics[0].line == STILL.count("\n") + 1


def test_one_program_is_that_of_any_team() -> None:
    program = Program.compile(STILL)
    assert program.own is program
    assert program.for_team("red") is program
