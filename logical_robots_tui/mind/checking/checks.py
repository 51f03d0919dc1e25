"""Mistakes that compile silently and fail later, and things that are not allowed."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from logica.compiler import universe

from logical_robots_tui.mind.checking import builtins
from logical_robots_tui.mind.checking.inference import Inference
from logical_robots_tui.mind.checking.robot_rule import MAIN, engines, main_predicate
from logical_robots_tui.mind.checking.signatures import (
    collisions,
    given_twice,
    signatures,
    wrong_calls,
)
from logical_robots_tui.mind.checking.verbatim import verbatim
from logical_robots_tui.mind.compiling.rules import (
    called,
    calls,
    defined,
    fields,
    head_name,
    heads,
    lacking,
    nodes,
    parameters,
    prelude_rules,
    subject,
    value_of,
)
from logical_robots_tui.mind.compiling.spelling import TYPES
from logical_robots_tui.mind.program import INPUTS
from logical_robots_tui.mind.similar_names import closest, distance
from logical_robots_tui.mind.source_text import diagnostic_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from logical_robots_tui.mind.compiling.parsing import Parsed
    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic

_CHOSEN_BY_THE_GAME = ("@Engine", "@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {
        "@DefineFlag",
        "@Ground",
        "@Limit",
        "@Make",
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


def check(parsed: Parsed, text: str) -> list[Diagnostic]:
    """Return errors and warnings that would compile silently, in text order."""
    rules = parsed.rules
    known = {n: s for n, s in signatures(rules).items() if n not in parsed.doubtful}
    inference = Inference(rules, text, parsed.doubtful)
    problems = [
        *parsed.problems,
        *_annotations(rules, text),
        *_supplied(rules, text),
        *_names(rules, text, parsed.doubtful),
        *collisions(rules, text),
        *wrong_calls(rules, known, text),
        *given_twice(rules, text),
        *_without_arguments(rules, text),
        *verbatim(rules, known, text),
        *inference.problems,
        *engines(rules, inference, text),
        *typos(rules, text),
    ]
    if MAIN not in parsed.doubtful and (not parsed.problems or MAIN in heads(rules)):
        problems += main_predicate(rules, text)
    unique = {(p.line, p.column, p.message): p for p in problems}
    return sorted(unique.values(), key=lambda p: (p.line, p.column, p.severity))


_FLAG = "FlagValue"  # the value set by @DefineFlag


def _annotations(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    ours = _ANNOTATIONS - {"@Make"} | {"@Visible"}
    for rule in rules:
        name = head_name(rule)
        if name in _CHOSEN_BY_THE_GAME:
            yield diagnostic_for(text, name, f"{name} is chosen by the game", "Remove this line.")
        elif name.startswith("@") and name not in {*_ANNOTATIONS, *IGNORED, "@Visible"}:
            close = closest(name[1:], {o[1:] for o in ours})
            if name in universe.Annotations.ANNOTATING_PREDICATES:
                message, hint = f"{name} is for other engines", "Remove this line."
            elif close:
                message, hint = f"there is no annotation {name}", f"Did you mean @{close}?"
            else:
                message = f"there is no annotation {name} for robots"
                hint = f"There are {', '.join(sorted(ours))}."
            yield diagnostic_for(text, name, message, hint)
        elif name in _ARGUMENTS and not _fits(rule, _ARGUMENTS[name][0]):
            _, message, hint = _ARGUMENTS[name]
            yield diagnostic_for(text, name, message, hint)


_ARGUMENTS = {
    "@Limit": ("the_number", "@Limit needs a predicate and a number", "Such as @Limit(P, 3);"),
    "@OrderBy": (
        "the_string",
        "@OrderBy needs a predicate and its columns in quotes",
        'Such as @OrderBy(P, "col0 DESC");',
    ),
    "@Recursive": (
        "the_number",
        "@Recursive needs a predicate and a number of steps",
        "Such as @Recursive(P, 50);",
    ),
}


def _fits(rule: Rule, kind: str) -> bool:
    """Return whether an annotation has a predicate followed by literals of a kind."""
    values = [value_of(fv) or {} for fv in rule["head"]["record"]["field_value"]]
    named = [isinstance(field, str) for field in fields(rule["head"]["record"])]
    if not values or "the_predicate" not in values[0].get("literal", {}):
        return False
    rest = [v for v, has_name in zip(values, named, strict=True) if not has_name][1:]
    enough = bool(rest) or head_name(rule) == "@Recursive"
    return enough and all(kind in value.get("literal", {}) for value in rest)


def _supplied(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    for name in defined(rules):
        if name in INPUTS:
            message = f"{name} is supplied by the game and can't be defined"
            yield diagnostic_for(text, name, message, "Give your predicate another name.")


def _names(rules: list[Rule], text: str, doubtful: frozenset[str]) -> Iterator[Diagnostic]:
    """Find names that are not defined, or that robots may not use."""
    own = {*(head_name(r) for r in rules), *defined(rules), *doubtful, *_types(rules)}
    known = {*own, *defined(list(prelude_rules())), *INPUTS}
    left_open = parameters(rules) - {lacking(rules).get(MAIN)}
    seen = set()
    values = {str(n["the_predicate"]["predicate_name"]) for n in nodes(rules) if _is_value(n)}
    values -= {str(call["predicate_name"]) for call, _ in calls(rules)} | {
        subject(rule) for rule in rules
    }
    for name in called(rules):
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
            if name.isidentifier() and not builtins.runs(name) and name != _FLAG:
                hint = _instead(name, known)
                yield diagnostic_for(text, name, f"{name} is not available here", hint)
        elif re.fullmatch(r"[A-Za-z][\w.]*", name) and name != "nil":
            hint = _instead(name, known) or "Define it, or correct its name."
            if name in values:
                hint = "Names of variables are lower case."
            yield diagnostic_for(text, name, f"{name} is not defined", hint)


def _without_arguments(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    """Find functions and predicates that are named where a value belongs."""
    known = {*defined(rules), *INPUTS} - {*_types(rules)}
    own = [rule for rule in rules if not head_name(rule).startswith("@")]
    for node in filter(_is_value, nodes(own)):
        name = node["the_predicate"]["predicate_name"]
        if name in known or (builtins.is_built_in(name) and name.upper() not in TYPES):
            message = f"{name} is named without its arguments, so it has no value"
            yield diagnostic_for(text, name, message, f"Write {name}(...).", "warning")


def _is_value(node: Rule) -> bool:
    return isinstance(node.get("the_predicate"), dict)


def _types(rules: list[Rule]) -> Iterator[str]:
    """Return names that stand for types: in `TryCast` and after `~`."""
    for call, _ in calls(rules):
        if call["predicate_name"] in ("TryCast", "~"):
            for name in called(call["record"]["field_value"][1:]):
                if call["predicate_name"] == "~" or name.upper() in TYPES:
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


def _instead(name: str, known: set[str]) -> str:
    """Return a hint about what a name may have meant, or ""."""
    if name in _INSTEAD:
        return f"Use {_INSTEAD[name]}."
    working = {n for n in builtins.names() if n.isidentifier() and n[:1].isupper()}
    close = closest(name, known | {n for n in working if len(n) > 1})
    if not close and len(name) > 2:  # in short names one typo is a large part
        close = next((n for n in sorted(working) if distance(name, n) == 1), "")
    if close and (close in known or builtins.runs(close)):
        return f"Did you mean {close}?"
    return "`logical-robots help` lists all functions." if builtins.is_built_in(name) else ""


_SHORTEST = 4  # letters in a word that can be recognised as misspelt
_LONG = 7  # letters in a word that may have two errors


def typos(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    """Warn about variables that are probably misspelt."""
    for rule in rules:
        if head_name(rule).startswith("@"):
            continue
        variables = [n["variable"]["var_name"] for n in nodes(rule) if "variable" in n]
        shorthand = {n["field"] for n in nodes(rule) if _is_shorthand(n)}
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


def _is_shorthand(node: Rule) -> bool:
    """Return whether this is `name:`, which names a column and its variable at once."""
    if "field" not in node:
        return False
    variable = node["value"].get("expression", {}).get("variable")
    return bool(variable) and variable["var_name"] == node["field"]


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
