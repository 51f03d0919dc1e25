"""Specifications of sweeps, gradings and tournaments: TOML, checked as a whole, with lines."""

from __future__ import annotations

import math
import re
import tomllib
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, TypeVar, get_args, get_origin

import msgspec

from logical_robots_tui.errors import LogicalRobotsError
from logical_robots_tui.paths import did_you_mean, read_ordinary

Scalar: TypeAlias = bool | int | float | str
Path_: TypeAlias = tuple[str | int, ...]

BUILT_IN = ("won", "ticks", "distance", "rules")
"""Measures of every run."""

Measure: TypeAlias = Annotated[str, msgspec.Meta(pattern=f"^({'|'.join(BUILT_IN)})$")]
"""The name of one of them."""

_MOST_BYTES = 1_000_000
_MOST_VALUES = 10_000

Positive: TypeAlias = Annotated[int, msgspec.Meta(ge=1)]
Starts: TypeAlias = Annotated[int, msgspec.Meta(ge=0, le=10_000)]
Share: TypeAlias = Annotated[float, msgspec.Meta(ge=0)]
Name: TypeAlias = Annotated[str, msgspec.Meta(min_length=1)]


class SpecificationError(LogicalRobotsError):
    """All problems of a specification, in the order of the text, with file and line."""

    title = "This specification can't be used"

    def __init__(self, problems: tuple[str, ...]) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


