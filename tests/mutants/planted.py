"""The mutants, and how a run of one is diagnosed."""

import asyncio
import tomllib
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

from logical_robots_tui.explain import Ask, Explainer
from logical_robots_tui.explain.diagnosis.telling import Finding
from logical_robots_tui.explain.why.nearest import Suggestion
from logical_robots_tui.game import Game, load_program
from logical_robots_tui.game.diagnosing import Diagnosis, diagnose
from logical_robots_tui.mind import Mind, Program
from logical_robots_tui.values import SensorRow, Value
from logical_robots_tui.world import World, load_level

__all__ = [
    "FIRST",
    "HEAD",
    "MUTANTS",
    "Mutant",
    "diagnosis_of",
    "first_difference",
    "rank",
    "suggestions",
    "verdict",
]

HEAD = "    kind               program               line  differs  findings  named by   nearest"
FIRST = 5  # findings are read before one gives up


@dataclass(frozen=True)
class Mutant:
    """A reference program with a bug: in a line, something new stands for something old."""

    kind: str
    level: str
    program: str
    line: int
    old: str
    new: str
    ticks: int = 3000

    @property
    def text(self) -> str:
        lines = load_program(self.program).text.split("\n")
        assert lines[self.line - 1].count(self.old) == 1, self
        lines[self.line - 1] = lines[self.line - 1].replace(self.old, self.new)
        return "\n".join(lines)


_TABLE = tomllib.loads(Path(__file__).with_name("mutants.toml").read_text())
MUTANTS = [Mutant(**row) for row in _TABLE["mutant"]]


@cache
def diagnosis_of(level: str, text: str, ticks: int) -> Diagnosis:
    async def work() -> Diagnosis:
        game = Game(load_level(level), Program.compile(text))
        try:
            await game.run_until(tick=ticks)
            return await diagnose(game)
        finally:
            await game.close()

    return asyncio.run(work())


def rank(findings: tuple[Finding, ...], line: int) -> tuple[int, bool] | None:
    """The place, from 1, of the first finding that names a line, and whether it is its own."""
    for number, finding in enumerate(findings, 1):
        spans = [span for span in (finding.span, *finding.related) if span is not None]
        if any(span.line == line for span in spans):
            own = finding.span is not None and finding.span.line == line
            return number, own
    return None


@dataclass(frozen=True)
class Difference:
    """The first tick in which a mutant decides otherwise than the reference program for a robot."""

    tick: int
    robot: str
    rows: list[SensorRow]
    memories: dict[str, Value]


def first_difference(mutant: Mutant) -> Difference | None:
    """Where a mutant first decides otherwise than the reference program, in that one's run."""
    level = load_level(mutant.level)
    visibility = level.visibility
    reference, other = (
        Mind(Program.compile(text), memory=visibility.memory, sensor=visibility.sensor)
        for text in (load_program(mutant.program).text, mutant.text)
    )
    world = World(level)
    memories: dict[str, Value] = {robot.name: "" for robot in level.robots}
    try:
        while world.tick < mutant.ticks and world.won_at is None:
            rows = world.sense()
            decisions = reference.think(rows, memories)
            for mine, its in zip(decisions, other.think(rows, memories), strict=True):
                if mine != its:
                    return Difference(world.tick, mine.robot_name, rows, memories)
            world.act({d.robot_name: d.desire for d in decisions if d.desire is not None})
            memories = {d.robot_name: d.memory for d in decisions}
    finally:
        reference.close()
        other.close()
    return None


@dataclass(frozen=True)
class Verdict:
    """What was found of a mutant: its line of the table, and what names the line of the bug."""

    line: str
    by_diagnosis: bool
    by_either: bool


def verdict(number: int) -> Verdict:
    mutant = MUTANTS[number - 1]
    there = first_difference(mutant)
    found = diagnosis_of(mutant.level, mutant.text, mutant.ticks)
    place = rank(found.findings, mutant.line)
    nearest = suggestions(mutant, there) if there is not None else []
    named = [miss for miss in nearest if miss.span.line == mutant.line]
    by_diagnosis = place is not None and place[0] <= FIRST
    how = f"{place[0]} {'itself' if place[1] else 'places'}" if place else "-"
    line = (
        f"{number:2}  {mutant.kind:17}  {mutant.program:20}  {mutant.line:4}  "
        f"{there.tick if there else '-':>7}  {len(found.findings):8}  {how:9}  "
        f"{len(named)} of {len(nearest)}"
    )
    return Verdict(line, by_diagnosis, by_diagnosis or bool(named))


def suggestions(mutant: Mutant, there: Difference) -> list[Suggestion]:
    """The nearest misses of all rules that `Robot` leans on, where a mutant first differs."""
    program = Program.compile(mutant.text)
    visibility = asdict(load_level(mutant.level).visibility)
    found: list[Suggestion] = []
    with closing(Mind(program, **visibility)) as mind:
        explainer = Explainer(mind, there.robot, there.rows, there.memories)
        for predicate in program.needed:
            found += [miss for _, miss in explainer.nearest(Ask(predicate))]
    return found
