"""Programs of several teams, compiled together."""

import pytest

from logical_robots_tui.mind import Program, ProgramError

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
