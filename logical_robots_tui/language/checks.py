"""Mistakes that compile silently and fail later, annotations, and things that are not allowed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from logica.compiler import universe

from logical_robots_tui.language import tree
from logical_robots_tui.language.adapter import Parsed
from logical_robots_tui.language.definitions import (
    built_in_names,
    calls,
    definitions,
    is_built_in,
    lacking,
    names_used,
    parameters,
    prelude,
    rules_of,
)
from logical_robots_tui.language.diagnostics import (
    MOST_DIAGNOSTICS,
    Diagnostic,
    Mention,
    closest,
    distance,
)
from logical_robots_tui.language.expansion import TYPES, written_type
from logical_robots_tui.language.inference import Inference
from logical_robots_tui.language.pitfalls import pitfalls, typos
from logical_robots_tui.language.signatures import (
    Runs,
    Signature,
    collisions,
    duplicates,
    signatures,
    wrong_calls,
    wrong_copies,
)
from logical_robots_tui.language.source_text import diagnostic_at, diagnostic_for
from logical_robots_tui.language.types import RecordOf
from logical_robots_tui.schema import DESIRE, INPUTS, MAIN, VALUE

_OUTSIDE = frozenset(
    {
        *("Clingo", "Intelligence", "PrintToConsole", "ReadFile", "ReadJson", "RunClingo"),
        *("RunClingoFile", "RunClingoFileTemplate", "RunClingoTemplate", "WriteFile"),
    }
)
"""What the package offers to programs that are trusted with the machine."""


class Checked(NamedTuple):
    """What was found in a program.

    Attributes:
        problems: Errors and warnings that would compile silently, in text order.
        mentions: The names that it compares with labels and robots' names.
    """

    problems: list[Diagnostic]
    mentions: tuple[Mention, ...]


def check(parsed: Parsed, text: str, runs: Runs) -> Checked:
    """Check a program.

    Args:
        parsed: The program.
        text: Its text.
        runs: Whether a built-in function works in SQLite.
    """
    program = parsed.statements
    known = {n: s for n, s in signatures(program).items() if n not in parsed.doubtful}
    inference = Inference(program, text, parsed.doubtful)
    mentions = inference.mentions
    problems = [
        *parsed.problems,
        *_annotations(program, text),
        *_redefinitions(program, text),
        *_names(program, text, parsed.doubtful, runs),
        *collisions(program, text),
        *wrong_calls(program, known, text, runs),
        *wrong_copies(program, text),
        *duplicates(program, text),
        *_without_arguments(program, text),
        *_values_as_conditions(program, text),
        *verbatim(program, known, text),
        *inference.problems,
        *engines(program, inference, text),
        *pitfalls(program, parsed.source),
        *typos(program, text),
    ]
    if MAIN not in parsed.doubtful and (not parsed.problems or MAIN in definitions(program)):
        problems += main_predicate(program, text)
    unique = {(p.line, p.column, p.message): p for p in problems}
    in_order = sorted(unique.values(), key=lambda p: (p.line, p.column, p.severity))
    return Checked(in_order, mentions)


# -- annotations ---------------------------------------------------------------------------------

MOST_STEPS = 1_000
"""The most steps of a recursion."""

_CHOSEN_BY_THE_GAME = ("@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {"@DefineFlag", "@Ground", "@Limit", "@NoInject", "@NoWith", "@OrderBy", "@Recursive", "@With"}
)
IGNORED = frozenset({"@CompileAsTvf", "@Engine"})
"""Annotations that have no effect here and don't change results elsewhere."""


