"""Mistakes that compile silently and fail later, and things that are not allowed."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, TypeGuard

from logica.compiler import universe

from logical_robots_tui.language import builtins
from logical_robots_tui.language.definitions import (
    called,
    calls,
    definitions,
    lacking,
    parameters,
    prelude,
)
from logical_robots_tui.language.inference import Inference
from logical_robots_tui.language.robot_rule import MAIN, engines, main_predicate
from logical_robots_tui.language.signatures import (
    collisions,
    given_twice,
    signatures,
    wrong_calls,
)
from logical_robots_tui.language.similar_names import closest, distance
from logical_robots_tui.language.source_text import diagnostic_for
from logical_robots_tui.language.spelling import TYPES
from logical_robots_tui.language.tree import (
    Annotation,
    Argument,
    Functor,
    Number,
    PredicateName,
    Rule,
    Text,
    Variable,
    walk,
)
from logical_robots_tui.language.verbatim import verbatim
from logical_robots_tui.schema import INPUTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from logical_robots_tui.language.adapter import Parsed
    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.language.signatures import Runs
    from logical_robots_tui.language.tree import Expression, Node, Statement

_CHOSEN_BY_THE_GAME = ("@Engine", "@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {
        "@DefineFlag",
        "@Ground",
        "@Limit",
        "@NoInject",
        "@NoWith",
        "@OrderBy",
        "@Recursive",
        "@With",
    }
)
IGNORED = frozenset({"@CompileAsTvf"})
"""Annotations that have no effect here and don't change results elsewhere."""

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
"""What the package offers to programs that are trusted with the machine."""


def check(parsed: Parsed, text: str, runs: Runs) -> list[Diagnostic]:
    """Return errors and warnings that would compile silently, in text order.

    Args:
        parsed: The program.
        text: Its text.
        runs: Whether a built-in function works in SQLite.
    """
    program = parsed.statements
    known = {n: s for n, s in signatures(program).items() if n not in parsed.doubtful}
    inference = Inference(program, text, parsed.doubtful)
    problems = [
        *parsed.problems,
        *_annotations(program, text),
        *_supplied(program, text),
        *_names(program, text, parsed.doubtful, runs),
        *collisions(program, text),
        *wrong_calls(program, known, text, runs),
        *given_twice(program, text),
        *_without_arguments(program, text),
        *verbatim(program, known, text),
        *inference.problems,
        *engines(program, inference, text),
        *typos(program, text),
    ]
    if MAIN not in parsed.doubtful and (not parsed.problems or MAIN in definitions(program)):
        problems += main_predicate(program, text)
    unique = {(p.line, p.column, p.message): p for p in problems}
    return sorted(unique.values(), key=lambda p: (p.line, p.column, p.severity))


_FLAG = "FlagValue"  # the value set by @DefineFlag


def _annotations(program: Sequence[Statement], text: str) -> Iterator[Diagnostic]:
    ours = _ANNOTATIONS | {"@Visible"}
    for each in program:
        if not isinstance(each, Annotation):
            continue
        name = each.name
        if name in _CHOSEN_BY_THE_GAME:
            yield diagnostic_for(text, name, f"{name} is chosen by the game", "Remove this line.")
        elif name not in ours | IGNORED:
            close = closest(name[1:], {o[1:] for o in ours})
            if name in universe.Annotations.ANNOTATING_PREDICATES:
                message, hint = f"{name} is for other engines", "Remove this line."
            elif close:
                message, hint = f"there is no annotation {name}", f"Did you mean @{close}?"
            else:
                message = f"there is no annotation {name} for robots"
                hint = f"There are {', '.join(sorted(ours))}."
            yield diagnostic_for(text, name, message, hint)
        elif name in _ARGUMENTS and not _fits(each, _ARGUMENTS[name][0]):
            _, message, hint = _ARGUMENTS[name]
            yield diagnostic_for(text, name, message, hint)


_ARGUMENTS: dict[str, tuple[type[Expression], str, str]] = {
    "@Limit": (Number, "@Limit needs a predicate and a number", "Such as @Limit(P, 3);"),
    "@OrderBy": (
        Text,
        "@OrderBy needs a predicate and its columns in quotes",
        'Such as @OrderBy(P, "col0 DESC");',
    ),
    "@Recursive": (
        Number,
        "@Recursive needs a predicate and a number of steps",
        "Such as @Recursive(P, 50);",
    ),
}


def _fits(annotation: Annotation, kind: type[Expression]) -> bool:
    """Return whether an annotation has a predicate followed by literals of a kind."""
    rest = [each.value for each in annotation.arguments[1:] if isinstance(each.field, int)]
    is_enough = bool(rest) or annotation.name == "@Recursive"
    has_subject = bool(annotation.subject)
    return has_subject and is_enough and all(isinstance(value, kind) for value in rest)


def _supplied(program: Sequence[Statement], text: str) -> Iterator[Diagnostic]:
    for name in definitions(program):
        if name in INPUTS:
            message = f"{name} is supplied by the game and can't be defined"
            yield diagnostic_for(text, name, message, "Give your predicate another name.")


