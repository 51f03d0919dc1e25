"""What the `logica` package says, in plain words."""

import ast
import re
from pathlib import Path

from logica import parser_py

from logical_robots_tui.language.error_messages import _PLAIN

PACKAGE = Path(parser_py.__path__[0]).parent
SAID = {
    re.sub(r">>|<<|\{(warning|end)\}", "", node.value)
    for path in PACKAGE.rglob("*.py")
    for node in ast.walk(ast.parse(path.read_bytes()))
    if isinstance(node, ast.Constant) and isinstance(node.value, str)
}


def test_each_message_is_one_of_the_package_and_has_a_hint() -> None:
    for pattern, _, hint in _PLAIN:
        for part in pattern.split("|^") if "(" not in pattern else [pattern]:
            literal = re.split(r"\s*[\\(\[|$.]", part.removeprefix("^"))[0].strip()
            literal = re.sub(r"( :| in)* \S+$", "", literal)  # what comes last may be filled in
            assert any(literal in said for said in SAID), literal
        assert re.fullmatch(r"[A-Z].*[.;?]", hint), hint
