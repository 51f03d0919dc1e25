"""One word for one thing: what the game and its pages say, in the words of the glossary."""

from __future__ import annotations

import re

import pytest

from tests.house.examples import PAGES
from tests.installed import CHECKOUT

INSTEAD = {
    r"\bsecond goals?\b": "bonus goal",
    r"\bin no way\b": "no match",
    r"\bnothing says what\b": "has no value",
    r"\b[Nn]obody has thought\b": "no decision yet",
    r"\bone of \d+ ways\b": "1 of 31 matches",
    r"\bin whose mind\b(?=\")": "the robot to ask",
    r"\b(?<!here )is no (?!longer|more|other|such|less|one|need)\w+": "is not a",
    r"\ball processors\b|\bevery processor\b|\bper processor\b": "core",
    r"\bshifted (start|one)s?\b": "varied start",
    r"\b(other|another|old|two) futures?\b": "branch",
    r"\b(this|your|one|busy) machines?\b(?! learning)": "computer",
    r"\bsigns in the labyrinth\b": "symbols on the map",
    r"\bGo to the (labyrinth|mistake)\b": "the map, the error",
}
"""Words that are not used, and what is said instead."""

FILES = [
    *PAGES,
    *sorted(CHECKOUT.glob("levels/*.toml")),
    *sorted(CHECKOUT.glob("logical_robots_tui/**/*.py")),
]


@pytest.mark.parametrize("pattern", INSTEAD)
def test_a_word_stands_for_one_thing(pattern: str) -> None:
    found = [
        f"{path.relative_to(CHECKOUT)}:{number}: {line.strip()}"
        for path in FILES
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        if re.search(pattern, line)
    ]
    assert found == [], f"Say: {INSTEAD[pattern]}"
