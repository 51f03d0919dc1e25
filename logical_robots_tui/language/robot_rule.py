"""The rule for `Robot`: it must have a name, a desire with two engines, and a memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from logical_robots_tui.language import tree
from logical_robots_tui.language.definitions import definitions, rules_of
from logical_robots_tui.language.shapes import Record
from logical_robots_tui.language.similar_names import closest
from logical_robots_tui.language.source_text import diagnostic_at, diagnostic_for
from logical_robots_tui.language.tree import REST
from logical_robots_tui.schema import DESIRE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from logical_robots_tui.language.diagnostics import Diagnostic
    from logical_robots_tui.language.inference import Inference
    from logical_robots_tui.language.tree import Statement

MAIN = "Robot"
_ENGINES = DESIRE.names
_COLUMNS = ("robot_name", "desire", "memory")
_EXAMPLE = (
    'Add Robot(robot_name:, desire: {left_engine: 1, right_engine: 1}, memory: "") '
    ":- Sensor(robot_name:);"
)


def main_predicate(program: Sequence[Statement], text: str) -> Iterator[Diagnostic]:
    """Find what is missing in the heads of `Robot`, or report that there is none."""
    found = definitions(program).get(MAIN, [])
    if not found:
        message = "there is no Robot predicate"
        close = next((n for n in definitions(program) if n.lower() == MAIN.lower()), "")
        if close:
            yield diagnostic_for(text, close, message, f"Write {MAIN} instead of {close}.")
        else:
            yield diagnostic_at(text, 0, 0, message, _EXAMPLE)
    for rule in rules_of(found):
        columns = [each.field for each in rule.head.columns]
        if REST in columns:
            continue
        others = [c for c in columns if isinstance(c, str) and c not in _COLUMNS]
        for column in _COLUMNS:
            if column not in columns:
                yield _missing(rule.name, column, others, text)


def engines(program: Sequence[Statement], inference: Inference, text: str) -> Iterator[Diagnostic]:
    """Find misspelt or missing engines in a desire."""
    literals = [
        [each.field for each in node.arguments if isinstance(each.field, str)]
        for node in tree.walk(program)
        if isinstance(node, tree.Record)
    ]
    desires = [
        shape.names for shape in inference.column(MAIN, "desire") if isinstance(shape, Record)
    ]
    problems: dict[tuple[int, int], Diagnostic] = {}
    for names in literals:
        if set(names) & set(_ENGINES) and REST not in names:
            problems |= _by_place(_misspelt(names, text))
    for desire in desires:
        names = list(desire)
        if found := _by_place(_misspelt(names, text, 0.5)):
            problems |= found
        elif names:
            for engine in sorted(set(_ENGINES) - set(names)):
                message = f"this desire has no {engine}; that engine will stand still"
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
            message = f"there is no engine {name}; this would be ignored"
            yield diagnostic_for(text, name, message, f"Did you mean {meant}?")


def _missing(robot: str, column: str, others: list[str], text: str) -> Diagnostic:
    close = next((other for other in others if closest(other, [column], 0.5)), "")
    if close:
        message = f"Robot has no {column}"
        return diagnostic_for(text, close, message, f"Write {column} instead of {close}.")
    if column == "memory":
        message = "Robot has no memory; it will never change"
        hint = 'Add memory: with a value to remember, or memory: "".'
        return diagnostic_for(text, robot, message, hint, "warning")
    hint = "Its columns are robot_name:, desire: and memory:."
    return diagnostic_for(text, robot, f"Robot has no {column}", hint)
