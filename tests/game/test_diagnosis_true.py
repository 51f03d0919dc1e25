"""What a diagnosis says of conditions is so: each is asked again, tick by tick, by questions."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Sequence
from contextlib import closing
from typing import Any

import pytest

from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.mind import Mind, Program, ProgramError
from logical_robots_tui.values import Value
from logical_robots_tui.world import Level, World
from tests.explain.judging import judge_until
from tests.explain.rules import names, parts, split
from tests.explain.teams import Team, team
from tests.game.test_diagnosing import diagnosed

TICKS = 4
CASES = re.compile(r"(?:in (?P<copy>\w+) )?in (?:the|all) (?P<number>one|[\d,]+) cases? evaluated")


class Run:
    """A program's ticks, to be asked about: thought again, without a game."""

    def __init__(self, level: Level, text: str, copies: dict[str, str]) -> None:
        self.text, self.copies = text, copies
        self.program = Program.compile(text)
        self.mind = Mind(self.program, memory="all", sensor="all")
        self._ticks: list[tuple[Any, Any]] = []
        world = World(level)
        memories: dict[str, Value] = dict.fromkeys([r.name for r in level.robots], "")
        for _ in range(TICKS):
            rows = world.sense()
            self._ticks.append((rows, memories))
            decisions = self.mind.think(rows, memories)
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}

    def ways(self, conditions: Sequence[str], made: str = "") -> int | None:
        """In how many ways conditions hold in all ticks; None if that can't be asked."""
        asked = f"Ways(n? += 1) distinct :- {', '.join(conditions)}"
        try:
            question = self.program.question(f"{asked};\nMade := Ways({made})" if made else asked)
        except ProgramError as error:
            return self.ways(conditions) if " does not use " in str(error) else None
        tables = (self.mind.ask(question, rows, memories) for rows, memories in self._ticks)
        numbers = (number for table in tables for (number,) in table.rows)
        return sum(int(number) for number in numbers if isinstance(number, int | float))


def needed(made: Team) -> str:
    """A team's program in which robots see all, and use all predicates."""
    used = [name for name in sorted(made.names) if re.match(r"P\d|Copy", name)]
    counts = ", ".join(f"Count{{k{n} :- {name}(key: k{n})}}" for n, name in enumerate(used))
    text = made.text.replace("desire == Go()", f"desire == Go(), used == [{counts}]")
    return f'@Visible(Memory, "all"); @Visible(Sensor, "all");\n{text}'


def false_findings(findings: Sequence[Finding], run: Run) -> tuple[int, list[str]]:
    """How many findings could be asked for, and what is false in them."""
    number, false = 0, []
    for finding in findings:
        cases = CASES.search(finding.message)
        before = _before(finding, run.text) if finding.span else None
        if cases is None or before is None or finding.span is None:
            continue
        made = run.copies.get(cases["copy"] or "", "")
        reached = run.ways(before, made)
        holding = run.ways([*before, finding.span.text], made)
        if reached is None or holding is None:
            continue
        number += 1
        told = 1 if cases["number"] == "one" else int(cases["number"].replace(",", ""))
        expected = reached if "` held" in finding.message else 0
        if (reached, holding) != (told, expected):
            false.append(f"{finding.message} {before}: {reached} cases, held in {holding}")
    return number, false


def _before(finding: Finding, text: str) -> list[str] | None:
    """The parts of a body that come before the one of a finding, if it is a whole part."""
    assert finding.span is not None
    start = max(text.rfind(";", 0, finding.span.start), text.rfind("\n", 0, finding.span.start)) + 1
    rule = text[start : text.index(";", finding.span.start)]
    if ":-" not in rule or finding.kind == "always null":
        return None
    body = split(parts(rule.strip()).body, ",")
    if finding.span.text not in body or rule.count(finding.span.text) > 1:
        return None
    before = body[: body.index(finding.span.text)]
    is_bound = {*names(", ".join(before))} >= {*names(finding.span.text)}
    return before if before and is_bound else None


MANY = (pytest.param(8, marks=pytest.mark.slow), pytest.param(200, marks=pytest.mark.proof))


@pytest.mark.parametrize("findings", [2, *MANY])
def test_what_is_said_never_to_hold_never_does(level: Level, findings: int) -> None:
    def ask(seed: int) -> int:
        made = team(seed)
        text = needed(made)
        diagnosis = asyncio.run(diagnosed(level, text, TICKS))
        run = Run(level, text, made.copies)
        with closing(run.mind):
            number, false = false_findings(diagnosis.findings, run)
        assert not false, (text, false)
        return number

    judge_until(findings, ask)
