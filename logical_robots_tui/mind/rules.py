"""Rules as the `logica` package parses them: who defines and who calls what."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, TypeAlias

from logica.parser_py import parse

from logical_robots_tui.mind.prelude import PRELUDE

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Rule", "called", "defined", "head_name", "prelude_rules", "subject"]

Rule: TypeAlias = dict[str, Any]


def head_name(rule: Rule) -> str:
    """Name of the predicate or annotation that a rule is for."""
    return str(rule["head"]["predicate_name"])


@functools.cache
def prelude_rules() -> tuple[Rule, ...]:
    """The rules of the prelude. Don't change them."""
    return tuple(parse.ParseFile(PRELUDE)["rule"])


def defined(rules: list[Rule]) -> Iterator[str]:
    """Names of the program's own predicates in the order of the text, once each."""
    seen = set()
    for rule in rules:
        name = head_name(rule)
        if name == "@Make":
            name = subject(rule)
        hidden = name.startswith("@") or name.endswith(parse.MultiBodyAggregation.SUFFIX)
        if name not in seen and not hidden:
            seen.add(name)
            yield name


def subject(rule: Rule) -> str:
    """Name of the predicate that an annotation speaks of, or ""."""
    try:
        literal = rule["head"]["record"]["field_value"][0]["value"]["expression"]["literal"]
        return str(literal["the_predicate"]["predicate_name"])
    except (KeyError, IndexError):
        return ""


def called(tree: Any) -> Iterator[str]:
    """Names of all predicates and functions that a syntax tree calls."""
    if isinstance(tree, list):
        for branch in tree:
            yield from called(branch)
    elif isinstance(tree, dict):
        for key, branch in tree.items():
            if key == "call" or key == "predicate" or key == "the_predicate":
                yield branch["predicate_name"]
            if isinstance(branch, dict | list):
                yield from called(branch)
