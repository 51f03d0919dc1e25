"""Specifications of sweeps, gradings and tournaments: TOML, checked as a whole, with lines."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import Annotated, Literal, TypeAlias

import msgspec

from logical_robots_tui.toml_files import Bounds, Path_, TomlFile

Scalar: TypeAlias = bool | int | float | str

BUILT_IN = ("won", "ticks", "distance", "rules")
"""Measures of every run."""

_MOST_VALUES = 10_000

Positive: TypeAlias = Annotated[int, Bounds(1)]
Starts: TypeAlias = Annotated[int, Bounds(0, 10_000)]
Share: TypeAlias = Annotated[float, Bounds(0)]
Name: TypeAlias = Annotated[str, Bounds(1)]


class Limit(msgspec.Struct, frozen=True):
    """``[limits]``: steps per think, which affect the result, and seconds per run."""

    steps: Positive = 100_000_000
    seconds: Annotated[float, Bounds(0.001)] = 600.0


class Query(msgspec.Struct, frozen=True):
    """A Logica question, asked every so many ticks; 0 means in the last tick only."""

    query: Name
    every: Annotated[int, Bounds(0)] = 0


class Vary(msgspec.Struct, frozen=True):
    """``[[vary]]``: the values of one constant or one field of the level."""

    constant: str = ""
    level: str = ""
    values: list[Scalar] = []
    range: Annotated[list[float], Bounds(2, 3)] | None = None


class Case(msgspec.Struct, frozen=True):
    """``[[case]]``: one combination of constants and fields of the level."""

    constants: dict[str, Scalar] = {}
    level: dict[str, Scalar] = {}


class ExperimentTable(msgspec.Struct, frozen=True):
    level: Name | Annotated[list[Name], Bounds(1)]
    program: Name | Annotated[list[Name], Bounds(1)]
    title: str = ""
    starts: Starts = 0
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = False


class Experiment(msgspec.Struct, frozen=True):
    experiment: ExperimentTable
    vary: list[Vary] = []
    case: list[Case] = []
    measure: dict[str, Literal["end"] | Query] = {}
    limits: Limit = Limit()


class LevelTable(msgspec.Struct, frozen=True):
    name: Name
    points: Share = 10.0


class Split(msgspec.Struct, frozen=True):
    """``[points]``: how the points of a level are split; only the proportions matter."""

    won: Share = 1.0
    starts: Share = 0.0
    ticks: Share = 0.0
    rules: Share = 0.0


class Late(msgspec.Struct, frozen=True):
    """``[late]``: the deadline or a file of late students, and the share of points they keep."""

    after: datetime | None = None
    students: str = ""
    keep: Annotated[float, Bounds(0, 1)] = 1.0


class AssignmentTable(msgspec.Struct, frozen=True):
    title: str = ""
    starts: Starts = 20
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = True
    roster: str = ""
    show: list[Literal["won", "starts", "ticks", "rules", "distance"]] = msgspec.field(
        default_factory=lambda: ["won", "starts", "ticks", "rules"]
    )


class Assignment(msgspec.Struct, frozen=True):
    assignment: AssignmentTable
    level: Annotated[list[LevelTable], Bounds(1)]
    points: Split = Split()
    late: Late = Late()
    limits: Limit = Limit()


class TournamentTable(msgspec.Struct, frozen=True):
    """``[tournament]``; a match lasts as many ticks as the level says, or fewer."""

    level: Name
    title: str = ""
    starts: Starts = 20
    ticks: Positive | None = None
    format: Literal["all", "swiss"] | None = None


class Tournament(msgspec.Struct, frozen=True):
    tournament: TournamentTable
    limits: Limit = Limit()


def read_experiment(spec: TomlFile) -> Experiment:
    """Return an experiment, without looking up names, or raise TomlFileError."""
    found = spec.read(Experiment)
    for number, vary in enumerate(found.vary):
        path = ("vary", number)
        if bool(vary.constant) == bool(vary.level):
            spec.problem(path, 'name either a "constant" or a field of the "level" to vary')
        if bool(vary.values) == (vary.range is not None):
            spec.problem(path, 'give either "values" or a "range" [from, to, step]')
        elif vary.range is not None and not _in_range(vary.range):
            spec.problem((*path, "range"), f"a range is [from, to, step], at most {_MOST_VALUES:,}")
        _check_texts(spec, (*path, "values"), vary.values)
    for number, case in enumerate(found.case):
        _check_texts(spec, ("case", number, "constants"), case.constants.values())
        _check_texts(spec, ("case", number, "level"), case.level.values())
    for name, measure in found.measure.items():
        if (measure == "end") != (name in BUILT_IN):
            spec.problem(
                ("measure", name),
                f'"{name}" is measured at the "end"'
                if name in BUILT_IN
                else f'write {name} = {{query = "...", every = 10}}; measured without a query are '
                + ", ".join(BUILT_IN),
            )
    spec.refuse()
    return found


def read_assignment(spec: TomlFile) -> Assignment:
    """Return an assignment, without looking up names, or raise TomlFileError."""
    found = spec.read(Assignment)
    if not any(msgspec.structs.astuple(found.points)):
        spec.problem(("points",), "at least one share of the points must be more than 0")
    if found.points.starts and not found.assignment.starts:
        spec.problem(("points", "starts"), "there are points for starts, but starts = 0")
    names = [level.name for level in found.level]
    for number, name in enumerate(names):
        if name in names[:number]:
            spec.problem(("level", number, "name"), f'the level "{name}" is there twice')
    spec.refuse()
    return found


def values_of(vary: Vary) -> list[Scalar]:
    return _in_range(vary.range) if vary.range is not None else vary.values


def _in_range(bounds: list[float]) -> list[Scalar]:
    """Return the numbers of a range by step; [] if there are infinitely or too many."""
    first, last, step = (*bounds, 1.0)[:3]
    steps = (last - first) / step if step else -1.0
    if not 0 <= steps < _MOST_VALUES:
        return []
    found = [float(f"{first + number * step:.12g}") for number in range(int(steps + 1e-9) + 1)]
    whole = all(number.is_integer() for number in found)
    return [int(n) if whole else n for n in found]


def _check_texts(spec: TomlFile, path: Path_, values: Iterable[Scalar]) -> None:
    texts = [value for value in values if isinstance(value, str)]
    if not all(text.isprintable() and '"' not in text for text in texts):
        spec.problem(path, "a text must be on one line, without double quotes")
