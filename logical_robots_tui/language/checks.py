"""Mistakes that compile silently and fail later, annotations, and things that are not allowed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from logica.compiler import universe

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import (
    Model,
    built_in_names,
    is_built_in,
    names_used,
    prelude,
    rules_of,
)
from logical_robots_tui.language.diagnostics import (
    MOST_DIAGNOSTICS,
    Diagnostic,
    Mention,
    Proposal,
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
from logical_robots_tui.language.types import RecordOf
from logical_robots_tui.schema import DESIRE, INPUTS, MAIN, VALUE

_OUTSIDE = frozenset(
    {
        *("Clingo", "Intelligence", "PrintToConsole", "ReadFile", "ReadJson", "RunClingo"),
        *("RunClingoFile", "RunClingoFileTemplate", "RunClingoTemplate", "WriteFile"),
    }
)
"""Functions of the package for programs that are trusted with the machine."""


class CheckResult(NamedTuple):
    """The problems and the mentions of a program.

    Attributes:
        problems: Errors and warnings that would compile silently, in text order.
        mentions: The names that it compares with labels and robots' names.
    """

    problems: list[Diagnostic]
    mentions: tuple[Mention, ...]


def check(model: Model, syntax_errors: Sequence[Diagnostic], runs: Runs) -> CheckResult:
    """Check a program.

    Args:
        model: The statements that could be parsed.
        syntax_errors: What is wrong with the others.
        runs: Whether a built-in function works in SQLite.
    """
    catalog = {n: s for n, s in signatures(model).items() if n not in model.doubtful}
    inference = Inference(model)
    mentions = inference.mentions
    problems = [
        *syntax_errors,
        *_annotations(model),
        *_redefinitions(model),
        *_names(model, runs),
        *collisions(model),
        *wrong_calls(model, catalog, runs),
        *wrong_copies(model),
        *duplicates(model),
        *_without_arguments(model),
        *_values_as_conditions(model),
        *verbatim(model, catalog),
        *inference.problems,
        *engines(model, inference),
        *pitfalls(model),
        *typos(model),
    ]
    if MAIN not in model.doubtful and (not syntax_errors or MAIN in model.definitions):
        problems += main_predicate(model)
    unique = {(p.line, p.column, p.message): p for p in problems}
    ordered = sorted(unique.values(), key=lambda p: (p.line, p.column, p.severity))
    return CheckResult(ordered, mentions)


# -- annotations ---------------------------------------------------------------------------------

MOST_STEPS = 1_000
"""The most steps of a recursion."""

_CHOSEN_BY_THE_GAME = ("@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {"@DefineFlag", "@Ground", "@Limit", "@NoInject", "@NoWith", "@OrderBy", "@Recursive", "@With"}
)
IGNORED = frozenset({"@CompileAsTvf", "@Engine"})
"""Annotations that have no effect here and don't change results elsewhere."""


def _annotations(model: Model) -> Iterator[Diagnostic]:
    supported = _ANNOTATIONS | {"@Visible"}
    for annotation in model.annotations:
        span = annotation.span
        name = annotation.name if span is None else tree.Name(annotation.name, span.start)
        if name in _CHOSEN_BY_THE_GAME:
            yield model.diagnostic(name, f"{name} is chosen by the game", "Remove this line.")
        elif name == "@Engine":
            message = "@Engine has no effect: the game chooses the engine"
            problem = model.diagnostic(name, message, "Remove this line.", "warning")
            yield replace(problem, has_effect=False)
        elif name not in supported | IGNORED:
            close = closest(name[1:], {o[1:] for o in supported})
            if name in universe.Annotations.ANNOTATING_PREDICATES:
                message, hint = f"{name} is for other engines", "Remove this line."
            elif close:
                message, hint = f"There is no annotation {name}", Proposal(f"@{close}")
            else:
                message = f"There is no annotation {name} for robots"
                hint = f"There are {', '.join(sorted(supported))}."
            yield model.diagnostic(name, message, hint)
        elif name in _ARGUMENTS:
            kind, message, hint = _ARGUMENTS[name]
            values = [a.value for a in annotation.arguments[1:] if isinstance(a.field, int)]
            is_enough = bool(annotation.subject) and (bool(values) or name == "@Recursive")
            if not is_enough or not all(isinstance(value, kind) for value in values):
                yield model.diagnostic(name, message, hint)
            elif name == "@Recursive":
                yield from _recursion(annotation, model)


