"""Questions about all that a program has, and whether the answers are true."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from typing import Any

from logical_robots_tui.explain import Ask, Explainer, ProofNode
from logical_robots_tui.explain.why.explanation import read_call, spell_call
from logical_robots_tui.mind import Limits, Mind, Program
from logical_robots_tui.mind.relations import same
from tests.explain.checking import Checker, Claim
from tests.explain.judging import claims_in
from tests.explain.teams import ROBOTS, Team
from tests.mind.rows import row

_MOST_ROWS = 4
_MOST_NODES = 1_000


@dataclass(frozen=True)
class Scene:
    """A program at a moment, as one robot sees it, and the predicates that are asked about."""

    mind: Mind
    copies: dict[str, str]  # by predicate made with `:=`, what is filled in
    rows: Any
    memories: Any
    robot: str
    names: list[str]

    def explainer(self) -> Explainer:
        return Explainer(self.mind, self.robot, self.rows, self.memories)

    def there(self, name: str) -> list[dict[str, Any]]:
        table = self.mind.query(name, self.rows, self.memories).in_mind_of(self.robot)
        found = [dict(zip(table.columns, each, strict=True)) for each in table.rows]
        return [each for each in found if each.get("robot_name", self.robot) == self.robot]


@dataclass(frozen=True)
class Asked:
    number: int
    false: list[str]


@contextmanager
def alone(text: str) -> Iterator[Scene]:
    program = Program.compile(text)
    with closing(Mind(program, limits=Limits(query_seconds=60))) as mind:
        names = [p.name for p in program.predicates if p.kind == "program" and p.has_rows]
        names.remove("Robot")
        yield Scene(mind, {"P9": "A: B"}, [row("Ada")], {}, "Ada", names)


@contextmanager
def together(team: Team) -> Iterator[Scene]:
    *_, (rows, memories) = team.ticks()
    with closing(team.mind()) as mind:
        known = [p for p in team.program.predicates if p.kind == "program" and p.has_rows]
        names = [p.name for p in known if p.name in team.names]
        yield Scene(mind, team.copies, rows, memories, ROBOTS[team.seed % 3], names)


def asked(scene: Scene) -> Asked:
    checker = Checker(scene.mind.program, scene.mind, scene.rows, scene.memories, scene.robot)
    number = 0
    claims: list[Claim] = []
    false: list[str] = []
    for name in scene.names:
        there = scene.there(name)
        for given in _wanted(there, scene.mind.query(name, scene.rows, scene.memories).columns):
            number += 1
            expected = sum(_matches(each, given) for each in there)
            claimed, wrong = _answer(scene, checker, Ask(name, given), expected)
            claims += claimed
            false += [f"{name} {given}: {found}" for found in wrong]
    false += checker.false(claims)
    assert checker.unknown < max(20, checker.asked / 4), checker.refused[-5:]
    return Asked(number, false)


def _wanted(there: list[dict[str, Any]], columns: tuple[str, ...]) -> Iterator[dict[str, Any]]:
    different = list({repr(each): each for each in there}.values())
    yield from different[:_MOST_ROWS]
    like = (different or [dict.fromkeys(columns, 0)])[0]
    first, *others = columns
    if first != "robot_name":
        yield {**like, first: "nobody"}
        yield {first: "a"}
    if others:
        yield {**like, others[0]: 77}


def _matches(row: dict[str, Any], given: dict[str, Any]) -> bool:
    return all(same(row[column], value) for column, value in given.items())


def _answer(
    scene: Scene, checker: Checker, ask: Ask, expected: int
) -> tuple[list[Claim], list[str]]:
    """What an answer claims, and what is false in it without asking the program."""
    proof = scene.explainer().proof(ask, nodes=_MOST_NODES)
    explanation = proof.explanation
    claims, false = claims_in(proof.nodes, explanation.query, checker, scene.copies)
    if explanation.rows != expected:
        false.append(f"{explanation.rows} rows, not {expected}")
    if expected and all(rule.row is None for rule in explanation.rules):
        false.append(f"no rule gives it: {[rule.node.remark for rule in explanation.rules]}")
    for node in proof.nodes:
        if not _is_founded(node, ()):
            false.append(f"proved by itself: {node.text}")
        for question in filter(None, (inner.query for _, inner in node.walk())):
            if read_call(spell_call(question), question.within) != question:
                false.append(f"{spell_call(question)} does not ask {question}")
    return claims, false


def _is_founded(node: ProofNode, above: tuple[str, ...]) -> bool:
    """Whether no row is proved by itself."""
    if node.kind == "rule":
        told = [child for child in node.children if child.kind in ("column", "aggregate")]
        key = f"{node.text} {[(child.text, child.values) for child in told]}"
        if told and key in above:
            return False
        above = (*above, key)
    return all(_is_founded(child, above) for child in node.children)


def missed(scene: Scene) -> Asked:
    """Ask what would have given rules a row; try each change in a program of its own."""
    program = scene.mind.program
    number, false = 0, []
    for name in scene.names:
        if name in scene.copies:
            continue
        columns = scene.mind.query(name, scene.rows, scene.memories).columns
        missed = [
            (given, *each)
            for given in ({}, *_wanted(scene.there(name), columns))
            for each in scene.explainer().nearest(Ask(name, given))
        ]
        for given, rule, suggestion in missed:
            number += 1
            span, change = suggestion.span, suggestion.change
            before = _rows_of_rule(scene, program.text, rule.start, rule.stop, given)
            changed = f"{program.text[: span.start]}{change}{program.text[span.stop :]}"
            moved = len(change) - (span.stop - span.start)
            start = rule.start + (moved if span.start < rule.start else 0)
            stop = rule.stop + (moved if span.start < rule.stop else 0)
            after = _rows_of_rule(scene, changed, start, stop, given)
            if before or not after:
                said = f"{name} {given}: {suggestion.text}"
                false.append(f"{said} {before} rows before, {after} after")
    return Asked(number, false)


def _rows_of_rule(scene: Scene, text: str, start: int, stop: int, given: dict[str, Any]) -> int:
    """How many such rows one rule of a program gives; what is removed goes with its comma."""
    arguments = text[text.index("(", start) : stop]
    whole = f"{text}\nThisRule{arguments};"
    whole = re.sub(r"(?<=[({|])\s*,\s*|(?<=:-)\s*,|,\s*(?=\s*[,)};|])", "", whole)
    whole = re.sub(r"(?<=:-)\s+,|:-\s*(?=;)", "", whole)
    mind = scene.mind
    with closing(Mind(Program.compile(whole), memory=mind.memory, sensor=mind.sensor)) as other:
        table = other.query("ThisRule", scene.rows, scene.memories).in_mind_of(scene.robot)
    rows = (dict(zip(table.columns, row, strict=True)) for row in table.rows)
    return sum(_matches(row, given) for row in rows)
