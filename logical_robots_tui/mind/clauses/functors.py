"""Predicates made with ``:=``, expanded into rules of their own. In the compile process."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from logical_robots_tui.mind.clauses import trees
from logical_robots_tui.mind.compiling.package_patches import deep_copy
from logical_robots_tui.mind.compiling.rules import (
    head_name,
    heads,
    predicate_of,
    reached,
    subject,
    value_of,
)
from logical_robots_tui.mind.program import VALUE

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from logical_robots_tui.mind.compiling.rules import Rule


@dataclass(frozen=True, slots=True)
class Expanded:
    """The rules of a program with every ``:=`` expanded.

    Attributes:
        rules: The rules of each predicate, including copies made by ``:=``.
        others: Annotations.
        names: The name of the copy, by predicate and the made predicate that it belongs to.
        origins: The reverse of `names`.
        bases: For each made predicate, the one that it is ultimately made from.
    """

    rules: dict[str, list[Rule]]
    others: list[Rule]
    names: dict[tuple[str, str], str] = field(default_factory=dict)
    origins: dict[str, tuple[str, str]] = field(default_factory=dict)
    bases: dict[str, str] = field(default_factory=dict)

    def name_of(self, predicate: str, within: str) -> str:
        """Return the name of a predicate, or of its copy in a made one."""
        return self.names.get((predicate, within), predicate)

    def reach(self, name: str) -> set[str]:
        """Return the names of the predicates that one uses, directly or indirectly."""
        return reached(self.rules.get(name, []), self.rules)


def expand(raw: Iterable[Rule]) -> Expanded:
    """Expand every ``:=``."""
    raw = list(raw)
    own = heads(raw)
    makes = {name: rules[0] for name, rules in own.items() if head_name(rules[0]) == "@Make"}
    expanded = Expanded(
        {name: rules for name, rules in own.items() if name not in makes},
        [rule for rule in raw if head_name(rule).startswith("@") and head_name(rule) != "@Make"],
    )
    waiting = dict(makes)
    while waiting:
        ready = [name for name, make in waiting.items() if _is_ready(make, waiting, expanded)]
        for name in ready or list(waiting):
            _make(name, waiting.pop(name), expanded)
    return expanded


def recursions_written_out(raw: list[Rule]) -> list[Rule]:
    """Return the rules with every ``:=`` expanded if one makes a recursive predicate, or unchanged.

    The package must unroll a recursion that it makes itself.
    """
    if not any(head_name(rule) == "@Make" for rule in raw):
        return raw
    expanded = expand(raw)
    made = {name: expanded.bases[name] for name in expanded.bases}
    made |= {copy: original for copy, (original, _) in expanded.origins.items()}
    if not any(name in expanded.reach(name) for name in made):
        return raw
    rules = list(expanded.others)
    for name, original in made.items():
        for other in expanded.others:
            if subject(other) == original:
                copied = deep_copy(other)
                rename(copied, {original: name})
                rules.append(copied)
    return [*rules, *(rule for own in expanded.rules.values() for rule in own)]


def _is_ready(make: Rule, waiting: Mapping[str, Rule], expanded: Expanded) -> bool:
    base, given = _made_from(make)
    needed = {base, *expanded.reach(base)}
    for value in given.values():
        name = predicate_of(value)
        needed |= {name, *expanded.reach(name)} if name else set()
    return not needed & waiting.keys()


def _make(name: str, make: Rule, expanded: Expanded) -> None:
    base, given = _made_from(make)
    filled = {}
    for number, (argument, value) in enumerate(given.items()):
        filled[argument] = predicate_of(value) or f"{name}_given{number}"
        if not predicate_of(value):
            constant = trees.rule(filled[argument], {VALUE: value}, (), name)
            expanded.rules[filled[argument]] = [constant]
    reached = {base, *expanded.reach(base)}
    touched = {p for p in reached - filled.keys() if expanded.reach(p) & filled.keys()} | {base}
    copies = {p: f"{p}_in_{name}" for p in touched if p in expanded.rules} | {base: name}
    # Plain text: the name of a copied rule is not at the place of the ``:=``.
    renaming = {f"{old}": f"{new}" for old, new in {**copies, **filled}.items()}
    for original, copy in copies.items():
        rules = deep_copy(expanded.rules.get(original, []))
        for rule in rules:
            rule["head"]["predicate_name"] = f"{copy}"
            rename(rule, renaming)
        expanded.rules[copy] = rules
        if copy != name:
            first = expanded.origins.get(original, (original, ""))[0]
            expanded.names[first, name] = copy
            expanded.origins[copy] = first, name
    expanded.bases[name] = expanded.bases.get(base, base)


def rename(tree: Any, names: Mapping[str, str]) -> None:
    """Rename the predicates in a syntax tree, in place."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            for key in ("call", "predicate", "the_predicate"):
                inner = node.get(key)
                if isinstance(inner, dict) and inner.get("predicate_name") in names:
                    # Written names keep their place.
                    inner.setdefault("written", inner["predicate_name"])
                    inner["predicate_name"] = names[str(inner["predicate_name"])]
            if isinstance(node.get("operator"), str) and node["operator"] in names:
                node["operator"] = names[node["operator"]]
            waiting.extend(node.values())
        elif isinstance(node, list):
            waiting.extend(node)


def _made_from(make: Rule) -> tuple[str, dict[str, Rule]]:
    """Return what a ``@Make`` rule makes a predicate from, and the substitutions by name."""
    first, second, third = map(value_of, make["head"]["record"]["field_value"][:3])
    assert first is not None
    assert second is not None
    assert third is not None
    base = str(predicate_of(second))
    given = {str(f["field"]): value_of(f) for f in third["record"]["field_value"]}
    return base, {name: value for name, value in given.items() if value is not None}
