"""Levels from the fifth on begin with rules for steering, which are the same everywhere."""

import re
from functools import cache
from pathlib import Path

import pytest

from logical_robots_tui.language.adapter import parse
from logical_robots_tui.language.source_text import prepare
from logical_robots_tui.language.tree import Rule
from tests.levels.playing import LEVELS, load_level, program_text, solution_of

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
