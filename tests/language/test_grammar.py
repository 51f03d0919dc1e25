"""The TextMate grammar in the docs colours what the game's editor colours."""

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from docs.reference import GRAMMAR, SCOPES
from logical_robots_tui.game import list_programs, load_program
from logical_robots_tui.language.services.lexer import LineStates, pieces
from tests.language.test_tree import FORMS

PATTERNS = json.loads(GRAMMAR.read_text("utf-8"))["patterns"]
STRANGE = """\
A(x)\\ndef;
/* B */ C '''d
`h 1.5e3 x1 @Limit( limit (x: x:- y:= 'f\\'' "g
D \"\"\"i
E
\"\"\" F /*
end */ Q
"""


def coloured(lines: list[str]) -> Iterator[list[tuple[int, int, str]]]:
    """Yield what an engine for such grammars colours in each line: the first match counts."""
    state: Any = None
    for line in lines:
        parts: list[tuple[int, int, str]] = []
        start = 0
        while True:
            if state is not None:
                match = re.compile(state["end"]).search(line, start if parts else 0)
                stop = match.end() if match else len(line)
                parts.append((start, stop, state["name"]))
                if match is None:
                    break
                start, state = stop, None
            matches = [
                (match.start(), number, match)
                for number, pattern in enumerate(PATTERNS)
                if (
                    match := re.compile(pattern.get("match", pattern.get("begin"))).search(
                        line, start
                    )
                )
            ]
            if not matches:
                break
            _, number, match = min(matches, key=lambda found: found[:2])
            pattern = PATTERNS[number]
            if "begin" in pattern:
                parts.append((match.start(), match.end(), pattern["name"]))
                start, state = match.end(), pattern
            else:
                if "name" in pattern:
                    parts.append((*match.span(), pattern["name"]))
                start = match.end()
        yield parts


@pytest.mark.parametrize("name", ["strange", "forms", *list_programs()])
def test_each_character_has_the_scope_of_its_kind(name: str) -> None:
    texts = {"strange": STRANGE, "forms": FORMS}
    lines = (texts[name] if name in texts else load_program(name).text).split("\n")
    states = LineStates()
    for row, parts in enumerate(coloured(lines)):
        expected: dict[int, str] = {}
        for start, stop, kind in pieces(lines[row], states.at(row, lines.__getitem__)):
            expected |= dict.fromkeys(range(start, stop), kind)
        scopes = {
            column: scope.removesuffix(".logica").split(".")[0]
            for start, stop, scope in parts
            for column in range(start, stop)
        }
        kinds = {"comment": "line_comment"}
        names = {c: SCOPES[kinds.get(kind, kind)].split(".")[0] for c, kind in expected.items()}
        assert scopes == names, lines[row]