class _Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a specification; its fields are the known keys."""


class Limit(_Table, frozen=True):
    """``[limits]``: steps per think, which affect the result, and seconds per run."""

    steps: Positive = 100_000_000
    seconds: Annotated[float, msgspec.Meta(gt=0)] = 600.0


class Query(_Table, frozen=True):
    """A Logica question, asked every so many ticks; 0 means in the last tick only."""

    query: Name
    every: Annotated[int, msgspec.Meta(ge=0)] = 0


class Vary(_Table, frozen=True):
    """``[[vary]]``: the values of one constant or one field of the level."""

    constant: str = ""
    level: str = ""
    values: list[Any] = []
    range: Annotated[list[float], msgspec.Meta(min_length=2, max_length=3)] | None = None


class Case(_Table, frozen=True):
    """``[[case]]``: one combination of constants and fields of the level."""

    constants: dict[str, Any] = {}
    level: dict[str, Any] = {}


class ExperimentTable(_Table, frozen=True):
    level: Name | Annotated[list[Name], msgspec.Meta(min_length=1)]
    program: Name | Annotated[list[Name], msgspec.Meta(min_length=1)]
    title: str = ""
    starts: Starts = 0
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = False


class Experiment(_Table, frozen=True):
    experiment: ExperimentTable
    vary: list[Vary] = []
    case: list[Case] = []
    measure: dict[str, Literal["end"] | Query] = {}
    limits: Limit = Limit()


class LevelTable(_Table, frozen=True):
    name: Name
    points: Share = 10.0


class Split(_Table, frozen=True):
    """``[points]``: how the points of a level are split; only the proportions matter."""

    won: Share = 1.0
    starts: Share = 0.0
    ticks: Share = 0.0
    rules: Share = 0.0


class Late(_Table, frozen=True):
    """``[late]``: the deadline or a file of late students, and the share of points they keep."""

    after: Annotated[datetime, msgspec.Meta(tz=True)] | None = None
    students: str = ""
    keep: Annotated[float, msgspec.Meta(ge=0, le=1)] = 1.0


class AssignmentTable(_Table, frozen=True):
    title: str = ""
    starts: Starts = 20
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = True
    roster: str = ""
    show: list[Literal["won", "starts", "ticks", "rules", "distance"]] = msgspec.field(
        default_factory=lambda: ["won", "starts", "ticks", "rules"]
    )


class Assignment(_Table, frozen=True):
    assignment: AssignmentTable
    level: Annotated[list[LevelTable], msgspec.Meta(min_length=1)]
    points: Split = Split()
    late: Late = Late()
    limits: Limit = Limit()


class TournamentTable(_Table, frozen=True):
    """``[tournament]``; a match lasts as many ticks as the level says, or fewer."""

    level: Name
    title: str = ""
    starts: Starts = 20
    ticks: Positive | None = None
    format: Literal["all", "swiss"] | None = None


class Tournament(_Table, frozen=True):
    tournament: TournamentTable
    limits: Limit = Limit()


T = TypeVar("T", Experiment, Assignment, Tournament)


class Specification:
    """A specification's text and its problems; other files are relative to `folder`.

    Raises SpecificationError if it can't be read or is not TOML.
    """

    def __init__(self, file: Path) -> None:
        self.file, self.folder = file, file.parent
        self._problems: list[tuple[int, str]] = []
        try:
            content = read_ordinary(file, _MOST_BYTES + 1)
            if len(content) > _MOST_BYTES:
                raise ValueError("it is larger than 1 MB")
            self.text = content.decode("utf-8-sig").replace("\r\n", "\n")
            self.data: dict[str, Any] = tomllib.loads(self.text)
        except tomllib.TOMLDecodeError as error:
            message, _, where = str(error).rpartition(" (at ")
            line = re.search(r"line (\d+)", where)
            at = int(line[1]) if line else self.text.count("\n") + 1
            raise SpecificationError((f"{file}:{at}: this is not TOML: {message}",)) from None
        except (OSError, ValueError, RecursionError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise SpecificationError((f"{file}: this can't be read: {reason}",)) from None
        self._lines = dict(_lines(self.text))

    def problem(self, path: Path_, message: str) -> None:
        while path and path not in self._lines:
            path = path[:-1]
        where = self._lines.get(path, 1)
        if (where, message) not in self._problems:
            self._problems.append((where, message))

    def refuse(self) -> None:
        """Raise SpecificationError if something is wrong."""
        if self._problems:
            found = sorted(self._problems)
            raise SpecificationError(
                tuple(f"{self.file}:{line}: {message}" for line, message in found)
            )

    def read(self, kind: type[T]) -> T:
        """Return the specification as a record, or raise SpecificationError."""
        found = self._read(kind, self.data, ())
        self.refuse()
        assert isinstance(found, kind)
        return found

    def _read(self, kind: Any, data: Any, path: Path_) -> Any:
        """Convert a value, reporting errors in all parts of a table, not only the first."""
        if get_origin(kind) is Annotated and isinstance(data, list) and data:
            kind = get_args(kind)[0]  # only the least length of lists of tables
        if get_origin(kind) is list and _is_table(get_args(kind)[0]) and isinstance(data, list):
            inner = get_args(kind)[0]
            return [self._read(inner, item, (*path, i)) for i, item in enumerate(data)]
        if get_origin(kind) is dict and isinstance(data, dict):
            inner = get_args(kind)[1]
            return {key: self._read(inner, item, (*path, key)) for key, item in data.items()}
        if not _is_table(kind) or not isinstance(data, dict):
            try:
                return msgspec.convert(data, kind)
            except msgspec.ValidationError as error:
                self.problem(path, _in_words(path, str(error)))
                return None
        fields = {field.encode_name: field for field in msgspec.structs.fields(kind)}
        for key in data.keys() - fields.keys():
            hint = did_you_mean(key, fields) or f"Known keys: {', '.join(fields)}."
            self.problem((*path, key), f'"{key}" is not a known key. {hint}')
        for name, field in fields.items():
            if field.required and name not in data:
                self.problem(path, f'"{".".join(map(str, (*path, name)))}" is missing')
        found = {
            name: self._read(field.type, data[name], (*path, name))
            for name, field in fields.items()
            if name in data
        }
        missing = any(f.required and found.get(n) is None for n, f in fields.items())
        return None if missing else kind(**found)


def read_experiment(spec: Specification) -> Experiment:
    """Return an experiment, without looking up names, or raise SpecificationError."""
    found = spec.read(Experiment)
    for number, vary in enumerate(found.vary):
        path = ("vary", number)
        if bool(vary.constant) == bool(vary.level):
            spec.problem(path, 'name either a "constant" or a field of the "level" to vary')
        if bool(vary.values) == (vary.range is not None):
            spec.problem(path, 'give either "values" or a "range" [from, to, step]')
        elif vary.range is not None and not _in_range(vary.range):
            spec.problem((*path, "range"), f"a range is [from, to, step], at most {_MOST_VALUES:,}")
        for value in vary.values:
            _check_value(spec, (*path, "values"), value)
    for number, case in enumerate(found.case):
        for key, values in (("constants", case.constants), ("level", case.level)):
            for value in values.values():
                _check_value(spec, ("case", number, key), value)
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


def read_assignment(spec: Specification) -> Assignment:
    """Return an assignment, without looking up names, or raise SpecificationError."""
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
    if not all(map(math.isfinite, bounds)) or step == 0 or (last - first) / step < 0:
        return []
    count = int((last - first) / step + 1e-9) + 1
    found = [float(f"{first + number * step:.12g}") for number in range(min(count, _MOST_VALUES))]
    whole = all(number.is_integer() for number in found)
    return [] if count > _MOST_VALUES else [int(n) if whole else n for n in found]


def _check_value(spec: Specification, path: Path_, value: Any) -> None:
    if not isinstance(value, Scalar):
        spec.problem(path, "a value is a number, a text, true or false")
    elif isinstance(value, float) and not math.isfinite(value):
        spec.problem(path, "a value must be finite")
    elif isinstance(value, str) and (not value.isprintable() or '"' in value):
        spec.problem(path, "a text must be on one line, without double quotes")


def _is_table(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, msgspec.Struct)


def _in_words(path: Path_, message: str) -> str:
    message = message.partition(" - at `")[0].replace("`", "")
    return f'"{".".join(map(str, path))}": {message[:1].lower()}{message[1:]}'


_HEADER = re.compile(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*([\w-]+|"[^"]*"|'[^']*')\s*(?:=|\.)""")


def _lines(text: str) -> list[tuple[Path_, int]]:
    found: list[tuple[Path_, int]] = []
    table: Path_ = ()
    counts: dict[str, int] = {}
    for number, line in enumerate(text.split("\n"), 1):
        if header := _HEADER.match(line):
            name = header[2]
            table = tuple(part.strip(" \"'") for part in name.split("."))
            if header[1] == "[[":
                table = (*table, counts.get(name, 0))
                counts[name] = counts.get(name, 0) + 1
            found.append((table, number))
        elif key := _KEY.match(line):
            found.append(((*table, key[1].strip("\"'")), number))
    return found[::-1]  # of several lines for a path, the first counts
