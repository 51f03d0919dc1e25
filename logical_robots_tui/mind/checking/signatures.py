"""Columns of predicates, and whether all rules and calls agree about them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.checking import builtins
from logical_robots_tui.mind.checking.robot_rule import MAIN
from logical_robots_tui.mind.compiling.rules import (
    calls,
    fields,
    head_name,
    heads,
    nodes,
    prelude_rules,
    reached,
    subject,
    value_of,
    variable_of,
)
from logical_robots_tui.mind.program import INPUTS, VALUE
from logical_robots_tui.mind.similar_names import closest
from logical_robots_tui.mind.source_text import diagnostic_for

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule
    from logical_robots_tui.mind.diagnostics import Diagnostic


@dataclass(frozen=True, slots=True)
class Signature:
    """The columns of a predicate.

    Attributes:
        count: The number of positional columns.
        named: Names of the named columns.
        has_value: Whether it is a function.
        required: The positional columns that its value depends on.
    """

    count: int
    named: frozenset[str]
    has_value: bool
    required: frozenset[int] = frozenset()

    def __str__(self) -> str:
        positional = [f"argument {i + 1}" for i in range(self.count)]
        shown = ", ".join([*positional, *(f"{name}:" for name in sorted(self.named))])
        return f"({shown})" + (" = value" if self.has_value else "")


def signatures(rules: list[Rule]) -> dict[str, Signature]:
    """Return the signatures of predicates whose rules agree."""
    found = {name: Signature(0, frozenset(columns), False) for name, columns in INPUTS.items()}
    for name, own in {**heads(list(prelude_rules())), **heads(rules)}.items():
        candidates = {_signature(rule) for rule in own}
        signature = candidates.pop()
        if signature is not None and not candidates:
            found[name] = signature
    return found


def collisions(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    """Find rules that disagree with the first rule of the same predicate."""
    for name, own in heads(rules).items():
        first, *others = own
        if name.isidentifier() and (problem := _hides_built_in(name, first, rules)):
            yield diagnostic_for(text, name, problem, "Give your predicate another name.")
        for rule in others:
            if told := _difference(first, rule):
                here = subject(rule) if head_name(rule) == "@Make" else head_name(rule)
                line = text.count("\n", 0, getattr(name, "start", 0)) + 1
                message, hint = told
                yield diagnostic_for(text, here, message.format(name, line), hint)
                break


def wrong_calls(
    rules: list[Rule], known: Mapping[str, Signature], text: str
) -> Iterator[Diagnostic]:
    """Find calls with arguments that the predicate does not have."""
    own = heads(rules)
    used = _used(own)
    for rule in rules:
        if head_name(rule).startswith("@"):
            continue
        for call, for_value in calls(rule):
            name = call["predicate_name"]
            if name in known and not (for_value and builtins.is_built_in(name)):
                yield from _wrong_call(call, known[name], for_value, text)
                if for_value and known[name].has_value and head_name(rule) in used:
                    yield from _left_out(call, known[name], text)
            elif for_value and name not in own and _is_named_built_in(name):
                yield from _wrong_built_in(call, text)


def _used(own: Mapping[str, list[Rule]]) -> set[str]:
    """Return the predicates that `Robot` uses, or all if there is no `Robot`."""
    return {MAIN, *reached(own[MAIN], own)} if MAIN in own else {*own}


def given_twice(rules: list[Rule], text: str) -> Iterator[Diagnostic]:
    """Find fields and arguments with two values."""
    for node in nodes(rules):
        seen = set()
        for fv in node.get("field_value", ()):
            name = fv["field"]
            if isinstance(name, str) and name in seen and name != "*":
                hint = "Remove one, or join the conditions with ','."
                yield diagnostic_for(text, name, f"{name} is given twice here", hint)
            seen.add(name)


def _is_named_built_in(name: str) -> bool:
    """Return whether this is a built-in function called by its name, not an operator."""
    return name[:1].isupper() and builtins.is_built_in(name) and builtins.runs(name)


def _signature(rule: Rule) -> Signature | None:
    if head_name(rule).startswith("@"):
        return None
    columns = fields(rule["head"]["record"])
    if "*" in columns:
        return None
    positional = sum(isinstance(c, int) for c in columns)
    named = frozenset(str(c) for c in columns if isinstance(c, str))
    required = frozenset[int]() if "body" in rule else _in_value(rule)
    return Signature(positional, named - {VALUE}, VALUE in named, required)


def _in_value(rule: Rule) -> frozenset[int]:
    """Return the places of arguments in the value of a function without conditions."""
    record = rule["head"]["record"]["field_value"]
    values = [fv for fv in record if fv["field"] == VALUE]
    mentioned = {node["variable"]["var_name"] for node in nodes(values) if "variable" in node}
    return frozenset(
        fv["field"]
        for fv in record
        if isinstance(fv["field"], int) and variable_of(value_of(fv) or {}) in mentioned
    )


def _difference(first: Rule, other: Rule) -> tuple[str, str] | None:
    """Describe how two rules of one name contradict each other, with a hint."""
    if "@Make" in (head_name(first), head_name(other)):
        return "{0} is already defined in line {1}", "Give one of them another name."
    one, two = _signature(first), _signature(other)
    if one is None or two is None:
        return None
    if one.has_value != two.has_value:
        what = "a function" if one.has_value else "without a value"
        return "{0} is " + what + " in line {1}, but not here", "Give one of them another name."
    if (one.count, one.named) != (two.count, two.named):
        columns = str(one).replace("{", "{{")
        hint = f"All rules of a predicate have the same columns; there it has {columns}."
        if len(hint) > 120:
            hint = "All rules of a predicate have the same columns."
        return "{0} has different columns in line {1}", hint
    if ("distinct_denoted" in first) != ("distinct_denoted" in other):
        where = "in line {1}, but not here" if "distinct_denoted" in first else "here only"
        return "{0} is distinct " + where, "Write distinct in all of its heads, or in none."
    return None


def _hides_built_in(name: str, rule: Rule, rules: list[Rule]) -> str:
    if not builtins.is_built_in(name):
        return ""
    used = any(for_value and call["predicate_name"] == name for call, for_value in calls(rules))
    if VALUE in fields(rule["head"]["record"]) or used:
        return f"{name} is built in; this definition would be ignored"
    return ""


def _wrong_call(
    call: Rule, signature: Signature, for_value: bool, text: str
) -> Iterator[Diagnostic]:
    name = call["predicate_name"]
    given = fields(call["record"])
    positional = sum(isinstance(field, int) for field in given)
    allowed = {*signature.named, "*", VALUE, *(f"col{i}" for i in range(signature.count))}
    if positional > signature.count:
        hint = "Compare with the rule that defines it." if signature.count else _shape(signature)
        yield diagnostic_for(text, name, _too_many(name, positional, signature), hint)
    for field in given:
        if isinstance(field, str) and field not in allowed:
            close = closest(field, signature.named, 0.6)
            hint = f"Did you mean {close}?" if close else _shape(signature)
            yield diagnostic_for(text, field, f"{name} has no column {field}", hint)
    if for_value and not signature.has_value:
        hint = f"Use {name}(...) as a condition, or give it a value: {name}(...) = ...;"
        message = f"{name} is not a function; it has no value"
        yield diagnostic_for(text, name, message, hint if len(hint) <= 120 else "")


def _left_out(call: Rule, signature: Signature, text: str) -> Iterator[Diagnostic]:
    """Report a function that is called without arguments that its value needs.

    Without other arguments it returns all its values.
    """
    name = call["predicate_name"]
    given: list[Any] = fields(call["record"])
    missing = {place for place in signature.required if not {place, f"col{place}"} & {*given}}
    if missing and "*" not in given:
        here = sum(isinstance(field, int) for field in given)
        message = f"{name} takes {_arguments(signature.count)}, here {_are(here)}"
        yield diagnostic_for(text, name, message, "Add the missing arguments.")


def _too_many(name: str, given: int, signature: Signature) -> str:
    if not signature.count and signature.named:
        return f"the columns of {name} have names"
    return f"{name} takes {_arguments(signature.count)}, here {_are(given)}"


def _shape(signature: Signature) -> str:
    named = sorted(signature.named)
    if named and not signature.count:
        hint = f"Name the columns that you need: ({', '.join(f'{n}:' for n in named)})."
    elif named:
        hint = f"Its named columns are {', '.join(named)}."
    else:
        hint = "Its columns are positional; they have no names." if signature.count else ""
    return hint if len(hint) <= 120 else ""


def _wrong_built_in(call: Rule, text: str) -> Iterator[Diagnostic]:
    name = call["predicate_name"]
    given: list[Any] = fields(call["record"])
    least, most = builtins.arity(name)
    named = [field for field in given if isinstance(field, str)]
    if named:
        hint = f"Write {name}(...) with plain values in order."
        yield diagnostic_for(text, named[0], f"the arguments of {name} have no names", hint)
    elif not least <= len(given) <= most:
        takes = _arguments(least)
        if most == math.inf:
            takes = f"at least {takes}"
        elif most > least:
            takes = f"{least} to {most:.0f} arguments"
        message = f"{name} takes {takes}, here {_are(len(given))}"
        yield diagnostic_for(text, name, message, "See `logical-robots help " + name + "`.")


def _arguments(count: float) -> str:
    return "no arguments" if not count else f"{count:.0f} argument{'s' if count != 1 else ''}"


def _are(count: int) -> str:
    return "is 1" if count == 1 else f"are {count or 'none'}"