def _annotations(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    ours = _ANNOTATIONS | {"@Visible"}
    for each in program:
        if not isinstance(each, tree.Annotation):
            continue
        name = each.name if each.span is None else tree.Name(each.name, each.span.start)
        if name in _CHOSEN_BY_THE_GAME:
            yield diagnostic_for(text, name, f"{name} is chosen by the game", "Remove this line.")
        elif name == "@Engine":
            message = "@Engine has no effect: the game chooses the engine"
            yield diagnostic_for(text, name, message, "Remove this line.", "warning")
        elif name not in ours | IGNORED:
            close = closest(name[1:], {o[1:] for o in ours})
            if name in universe.Annotations.ANNOTATING_PREDICATES:
                message, hint = f"{name} is for other engines", "Remove this line."
            elif close:
                message, hint = f"There is no annotation {name}", f"Did you mean @{close}?"
            else:
                message = f"There is no annotation {name} for robots"
                hint = f"There are {', '.join(sorted(ours))}."
            yield diagnostic_for(text, name, message, hint)
        elif name in _ARGUMENTS and not _fits(each, _ARGUMENTS[name][0]):
            _, message, hint = _ARGUMENTS[name]
            yield diagnostic_for(text, name, message, hint)
        elif name == "@Recursive":
            yield from _recursion(each, text)


MODES = ("diamond", "horizontal", "iterative", "vertical")
"""Ways to iterate a recursion, which give the same rows if it comes to an end."""

_OPTIONS = '@Recursive(P, 50, stop: Found, satellites: [Q], mode: "iterative");'


def _recursion(annotation: tree.Annotation, text: str) -> Iterator[Diagnostic]:
    """Report options that are unknown or have a value of another kind, and too many steps."""
    for argument in annotation.arguments[1:]:
        value = argument.value
        match argument.field:
            case int():
                steps = float(value.value) if isinstance(value, tree.Number) else 0
                if steps > MOST_STEPS:
                    message = f"A recursion takes at most {MOST_STEPS:,} steps here"
                    hint = "Each step runs in every thought; let it come to an end sooner."
                    yield diagnostic_for(text, annotation.name, message, hint, "warning")
                continue
            case "stop":
                is_right = isinstance(value, tree.PredicateName)
            case "satellites":
                is_right = isinstance(value, tree.List) and all(
                    isinstance(each, tree.PredicateName) for each in value.elements
                )
            case "mode":
                is_right = isinstance(value, tree.Text) and value.value in MODES
            case "iterative":
                is_right = isinstance(value, tree.Boolean)
            case _:
                message = f"@Recursive has no option {argument.field}"
                yield diagnostic_for(text, annotation.name, message, f"For example: {_OPTIONS}")
                continue
        if not is_right:
            message = f"@Recursive can't use this value of {argument.field}"
            hint = f"It is one of {', '.join(MODES)}." if argument.field == "mode" else ""
            yield diagnostic_for(text, annotation.name, message, hint or f"For example: {_OPTIONS}")


_ARGUMENTS: dict[str, tuple[type[tree.Expression], str, str]] = {
    "@Limit": (tree.Number, "@Limit needs a predicate and a number", "For example: @Limit(P, 3);"),
    "@OrderBy": (
        tree.Text,
        "@OrderBy needs a predicate and its columns in quotes",
        'For example: @OrderBy(P, "col0 DESC");',
    ),
    "@Recursive": (
        tree.Number,
        "@Recursive needs a predicate and a number of steps",
        "For example: @Recursive(P, 50);",
    ),
}


def _fits(annotation: tree.Annotation, kind: type[tree.Expression]) -> bool:
    rest = [each.value for each in annotation.arguments[1:] if isinstance(each.field, int)]
    is_enough = bool(annotation.subject) and (bool(rest) or annotation.name == "@Recursive")
    return is_enough and all(isinstance(value, kind) for value in rest)


# -- names ---------------------------------------------------------------------------------------

_FLAG = "FlagValue"  # the value set by @DefineFlag


def _redefinitions(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    for name in definitions(program):
        if name in INPUTS:
            message = f"{name} is supplied by the game and can't be defined"
            yield diagnostic_for(text, name, message, "Give your predicate another name.")


def _names(
    program: Sequence[tree.Statement], text: str, doubtful: frozenset[str], runs: Runs
) -> Iterator[Diagnostic]:
    own = {*(each.name for each in program if isinstance(each, tree.Rule)), *definitions(program)}
    known = {*own, *doubtful, *_types(program), *definitions(prelude()), *INPUTS}
    left_open = parameters(program) - {lacking(program).get(MAIN)}
    seen = set()
    subjects = {each.subject for each in program if isinstance(each, tree.Annotation)}
    values = {node.name for node in tree.walk(program) if isinstance(node, tree.PredicateName)}
    called = [*calls(program)]
    values -= {*(call.name for call in called), *subjects}
    given_aggregates = {
        call.name
        for call in called
        if any(isinstance(argument.value, tree.Aggregate) for argument in call.arguments)
    }
    for name in names_used(program):
        if name in seen or name in known or name in left_open:
            continue
        seen.add(name)
        if name == "SqlExpr" or re.match(r"`\W*\w", name):
            yield diagnostic_for(text, name, "Robots can't use SQL", "Write it in Logica.")
        elif re.fullmatch(r"-\s*\w+", name):
            other = name[1:].strip()
            message = f"A minus can't stand right before {other}"
            yield diagnostic_for(text, name, message, f"Add a space: - {other}(...).")
        elif name in _OUTSIDE:
            message = f"{name} is not available to robots"
            hint = "A program can only use what robots sense and remember."
            yield diagnostic_for(text, name, message, hint)
        elif is_built_in(name):
            if name.isidentifier() and not runs(name) and name != _FLAG:
                hint = _instead(name, known, runs)
                yield diagnostic_for(text, name, f"{name} is not available here", hint)
        elif re.fullmatch(r"[A-Za-z][\w.]*", name) and name != "nil":
            similar = _instead(name, known, runs) if len(seen) <= MOST_DIAGNOSTICS else ""
            hint = similar or "Define it, or correct its name."
            if name in values:
                hint = _meant_as_value(name)
            elif name in given_aggregates:
                hint = f"To define it, give it a body: {name}(...) :- ..."
            yield diagnostic_for(text, name, f"{name} is not defined", hint)


def _meant_as_value(name: str) -> str:
    literal = {"none": "null"}.get(name.lower(), name.lower())
    if literal in ("true", "false", "null"):
        return f"Write {literal}."
    return f'Names of variables are lower case, and strings are in quotes: "{name[:40]}".'


NO_VALUE = "is named without its arguments, so it has no value"
"""What is wrong with a predicate that stands where a value is wanted."""


def _without_arguments(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    known = {*definitions(program), *definitions(prelude()), *INPUTS} - {*_types(program)}
    for node in tree.walk(rules_of(program)):
        name = node.name if isinstance(node, tree.PredicateName) else ""
        if name in known or (is_built_in(name) and name.upper() not in TYPES):
            message = f"{name} {NO_VALUE}"
            yield diagnostic_for(text, name, message, f"Write {name}(...).", "warning")


def _values_as_conditions(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    values = built_in_names() - tree.CONDITIONS - _PREDICATES - definitions(program).keys()
    for node in tree.walk(rules_of(program)):
        if not isinstance(node, tree.Atom) or node.name not in values:
            continue
        span = node.span or tree.span_of(node.arguments)
        if span is not None:
            message = f"{node.name} gives a value; it is not a condition"
            hint = "Compare the value with something, or name it: x = ..."
            length = span.stop - span.start
            yield diagnostic_at(text, span.start, length, message, hint)


_PREDICATES = frozenset({"Constraint", "Like"})
"""Built-in functions that are conditions as well."""


def _types(program: Sequence[tree.Statement]) -> Iterator[str]:
    for call in calls(program):
        if call.name in ("Cast", "TryCast", "~"):
            for name in names_used(call.arguments[1:]):
                if call.name == "~" or name.upper() in TYPES:
                    yield name


_INSTEAD = {
    "ApproxCountDistinct": "Count",
    "ArrayAgg": "List",
    "FarmFingerprint": "Fingerprint",
    "LogicalAnd": "Min",
    "LogicalOr": "Max",
    "RegexpContains": "RegexpExtract",
    "SafeDivide": "/",
    "String": "ToString",
    "ToJsonString": "RecordAsJson",
}


def _instead(name: str, known: set[str], runs: Runs) -> str:
    if name in _INSTEAD:
        return f"Use {_INSTEAD[name]}."
    working = {n for n in built_in_names() if n.isidentifier() and n[:1].isupper()}
    close = closest(name, known | {n for n in working if len(n) > 1})
    if not close and len(name) > 2:  # in short names one typo is a large part
        close = next((n for n in sorted(working) if distance(name, n) == 1), "")
    if close and (close in known or runs(close)):
        return f"Did you mean {close}?"
    return "`logical-robots help` lists all functions." if is_built_in(name) else ""


# -- the rule for Robot -------------------------------------------------------------------------

_ENGINES = DESIRE.names
_COLUMNS = ("robot_name", "desire", "memory")
_EXAMPLE = (
    'Add Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") '
    ":- Sensor(robot_name:);"
)


def main_predicate(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
    found = definitions(program).get(MAIN, [])
    if not found:
        message = "There is no Robot predicate" if program else "The program is empty"
        close = next((n for n in definitions(program) if closest(n, [MAIN])), "")
        if close:
            yield diagnostic_for(text, close, message, f"Write {MAIN} instead of {close}.")
        else:
            yield diagnostic_at(text, 0, 0, message, _EXAMPLE)
    for rule in rules_of(found):
        columns = [each.field for each in rule.head.columns]
        if tree.REST in columns:
            continue
        others = [c for c in columns if isinstance(c, str) and c not in _COLUMNS]
        for column in _COLUMNS:
            if column not in columns:
                yield _missing(rule.name, column, others, text)


def engines(
    program: Sequence[tree.Statement], inference: Inference, text: str
) -> Iterator[Diagnostic]:
    problems: dict[tuple[int, int], Diagnostic] = {}
    for node in tree.walk(program):
        given = node.arguments if isinstance(node, tree.Record) else ()
        names = [each.field for each in given if isinstance(each.field, str)]
        if set(names) & set(_ENGINES) and tree.REST not in names:
            problems |= _by_place(_misspelt(names, text))
    for shape in inference.column(MAIN, "desire"):
        names = [*shape.names] if isinstance(shape, RecordOf) else []
        if found := _by_place(_misspelt(names, text, 0.5)):
            problems |= found
        elif names:
            for engine in sorted(set(_ENGINES) - set(names)):
                message = f"This desire has no {engine}; that engine will stand still"
                hint = f"Add {engine}: with a number from -1 to 1."
                problem = diagnostic_for(text, names[0], message, hint, "warning")
                problems.setdefault((problem.line, problem.column), problem)
    yield from problems.values()


def _by_place(problems: Iterable[Diagnostic]) -> dict[tuple[int, int], Diagnostic]:
    return {(p.line, p.column): p for p in problems}


def _misspelt(names: Iterable[str], text: str, cutoff: float = 0.76) -> Iterator[Diagnostic]:
    missing = set(_ENGINES) - set(names)
    for name in names:
        meant = closest(name, missing, cutoff)
        if meant and name not in _ENGINES:
            message = f"There is no engine called {name}; this would be ignored"
            yield diagnostic_for(text, name, message, f"Did you mean {meant}?")


def _missing(robot: str, column: str, others: list[str], text: str) -> Diagnostic:
    close = next((other for other in others if closest(other, [column], 0.5)), "")
    if close:
        message = f"Robot has no {column}"
        return diagnostic_for(text, close, message, f"Write {column} instead of {close}.")
    if column == "memory":
        message = "Robot sets no memory, so memory never changes"
        hint = 'Add memory: with a value to remember, or memory: "".'
        return diagnostic_for(text, robot, message, hint, "warning")
    hint = "Its columns are robot_name:, desire: and memory:."
    return diagnostic_for(text, robot, f"Robot has no {column}", hint)


# -- text that the compiler inserts into SQL unchanged ------------------------------------------

_TIMES = frozenset({"DATE", "DATETIME", "INTERVAL", "TIME", "TIMESTAMP", "TIMESTAMPTZ"})
_TYPES_HINT = 'Write Num, Int, Str, Bool, [Num], {count: Num}, or one in quotes: "INTEGER".'
_PLAIN = re.compile(r"[^'\"`$\\\n]*")  # can't end an SQL text
_ORDER_COLUMNS = re.compile(r"\s*(\w+)(?:\s+(?:ASC|DESC))?\s*", re.ASCII | re.IGNORECASE)


def verbatim(
    program: Sequence[tree.Statement], known: Mapping[str, Signature], text: str
) -> Iterator[Diagnostic]:
    for call in calls(program):
        if call.name in ("Cast", "TryCast"):
            for argument in call.arguments[1:2]:
                if argument.expression and (found := _wrong_type(argument.expression, call.name)):
                    yield diagnostic_for(text, call.name, *found)
    is_within_a_text = any("${" in n.value for n in tree.walk(program) if isinstance(n, tree.Text))
    for each in program:
        given = [node.name for node in tree.walk(each) if isinstance(node, tree.PredicateName)]
        if isinstance(each, tree.Functor) and "Cast" in (each.base, *given):
            yield diagnostic_for(text, "Cast", "Cast can't be given to a functor", "Call it.")
        if not isinstance(each, tree.Annotation):
            continue
        if each.name == "@DefineFlag" and is_within_a_text:
            for value in each.values[:1]:
                if _PLAIN.fullmatch(tree.text_of(value) or "") is None:
                    message = "A flag that ${...} puts into a string can't hold quotes, \\ or $"
                    hint = 'Write FlagValue("name") instead of ${name}.'
                    yield diagnostic_for(text, each.name, message, hint)
        if each.name == "@OrderBy":
            for value in each.values:
                ordered = tree.text_of(value)  # other types are reported elsewhere
                signature = known.get(each.subject)
                if ordered is not None and (wrong := _wrong_column(ordered, signature)):
                    hint = 'Write only names of columns, such as @OrderBy(P, "col0 DESC");'
                    yield diagnostic_for(text, each.name, wrong, hint)


def _wrong_type(wanted: tree.Expression, cast: str) -> tuple[str, str] | None:
    """Return a message and a hint about what should be a type, or in `TryCast` an example."""
    try:
        written_type(wanted)
    except KeyError as error:
        if error.args[0] in _TIMES:
            return "Robots have no dates and times", "Use sensor.clock, which is a number."
        if cast == "Cast":
            name = tree.text_of(wanted)
            shown = "This" if name is None else name[:40]
            return f"{shown} is not a type that Cast knows", _TYPES_HINT
    return None


def _wrong_column(columns: str, signature: Signature | None) -> str:
    if columns in ("ASC", "DESC"):
        return ""
    for part in columns.split(","):
        found = _ORDER_COLUMNS.fullmatch(part)
        if found is None:
            return "@OrderBy takes names of columns"
        if signature is not None:
            numbered = {f"col{number}" for number in range(signature.count)}
            if found[1] not in {*numbered, *signature.named, *[VALUE] * signature.has_value}:
                return f"There is no column {found[1]} to order by"
    return ""
