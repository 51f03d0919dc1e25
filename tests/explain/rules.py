"""Rules as text, taken apart by what is written, without the code that explanations are made by."""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

_AGGREGATE = re.compile(r"(?<![\w.])([A-Z]\w*)\s*\{")
_NAME = re.compile(r"\"[^\"]*\"|\.\w+|\b\w+\s*\?|\b[a-z_]\w*\b(?!\s*:)|\b[a-z_]\w*(?=\s*:\s*[,})])")
_WORDS = frozenset({"if", "then", "else", "in", "is", "not", "null", "true", "false", "distinct"})
_HEAD = re.compile(r"(?P<name>\w+)\s*(?P<operator>\?\s*[\w+]+\s*=|:)\s*(?P<value>.*)", re.DOTALL)


class Aggregate(NamedTuple):
    """An aggregate as written: ``Operator{value -> by :- body}``, or a column of a head."""

    operator: str
    value: str
    by: str
    body: str
    text: str


class Written(NamedTuple):
    """A rule: its columns that are not aggregated, those that are, its body, or ""."""

    columns: dict[str, str]
    collected: dict[str, Aggregate]
    body: str


def split(text: str, separator: str) -> list[str]:
    """Split where a separator stands outside of brackets and texts."""
    found, depth, begin, is_text = [], 0, 0, False
    for at, character in enumerate(text):
        is_text ^= character == '"'
        if not is_text and at >= begin:
            depth += (character in "([{") - (character in ")]}")
            if not depth and text.startswith(separator, at):
                found.append(text[begin:at])
                begin = at + len(separator)
    return [part.strip() for part in (*found, text[begin:])]


def parts(rule: str) -> Written:
    head, *bodies = split(rule, ":-")
    begin = head.index("(") + 1
    stop = _closing(head, begin)
    inside, result = head[begin:stop], head[stop + 1 :].strip().removeprefix("=").strip()
    columns, collected = {}, {}
    for place, argument in enumerate(split(inside, ",") if inside.strip() else ()):
        match = _HEAD.fullmatch(argument)
        if match is None:
            columns[f"col{place}"] = argument
        elif match["operator"] == ":":
            columns[match["name"]] = match["value"] or match["name"]
        else:
            value, *by = split(match["value"] or match["name"], "->")
            operator = match["operator"].strip("?= \n")
            collected[match["name"]] = Aggregate(operator, value, "".join(by), "", "")
    if result and result != "distinct":
        columns["logica_value"] = result
    return Written(columns, collected, bodies[0] if bodies else "")


def _closing(text: str, at: int) -> int:
    """Where the bracket that was opened before `at` is closed."""
    depth = 1
    while depth:
        depth += (text[at] in "([{") - (text[at] in ")]}")
        at += 1
    return at - 1


def aggregates(text: str) -> Iterator[Aggregate]:
    """All aggregates that are written in an expression or a body, outer ones first."""
    for match in _AGGREGATE.finditer(text):
        stop = _closing(text, match.end())
        value, *bodies = split(text[match.end() : stop], ":-")
        if bodies:
            value, *by = split(value, "->")
            yield Aggregate(match[1], value, "".join(by), bodies[0], text[match.start() : stop + 1])


def apart(aggregate: Aggregate, rule: str) -> Aggregate:
    """An aggregate whose own variables have names that nothing else in its rule has."""
    outside = rule
    for each in aggregates(rule):
        outside = outside.replace(each.text, "")
    known = set(names(outside))
    own = {name for name in names(aggregate.text) if name not in known}

    def renamed(text: str) -> str:
        text = re.sub(r"([(,{]\s*)(\w+):\s*(?=[,)}])", r"\1\2: \2", text)
        for name in own:
            text = re.sub(rf'(?<![\w."]){name}\b(?!"|\s*:[^-=])', f"{name}_inside", text)
        return text

    operator, value, by, body, text = aggregate
    return Aggregate(operator, renamed(value), renamed(by), renamed(body), text)


def names(text: str) -> Iterator[str]:
    for match in _NAME.finditer(text):
        if match[0][0] not in '".' and not match[0].endswith("?") and match[0] not in _WORDS:
            yield match[0]


def equal(expression: str, value: Any) -> str:
    """The condition that an expression has a value, or "" if that can't be compared exactly."""
    if isinstance(value, dict | list) and re.search(r"\.|\bnull\b", spelled(value)):
        return ""  # not the same to the last digit; nor is null where the compiler compares fields
    if expression.isidentifier() and value is not None and not isinstance(value, float):
        return f"{expression} == {spelled(value)}"
    if value is None:
        return f"({expression}) is null"
    if isinstance(value, float) and not value.is_integer():  # a sum depends on the order of rows
        return f"Abs(({expression}) - ({value!r})) < {max(1, abs(value)) * 1e-12!r}"
    return f"({expression}) == {spelled(value)}"


def spelled(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name}: {spelled(each)}' for name, each in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(spelled, value))}]"
    return json.dumps(value, ensure_ascii=False)
