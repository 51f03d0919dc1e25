"""What is wrong with a program that would compile silently and fail later, or is not allowed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from logica.compiler import dialects, expr_translate

from logical_robots_tui.mind import complaints
from logical_robots_tui.mind.diagnostics import ProgramError
from logical_robots_tui.mind.program import INPUTS
from logical_robots_tui.mind.rules import called, defined, head_name, prelude_rules
from logical_robots_tui.mind.text import diagnostic_at

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.mind.diagnostics import Diagnostic
    from logical_robots_tui.mind.rules import Rule
    from logical_robots_tui.mind.text import Prepared

__all__ = ["MAIN", "check"]

MAIN = "Robot"
_CHOSEN_BY_THE_GAME = ("@Engine", "@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {"@Ground", "@Limit", "@Make", "@NoInject", "@NoWith", "@OrderBy", "@Recursive", "@With"}
)
_OUTSIDE = frozenset(
    [
        "Clingo",
        "Intelligence",
        "PrintToConsole",
        "ReadFile",
        "ReadJson",
        "RunClingo",
        "RunClingoFile",
        "RunClingoFileTemplate",
        "RunClingoTemplate",
        "WriteFile",
    ]
)
"""What the package gives to programs that are trusted with the machine they run on."""


def check(rules: list[Rule], text: str, source: Prepared) -> None:
    """Refuse what would compile silently and fail later.

    Raises:
        ProgramError: Something is refused.
    """
    problems = [
        *_forbidden(rules, text, source),
        *_undefined(rules, text, source),
        *_main_predicate(rules, text, source),
    ]
    if problems:
        raise ProgramError(tuple(sorted(problems, key=lambda p: (p.line, p.column))))


def _forbidden(rules: list[Rule], text: str, source: Prepared) -> Iterator[Diagnostic]:
    for name in dict.fromkeys(head_name(r) for r in rules):
        if name in _CHOSEN_BY_THE_GAME:
            yield complaints.at_word(
                name, text, source, f"{name} is chosen by the game", "Remove this line."
            )
        elif name.startswith("@") and name not in _ANNOTATIONS:
            yield complaints.at_word(
                name,
                text,
                source,
                f"there is no annotation {name} for robots",
                f"There are {', '.join(sorted(_ANNOTATIONS - {'@Make'}))} and @Visible.",
            )
        elif name in INPUTS:
            yield complaints.at_definition(
                name,
                text,
                source,
                f"{name} is supplied by the game and can't be defined",
                "Give your predicate another name.",
            )
    for name in dict.fromkeys(called(rules)):
        if name == "SqlExpr" or re.match(r"`\W*\w", name):
            yield complaints.at_word(
                name, text, source, "robots can't write SQL", "Say it in Logica."
            )
        elif name in _OUTSIDE:
            yield complaints.at_word(
                name, text, source, f"{name} is not there for robots", "Robots can only think."
            )


def _undefined(rules: list[Rule], text: str, source: Prepared) -> Iterator[Diagnostic]:
    known = {
        *(head_name(r) for r in rules),
        *defined(rules),
        *defined(list(prelude_rules())),
        *INPUTS,
        *_OUTSIDE,
        *expr_translate.QL.BasisFunctions(),
        *dialects.SqLiteDialect().BuiltInFunctions(),
    }
    for name in dict.fromkeys(called(rules)):
        if name not in known and re.fullmatch(r"[A-Za-z][\w.]*", name) and name != "nil":
            yield complaints.undefined(name, known - _OUTSIDE, text, source)


def _main_predicate(rules: list[Rule], text: str, source: Prepared) -> Iterator[Diagnostic]:
    heads = [r["head"] for r in rules if head_name(r) == MAIN]
    if not heads:
        if MAIN not in set(defined(rules)):
            yield diagnostic_at(
                text,
                0,
                0,
                "there is no Robot predicate",
                "Add a rule such as Robot(robot_name:, desire: {left_engine: 0.5, "
                'right_engine: 0.5}, memory: "") :- Sensor(robot_name:);',
            )
        return
    for field in ("robot_name", "desire"):
        if not all(field in _fields(head) for head in heads):
            yield complaints.at_definition(
                MAIN,
                text,
                source,
                f"Robot has no {field}",
                "Its columns are robot_name:, desire: and memory:.",
            )


def _fields(head: Mapping[str, Any]) -> list[Any]:
    return [fv["field"] for fv in head["record"]["field_value"]]
