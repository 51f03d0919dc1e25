"""One word for one thing: what the game and its pages say, in the words of the glossary."""

import ast
import re
from collections.abc import Iterator, Mapping

from logical_robots_tui.errors import joined
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
    r"\bquestions? in Logica\b|\b(Logica|last) question\b": "query",
    r"\bhand-ins?\b": "submission",
    r"\boutside the map\b": "outside the labyrinth",
    r"\b(the|an)other course\b": "the other branch",
}
"""Words that are not used, and what is said instead."""

FILES = [
    *PAGES,
    *sorted(CHECKOUT.glob("levels/*.toml")),
    *sorted(CHECKOUT.glob("logical_robots_tui/**/*.py")),
]


def test_a_word_stands_for_one_thing() -> None:
    anything = re.compile("|".join(f"(?:{pattern})" for pattern in INSTEAD))
    suspects = [path for path in FILES if anything.search(path.read_text("utf-8"))]
    found = [
        f"{path.relative_to(CHECKOUT)}:{number}: {line.strip()} (say: {other})"
        for path in suspects
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        for pattern, other in INSTEAD.items()
        if re.search(pattern, line)
    ]
    assert found == []


MESSAGES = {
    **dict.fromkeys(("InputError", "LevelError", "LedgerError", "LevelFinding"), 0),
    **dict.fromkeys(("Notice", "problem", "diagnostic", "_complain", "_warn", "_error"), 1),
    **dict.fromkeys(("Diagnostic", "_refusal", "_warning"), 2),
    "problem_in": 2,
    **dict.fromkeys(("diagnostic_at", "Oddity"), 3),
}
"""Which argument of a call is a message."""

NAMES = ("points for ", "until for ")
"""Names of columns, with which messages begin."""


def beginnings(node: ast.expr, known: Mapping[str, list[ast.expr]]) -> Iterator[str]:
    match node:
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=[left, *_]) | ast.BinOp(left=left):
            yield from beginnings(left, known)
        case ast.IfExp(body=one, orelse=other):
            yield from (text for each in (one, other) for text in beginnings(each, known))
        case ast.Name(id=name):
            yield from (text for each in known.get(name, ()) for text in beginnings(each, {}))


def messages(function: ast.AST) -> Iterator[str]:
    known: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            known.setdefault(node.targets[0].id, []).append(node.value)
    for node in ast.walk(function):
        if isinstance(node, ast.Call):
            at = MESSAGES.get(getattr(node.func, "attr", getattr(node.func, "id", "")), 9)
            for message in node.args[at : at + 1]:
                yield from beginnings(message, known)


HAS_MESSAGES = re.compile(rf"\b({'|'.join(MESSAGES)})\(")


def test_messages_begin_with_a_capital_or_go_on_from_their_place() -> None:
    found = [
        f"{path.relative_to(CHECKOUT)}: {message}"
        for path in sorted(CHECKOUT.glob("logical_robots_tui/**/*.py"))
        if HAS_MESSAGES.search(text := path.read_text("utf-8"))
        for function in ast.walk(ast.parse(text))
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        for message in messages(function)
        if message[:1].islower() and joined("x", message)[1] == ":"
        if not message.startswith(NAMES)
    ]
    assert found == []
