"""Annotations, such as ``@Recursive(P, 50)``: which there are, and whether they are used well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from logica.compiler import universe

from logical_robots_tui.language import tree
from logical_robots_tui.language.diagnostics import Diagnostic, closest
from logical_robots_tui.language.source_text import diagnostic_for

MOST_STEPS = 1_000
"""The most steps of a recursion."""

_CHOSEN_BY_THE_GAME = ("@AttachDatabase", "@Dataset")
_ANNOTATIONS = frozenset(
    {"@DefineFlag", "@Ground", "@Limit", "@NoInject", "@NoWith", "@OrderBy", "@Recursive", "@With"}
)
IGNORED = frozenset({"@CompileAsTvf", "@Engine"})
"""Annotations that have no effect here and don't change results elsewhere."""


def check_annotations(program: Sequence[tree.Statement], text: str) -> Iterator[Diagnostic]:
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
                message, hint = f"there is no annotation {name}", f"Did you mean @{close}?"
            else:
                message = f"there is no annotation {name} for robots"
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
                    message = f"a recursion takes at most {MOST_STEPS:,} steps here"
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
                yield diagnostic_for(text, annotation.name, message, f"Such as {_OPTIONS}")
                continue
        if not is_right:
            message = f"@Recursive can't use this value of {argument.field}"
            hint = f"It is one of {', '.join(MODES)}." if argument.field == "mode" else ""
            yield diagnostic_for(text, annotation.name, message, hint or f"Such as {_OPTIONS}")


_ARGUMENTS: dict[str, tuple[type[tree.Expression], str, str]] = {
    "@Limit": (tree.Number, "@Limit needs a predicate and a number", "Such as @Limit(P, 3);"),
    "@OrderBy": (
        tree.Text,
        "@OrderBy needs a predicate and its columns in quotes",
        'Such as @OrderBy(P, "col0 DESC");',
    ),
    "@Recursive": (
        tree.Number,
        "@Recursive needs a predicate and a number of steps",
        "Such as @Recursive(P, 50);",
    ),
}


def _fits(annotation: tree.Annotation, kind: type[tree.Expression]) -> bool:
    rest = [each.value for each in annotation.arguments[1:] if isinstance(each.field, int)]
    is_enough = bool(rest) or annotation.name == "@Recursive"
    has_subject = bool(annotation.subject)
    return has_subject and is_enough and all(isinstance(value, kind) for value in rest)