MODES = ("diamond", "horizontal", "iterative", "vertical")
"""Ways to iterate a recursion, which give the same rows if it comes to an end."""

_OPTIONS = '@Recursive(P, 50, stop: Found, satellites: [Q], mode: "iterative");'


def _recursion(annotation: tree.Annotation, model: Model) -> Iterator[Diagnostic]:
    """Report options that are unknown or have a value of another kind, and too many steps."""
    for argument in annotation.arguments[1:]:
        value = argument.value
        match argument.field:
            case int():
                steps = float(value.value) if isinstance(value, tree.Number) else 0
                if steps > MOST_STEPS:
                    message = f"A recursion takes at most {MOST_STEPS:,} steps here"
                    hint = "Each step runs in every thought; let it come to an end sooner."
                    yield model.diagnostic(annotation.name, message, hint, "warning")
                continue
            case "stop":
                is_right = isinstance(value, tree.PredicateName)
            case "satellites":
                is_right = isinstance(value, tree.List) and all(
                    isinstance(element, tree.PredicateName) for element in value.elements
                )
            case "mode":
                is_right = isinstance(value, tree.Text) and value.value in MODES
            case "iterative":
                is_right = isinstance(value, tree.Boolean)
            case _:
                message = f"@Recursive has no option {argument.field}"
                yield model.diagnostic(annotation.name, message, f"For example: {_OPTIONS}")
                continue
        if not is_right:
            message = f"@Recursive can't use this value of {argument.field}"
            hint = f"It is one of {', '.join(MODES)}." if argument.field == "mode" else ""
            yield model.diagnostic(annotation.name, message, hint or f"For example: {_OPTIONS}")


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


# -- names ---------------------------------------------------------------------------------------

_FLAG = "FlagValue"  # the value set by @DefineFlag


def _redefinitions(model: Model) -> Iterator[Diagnostic]:
    for name in model.definitions:
        if name in INPUTS:
            message = f"{name} is supplied by the game and can't be defined"
            yield model.diagnostic(name, message, "Give your predicate another name.")


def _names(model: Model, runs: Runs) -> Iterator[Diagnostic]:
    predicates = {*(rule.name for rule in model.rules), *model.definitions}
    names = {*predicates, *model.doubtful, *_types(model), *prelude().definitions, *INPUTS}
    open_parameters = model.substituted - names - {model.missing_parameters.get(MAIN)}
    reported = set()
    subjects = {annotation.subject for annotation in model.annotations}
    nodes = tree.walk(model.statements)
    values = {node.name for node in nodes if isinstance(node, tree.PredicateName)}
    values -= {*(call.name for call in model.calls), *subjects}
    aggregate_calls = {
        call.name
        for call in model.calls
        if any(isinstance(argument.value, tree.Aggregate) for argument in call.arguments)
    }
    for name in names_used(model.statements):
        if name in reported or name in names or name in open_parameters:
            continue
        reported.add(name)
        if name == "SqlExpr" or re.match(r"`\W*\w", name):
            yield model.diagnostic(name, "Robots can't use SQL", "Write it in Logica.")
        elif re.fullmatch(r"-\s*\w+", name):
            operand = name[1:].strip()
            message = f"A minus can't stand right before {operand}"
            yield model.diagnostic(name, message, f"Add a space: - {operand}(...).")
        elif name in _OUTSIDE:
            message = f"{name} is not available to robots"
            hint = "A program can only use what robots sense and remember."
            yield model.diagnostic(name, message, hint)
        elif is_built_in(name):
            if name.isidentifier() and not runs(name) and name != _FLAG:
                hint = _replacement_hint(name, names, runs)
                yield model.diagnostic(name, f"{name} is not available here", hint)
        elif re.fullmatch(r"[A-Za-z][\w.]*", name) and name != "nil":
            similar = (
                _replacement_hint(name, names, runs) if len(reported) <= MOST_DIAGNOSTICS else ""
            )
            hint = similar or "Define it, or correct its name."
            if name in values:
                hint = _value_hint(name)
            elif name in aggregate_calls:
                hint = f"To define it, give it a body: {name}(...) :- ..."
            yield model.diagnostic(name, f"{name} is not defined", hint)


