"""Programs that are right get no diagnostic, whatever they are made of."""

from pathlib import Path

import pytest

from logical_robots_tui.game import list_programs, load_program
from tests.mind.checking import problems
from tests.mind.differential.corpus import CASES
from tests.mind.rows import PAPER, ROBOT

SUBTLE = [
    line
    for line in Path(__file__).with_name("subtle.txt").read_text("utf-8").splitlines()
    if not line.startswith("#")
]


def found(text: str) -> list[str]:
    return [str(problem) for problem in problems(text)]


@pytest.mark.sampled
@pytest.mark.parametrize("topic", sorted({topic for topic, _, _ in CASES}))
def test_a_construct_of_the_language_is_met_with_silence(topic: str) -> None:
    texts = [
        f"{rules}\n{ROBOT}Memory(robot_name:, memory:), m = [({expression})];"  # fields unknown
        for of, rules, expression in CASES
        if of == topic
    ]
    assert {text: told for text in texts if (told := found(text))} == {}


def test_subtle_programs_are_met_with_silence() -> None:
    texts = [PAPER, *(f"{rules}\n{ROBOT}m = 1;" for rules in SUBTLE)]
    assert {text: told for text in texts if (told := found(text))} == {}


@pytest.mark.sampled
@pytest.mark.parametrize("name", list_programs())
def test_a_shipped_program_is_met_with_silence(name: str) -> None:
    assert found(load_program(name).text) == []