def _names(
    program: Sequence[Statement], text: str, doubtful: frozenset[str], runs: Runs
) -> Iterator[Diagnostic]:
    """Find names that are not defined, or that robots may not use."""
    own = {*(each.name for each in program if isinstance(each, Rule)), *definitions(program)}
    known = {*own, *doubtful, *_types(program), *definitions(prelude()), *INPUTS}
    left_open = parameters(program) - {lacking(program).get(MAIN)}
    seen = set()
    subjects = {each.subject for each in program if isinstance(each, Annotation)}
    values = {node.name for node in walk(program) if isinstance(node, PredicateName)}
    values -= {*(each.name for each in calls(program)), *subjects}
    for name in called(program):
        if name in seen or name in known or name in left_open:
            continue
        seen.add(name)
        if name == "SqlExpr" or re.match(r"`\W*\w", name):
            yield diagnostic_for(text, name, "robots can't use SQL", "Write it in Logica.")
        elif re.fullmatch(r"-\s*\w+", name):
            other = name[1:].strip()
            message = f"a minus can't stand right before {other}"
            yield diagnostic_for(text, name, message, f"Add a space: - {other}(...).")
        elif name in _OUTSIDE:
            message = f"{name} is not available to robots"
            yield diagnostic_for(text, name, message, "Robots can only think.")
        elif builtins.is_built_in(name):
            if name.isidentifier() and not runs(name) and name != _FLAG:
                hint = _instead(name, known, runs)
                yield diagnostic_for(text, name, f"{name} is not available here", hint)
        elif re.fullmatch(r"[A-Za-z][\w.]*", name) and name != "nil":
            hint = _instead(name, known, runs) or "Define it, or correct its name."
            if name in values:
                hint = "Names of variables are lower case."
            yield diagnostic_for(text, name, f"{name} is not defined", hint)


def _without_arguments(program: Sequence[Statement], text: str) -> Iterator[Diagnostic]:
    """Find functions and predicates that are named where a value belongs."""
    known = {*definitions(program), *INPUTS} - {*_types(program)}
    for node in walk(each for each in program if isinstance(each, Rule)):
        if not isinstance(node, PredicateName):
            continue
        name = node.name
        if name in known or (builtins.is_built_in(name) and name.upper() not in TYPES):
            message = f"{name} is named without its arguments, so it has no value"
            yield diagnostic_for(text, name, message, f"Write {name}(...).", "warning")


def _types(program: Sequence[Statement]) -> Iterator[str]:
    """Return names that stand for types: in `TryCast` and after `~`."""
    for call in calls(program):
        if call.name in ("TryCast", "~"):
            for name in called(call.arguments[1:]):
                if call.name == "~" or name.upper() in TYPES:
                    yield name


_INSTEAD = {
    "ApproxCountDistinct": "Count",
    "ArrayAgg": "List",
    "ArrayConcat": "Concat",
    "ArrayLength": "Size",
    "ArrayToString": "Join",
    "CharLength": "Length",
    "FarmFingerprint": "Fingerprint",
    "LogicalAnd": "Min",
    "LogicalOr": "Max",
    "RegexpContains": "Like",
    "SafeDivide": "/",
    "SomeValue": "AnyValue",
    "String": "ToString",
    "ToJsonString": "RecordAsJson",
}


def _instead(name: str, known: set[str], runs: Runs) -> str:
    """Return a hint about what a name may have meant, or ""."""
    if name in _INSTEAD:
        return f"Use {_INSTEAD[name]}."
    working = {n for n in builtins.names() if n.isidentifier() and n[:1].isupper()}
    close = closest(name, known | {n for n in working if len(n) > 1})
    if not close and len(name) > 2:  # in short names one typo is a large part
        close = next((n for n in sorted(working) if distance(name, n) == 1), "")
    if close and (close in known or runs(close)):
        return f"Did you mean {close}?"
    return "`logical-robots help` lists all functions." if builtins.is_built_in(name) else ""


_SHORTEST = 4  # letters in a word that can be recognised as misspelt
_LONG = 7  # letters in a word that may have two errors


def typos(program: Sequence[Statement], text: str) -> Iterator[Diagnostic]:
    """Warn about variables that are probably misspelt."""
    for rule in program:
        if isinstance(rule, Annotation | Functor):
            continue
        variables = [node.name for node in walk(rule) if isinstance(node, Variable)]
        shorthand = {node.field for node in walk(rule) if _is_shorthand(node)}
        counts = Counter(map(str, variables))
        for at, name in enumerate(variables):
            if counts[name] > 1 or name in shorthand:
                continue
            earlier = dict.fromkeys(map(str, variables[:at]))
            others = (o for o in counts if o in earlier or counts[o] > 1)
            meant = next((o for o in others if o != name and _looks_like(name, o)), "")
            if meant:
                message = f"{name} is used only once; is it a misspelt {meant}?"
                hint = f"Write {meant} if you mean the same."
                yield diagnostic_for(text, name, message, hint, "warning")


def _is_shorthand(node: Node) -> TypeGuard[Argument]:
    """Return whether this is `name:`, which names a column and its variable at once."""
    if not isinstance(node, Argument) or not isinstance(node.value, Variable):
        return False
    return node.value.name == node.field


def _looks_like(name: str, other: str) -> bool:
    """Return whether two names differ only by a typo in one long word."""
    left, right = name.split("_"), other.split("_")
    if len(left) != len(right):
        return False
    different = [(a, b) for a, b in zip(left, right, strict=True) if a != b]
    if len(different) != 1:
        return False
    one, two = different[0]
    if min(len(one), len(two)) < _SHORTEST or one.rstrip("s") == two.rstrip("s"):
        return False
    if any(c.isdigit() for c in one + two):
        return False
    allowed = 2 if min(len(one), len(two)) >= _LONG else 1
    return distance(one, two) <= allowed and one[0] == two[0]