def _value_hint(name: str) -> str:
    literal = {"none": "null"}.get(name.lower(), name.lower())
    if literal in ("true", "false", "null"):
        return Proposal(literal, "Write {}.")
    return f'Names of variables are lower case, and strings are in quotes: "{name[:40]}".'


NO_VALUE = "is named without its arguments, so it has no value"
"""The end of the message about a predicate in the place of a value."""


def _without_arguments(model: Model) -> Iterator[Diagnostic]:
    names = {*model.definitions, *prelude().definitions, *INPUTS} - {*_types(model)}
    for node in tree.walk(model.rules):
        name = node.name if isinstance(node, tree.PredicateName) else ""
        if name in names or (is_built_in(name) and name.upper() not in TYPES):
            message = f"{name} {NO_VALUE}"
            yield model.diagnostic(name, message, f"Write {name}(...).", "warning")


def _values_as_conditions(model: Model) -> Iterator[Diagnostic]:
    values = built_in_names() - tree.CONDITIONS - _PREDICATES - model.definitions.keys()
    for node in tree.walk(model.rules):
        if not isinstance(node, tree.Atom) or node.name not in values:
            continue
        span = node.span or tree.span_of(node.arguments)
        if span is not None:
            message = f"{node.name} gives a value; it is not a condition"
            hint = "Compare the value with something, or name it: x = ..."
            yield model.diagnostic(span, message, hint)


_PREDICATES = frozenset({"Constraint", "Like"})
"""Built-in functions that are conditions as well."""


def _types(model: Model) -> Iterator[str]:
    for call in model.calls:
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


def _replacement_hint(name: str, names: set[str], runs: Runs) -> str:
    if name in _INSTEAD:
        return f"Use {_INSTEAD[name]}."
    available = {n for n in built_in_names() if n.isidentifier() and n[:1].isupper()}
    close = closest(name, names | {n for n in available if len(n) > 1})
    if not close and len(name) > 2:  # in short names one typo is a large part
        close = next((n for n in sorted(available) if distance(name, n) == 1), "")
    if close and (close in names or runs(close)):
        return Proposal(close)
    return "`logical-robots help` lists all functions." if is_built_in(name) else ""


# -- the rule for Robot -------------------------------------------------------------------------

_ENGINES = DESIRE.names
_COLUMNS = ("robot_name", "desire", "memory")
_EXAMPLE = (
    'Add Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") '
    ":- Sensor(robot_name:);"
)


def main_predicate(model: Model) -> Iterator[Diagnostic]:
    robot_rules = model.definitions.get(MAIN, [])
    if not robot_rules:
        message = "There is no Robot predicate" if model.statements else "The program is empty"
        close = next((n for n in model.definitions if closest(n, [MAIN])), "")
        if close:
            hint = Proposal(MAIN, f"Write {{}} instead of {close}.")
            yield model.diagnostic(close, message, hint)
        else:
            yield model.diagnostic(tree.Span(0, 0), message, _EXAMPLE)
    for rule in rules_of(robot_rules):
        columns = [column.field for column in rule.head.columns]
        if tree.REST in columns:
            continue
        other_columns = [c for c in columns if isinstance(c, str) and c not in _COLUMNS]
        for column in _COLUMNS:
            if column not in columns:
                yield _missing_column(rule.name, column, other_columns, model)


def engines(model: Model, inference: Inference) -> Iterator[Diagnostic]:
    problems: dict[tuple[int, int], Diagnostic] = {}
    for node in tree.walk(model.statements):
        arguments = node.arguments if isinstance(node, tree.Record) else ()
        names = [argument.field for argument in arguments if isinstance(argument.field, str)]
        if set(names) & set(_ENGINES) and tree.REST not in names:
            problems |= _misspelt(names, model)
    for shape in inference.column(MAIN, "desire"):
        names = [*shape.names] if isinstance(shape, RecordOf) else []
        if misspelt := _misspelt(names, model, 0.5):
            problems |= misspelt
        elif names:
            for engine in sorted(set(_ENGINES) - set(names)):
                message = f"This desire has no {engine}; that engine will stand still"
                hint = f"Add {engine}: with a number from -1 to 1."
                problem = model.diagnostic(names[0], message, hint, "warning")
                problems.setdefault((problem.line, problem.column), problem)
    yield from problems.values()


