"""Variables without a value: what lacks them, as far as the tree tells."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from logical_robots_tui.language import error_messages
from logical_robots_tui.language.definitions import definitions, rules_of
from logical_robots_tui.language.diagnostics import Diagnostic
from logical_robots_tui.language.source_text import Prepared, diagnostic_at
from logical_robots_tui.language.tree import (
    Atom,
    Call,
    Disjunction,
    Rule,
    Statement,
    Tree,
    Variable,
    operands,
    variable_of,
    variables,
    walk,
)


def explain(error: BaseException, source: Prepared, program: Sequence[Statement]) -> Diagnostic:
    """Return the diagnostic for an exception raised for a program that could be parsed."""
    found = error_messages.explain(error, source)
    names = error_messages.unbound_variables(error)
    start, _ = error_messages.rule_of(error, source)
    rules = (each for each in program if isinstance(each, Rule))
    rule = next((r for r in rules if r.span and r.span.start <= start < r.span.stop), None)
    if not names or rule is None:
        return found
    name = found.excerpt if found.excerpt in names else names[0]
    own = definitions(program)
    called = [n for n in walk(rule) if isinstance(n, Atom | Call) and n.name in own]
    if name not in variables(rule, inside=True):
        for each in called:
            heads = [other.head for other in rules_of(own[each.name])]
            if name in variables(heads, inside=True) and each.span:
                message = f"{each.name} needs a value for {name}"
                hint, length = "Add the missing argument.", len(each.name)
                return diagnostic_at(source.original, each.span.start, length, message, hint)
    elif isinstance(rule.body, Disjunction):
        hint = "A '|' divides the whole body: put the alternatives in brackets, (a | b)."
        place = next(n for n in _uses(name, rule) if n.span)
        at, message = (
            place.span or (0, 0),
            f"nothing says what {name} is in one of the alternatives",
        )
        return diagnostic_at(source.original, at[0], len(name), message, hint)
    takers = [e.name for e in called for v in operands(e.arguments) if variable_of(v) == name]
    is_given_only = len(takers) == sum(1 for _ in _uses(name, rule.body or ()))
    if len({*takers}) == 1 and is_given_only and not found.hint.startswith("Did you mean"):
        taker = takers[0]
        hint = f"{taker} leaves it open: it needs a value here, or in the rule of {taker}."
        return replace(found, hint=hint)
    return found


def _uses(name: str, tree: Tree) -> Iterator[Variable]:
    return (n for n in walk(tree) if isinstance(n, Variable) and n.name == name)
