"""Rules as the `logica` package parses them: definitions, calls, and parameters.

A parameter is a predicate that ``New := Old(Open: Given)`` substitutes.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, TypeAlias

from logica.parser_py import parse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

_PRELUDE = """
->(left:, right:) = {arg: left, value: right};
`=`(left:, right:) = right :- left == right;
Arrow(left, right) = arrow :- left == arrow.arg, right == arrow.value;

WeightedAverage(pair) = Sum(pair.arg * pair.value) / Sum(pair.arg);

ArgMin(pair) = SqlExpr("arg_min({a}, {v})", {a: pair.arg, v: pair.value});
ArgMax(pair) = SqlExpr("arg_max({a}, {v})", {a: pair.arg, v: pair.value});
ArgMinK(pair, k) = SqlExpr("arg_min_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
ArgMaxK(pair, k) = SqlExpr("arg_max_k({a}, {v}, {k})", {a: pair.arg, v: pair.value, k:});
Array(pair) = SqlExpr("array_by({a}, {v})", {a: pair.arg, v: pair.value});

NaturalHash(x) = SqlExpr("natural_hash({x})", {x:});
Fingerprint(x) = SqlExpr("natural_hash({x})", {x:});
TryCast(value, example) = SqlExpr("try_cast_like({v}, {e})", {v: value, e: example});
TruthToString(truth) = SqlExpr("truth_to_text({t})", {t: truth});
RecordAsJson(record) = SqlExpr("record_as_json({r})", {r: record});
AssembleRecord(pairs) = SqlExpr("assemble_record({p})", {p: pairs});
DisassembleRecord(record) = SqlExpr("disassemble_record({r})", {r: record});
Chr(code) = SqlExpr("char({c})", {c: code});
Ord(text) = SqlExpr("unicode_of({t})", {t: text});
Num(x) = x;
Str(x) = x;
"""
"""Common predicates that every program may use.

A program can define its own instead, so none of them may use another.
Aggregates take ``argument -> value`` pairs, which the compiler sees as ``{arg:, value:}``.
"""

Rule: TypeAlias = dict[str, Any]
"""A node of a syntax tree."""

COMPARISONS = frozenset({"!=", "<", "<=", "==", ">", ">=", "in", "is", "is not"})
"""Operators that return a boolean from any operands."""

JUNCTIONS = frozenset({"&&", "||"})
"""Operators that return a boolean from booleans, except ``!``."""

CONDITIONS = COMPARISONS | JUNCTIONS | {"!", "IsNull"}
"""Expressions with a boolean value that can be used as a condition."""

TRUTHS = CONDITIONS | {"EndsWith", "Like", "StartsWith"}
"""All operators and functions with a boolean value."""


def head_name(rule: Rule) -> str:
    """Return the predicate or annotation that a rule defines."""
    name: str = rule["head"]["predicate_name"]
    return name


@functools.cache
def prelude_rules() -> tuple[Rule, ...]:
    """Return the rules of the prelude. Don't change them."""
    return tuple(parse.ParseFile(_PRELUDE)["rule"])


def defined(rules: list[Rule]) -> Iterator[str]:
    """Return the program's own predicates in text order, once each."""
    return iter(heads(rules))


def heads(rules: list[Rule]) -> dict[str, list[Rule]]:
    """Return the rules of each of the program's predicates, in text order."""
    found: dict[str, list[Rule]] = {}
    for rule in rules:
        name = head_name(rule)
        if name == "@Make":
            name = subject(rule)
        if not name.startswith("@") and not name.endswith(parse.MultiBodyAggregation.SUFFIX):
            found.setdefault(name, []).append(rule)
    return found


def subject(rule: Rule) -> str:
    """Return the predicate that an annotation is about, or ""."""
    fields = rule["head"]["record"]["field_value"]
    return predicate_of(value_of(fields[0]) or {}) if fields else ""


def fields(record: Rule) -> list[Any]:
    """Return the names of a record's fields or a call's arguments; positional ones are numbers."""
    return [fv["field"] for fv in record["field_value"]]


def value_of(field_value: Rule) -> Rule | None:
    """Return the expression of a field, or None if it is aggregated."""
    expression: Rule | None = field_value["value"].get("expression")
    return expression


def operands(call: Rule) -> list[Rule]:
    """Return the arguments of a call."""
    values = map(value_of, call["record"]["field_value"])
    return [value for value in values if value is not None]


def equated(part: Rule) -> tuple[Rule, Rule] | None:
    """Return the two sides of an equation in a body, or None for any other part."""
    if "unification" in part:
        pair = part["unification"]
        return pair["left_hand_side"], pair["right_hand_side"]
    if part.get("predicate", {}).get("predicate_name") == "=":
        left, right = operands(part["predicate"])
        return left, right
    return None


def nodes(tree: Any, stop: Callable[[Rule], object] | None = None) -> Iterator[Rule]:
    """Yield all nodes of a syntax tree, outer before inner.

    Args:
        tree: The tree.
        stop: Whether to leave out what is inside a node.
    """
    waiting = [tree]
    while waiting:
        branch = waiting.pop()
        if isinstance(branch, dict):
            yield branch
            if stop is None or not stop(branch):
                waiting.extend(reversed(branch.values()))
        elif isinstance(branch, list):
            waiting.extend(reversed(branch))


def is_aggregate(node: Rule) -> bool:
    """Return whether a node is an aggregate or a negation, which has variables of its own."""
    return "combine" in node


def text_of(expression: Rule) -> str | None:
    """Return the text of a literal, or None for any other expression."""
    found = expression.get("literal", {}).get("the_string")
    return None if found is None else str(found["the_string"])


def predicate_of(expression: Rule) -> str:
    """Return the predicate that an expression names, as written, or ""."""
    name: str = expression.get("literal", {}).get("the_predicate", {}).get("predicate_name", "")
    return name


def variable_of(expression: Rule) -> str:
    """Return the name of a variable, or "" for any other expression."""
    return str(expression.get("variable", {}).get("var_name", ""))


def calls(tree: Any) -> Iterator[tuple[Rule, bool]]:
    """Yield all calls in a syntax tree, and whether each is a function call."""
    for node in nodes(tree):
        if isinstance(node.get("call"), dict):
            yield node["call"], True
        if isinstance(node.get("predicate"), dict):
            yield node["predicate"], False


def called(tree: Any) -> Iterator[str]:
    """Return the names of all predicates, functions and aggregates that a syntax tree mentions."""
    for node in nodes(tree):
        for key in ("call", "predicate", "the_predicate"):
            if isinstance(node.get(key), dict):
                yield node[key]["predicate_name"]
        if "operator" in node and "argument" in node:
            yield parse.AggergationsAsExpressions.AggregationOperator(node["operator"])


def reached(tree: Any, rules: Mapping[str, Any]) -> set[str]:
    """Return the names of the predicates that a syntax tree uses, directly or indirectly."""
    found: set[str] = set()
    waiting = [tree]
    while waiting:
        for name in map(str, called(waiting.pop())):
            if name not in found:
                found.add(name)
                waiting.append(rules.get(name, []))
    return found


def parameters(rules: list[Rule]) -> frozenset[str]:
    """Return the names of predicates that are substituted somewhere and defined nowhere."""
    filled = {name for rule in rules for name in filled_in(rule)}
    return frozenset(filled.difference(heads(rules)))


def lacking(rules: list[Rule]) -> dict[str, str]:
    """Return for each predicate that uses an unsubstituted parameter the name of that parameter."""
    own, left_open = heads(rules), parameters(rules)

    def first_open(name: str, filled: frozenset[str], seen: set[str]) -> Iterator[str]:
        if name in left_open:
            if name not in filled:
                yield name
        elif name in own and name not in seen:
            seen.add(name)
            for rule in own[name]:
                inside = filled.union(filled_in(rule))
                for other in map(str, called(rule)):
                    yield from first_open(other, inside, seen)

    found = {name: next(first_open(name, frozenset(), set()), "") for name in own}
    return {name: other for name, other in found.items() if other}


def mentioned_by_make(rule: Rule) -> set[str]:
    """Return the predicates that a rule with ``:=`` makes, copies, substitutes or puts in."""
    return {*map(str, called(rule)), *filled_in(rule)}


def filled_in(rule: Rule) -> list[str]:
    """Return the names that a rule with ``:=`` substitutes."""
    if head_name(rule) != "@Make":
        return []
    arguments = rule["head"]["record"]["field_value"]
    given = value_of(arguments[2]) if len(arguments) > 2 else None
    record = (given or {}).get("record", {})
    return [str(fv["field"]) for fv in record.get("field_value", [])]