def _misspelt(
    names: Iterable[str], model: Model, cutoff: float = 0.76
) -> dict[tuple[int, int], Diagnostic]:
    """Return warnings about names that are nearly those of engines, by line and column."""
    problems = {}
    missing = set(_ENGINES) - set(names)
    for name in names:
        similar = closest(name, missing, cutoff)
        if similar and name not in _ENGINES:
            message = f"There is no engine called {name}; this would be ignored"
            problem = model.diagnostic(name, message, Proposal(similar))
            problems[problem.line, problem.column] = problem
    return problems


def _missing_column(robot: str, column: str, columns: list[str], model: Model) -> Diagnostic:
    close = next((name for name in columns if closest(name, [column], 0.5)), "")
    if close:
        advice = Proposal(column, f"Write {{}} instead of {close}.")
        return model.diagnostic(close, f"Robot has no {column}", advice)
    if column == "memory":
        message = "Robot sets no memory, so memory never changes"
        hint = 'Add memory: with a value to remember, or memory: "".'
        return model.diagnostic(robot, message, hint, "warning")
    hint = "Its columns are robot_name:, desire: and memory:."
    return model.diagnostic(robot, f"Robot has no {column}", hint)


# -- text that the compiler inserts into SQL unchanged ------------------------------------------

_TIMES = frozenset({"DATE", "DATETIME", "INTERVAL", "TIME", "TIMESTAMP", "TIMESTAMPTZ"})
_TYPES_HINT = 'Write Num, Int, Str, Bool, [Num], {count: Num}, or one in quotes: "INTEGER".'
_PLAIN = re.compile(r"[^'\"`$\\\n]*")  # can't end an SQL text
_ORDER_COLUMNS = re.compile(r"\s*(\w+)(?:\s+(?:ASC|DESC))?\s*", re.ASCII | re.IGNORECASE)


def verbatim(model: Model, catalog: Mapping[str, Signature]) -> Iterator[Diagnostic]:
    for call in model.calls:
        if call.name in ("Cast", "TryCast"):
            for argument in call.arguments[1:2]:
                if argument.expression and (problem := _wrong_type(argument.expression, call.name)):
                    yield model.diagnostic(call.name, *problem)
    is_in_text = any(
        "${" in n.value for n in tree.walk(model.statements) if isinstance(n, tree.Text)
    )
    for statement in model.statements:
        names = [node.name for node in tree.walk(statement) if isinstance(node, tree.PredicateName)]
        if isinstance(statement, tree.Functor) and "Cast" in (statement.base, *names):
            yield model.diagnostic("Cast", "Cast can't be given to a functor", "Call it.")
        if not isinstance(statement, tree.Annotation):
            continue
        if statement.name == "@DefineFlag" and is_in_text:
            for value in statement.values[:1]:
                if _PLAIN.fullmatch(tree.text_of(value) or "") is None:
                    message = "A flag that ${...} puts into a string can't hold quotes, \\ or $"
                    hint = 'Write FlagValue("name") instead of ${name}.'
                    yield model.diagnostic(statement.name, message, hint)
        if statement.name == "@OrderBy":
            for value in statement.values:
                ordered = tree.text_of(value)  # other types are reported elsewhere
                signature = catalog.get(statement.subject)
                if ordered is not None and (message := _wrong_column(ordered, signature)):
                    hint = 'Write only names of columns, such as @OrderBy(P, "col0 DESC");'
                    yield model.diagnostic(statement.name, message, hint)


def _wrong_type(example: tree.Expression, cast: str) -> tuple[str, str] | None:
    """Return a message and a hint for a wrong type in a cast; None if it is right."""
    try:
        written_type(example)
    except KeyError as error:
        if error.args[0] in _TIMES:
            return "Robots have no dates and times", "Use sensor.clock, which is a number."
        if cast == "Cast":
            name = tree.text_of(example)
            subject = "This" if name is None else name[:40]
            return f"{subject} is not a type that Cast knows", _TYPES_HINT
    return None


def _wrong_column(columns: str, signature: Signature | None) -> str:
    if columns in ("ASC", "DESC"):
        return ""
    for part in columns.split(","):
        match = _ORDER_COLUMNS.fullmatch(part)
        if match is None:
            return "@OrderBy takes names of columns"
        if signature is not None:
            numbered = {f"col{number}" for number in range(signature.count)}
            if match[1] not in {*numbered, *signature.named, *[VALUE] * signature.has_value}:
                return f"There is no column {match[1]} to order by"
    return ""
