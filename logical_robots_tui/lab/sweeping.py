"""From the specification of an experiment to programs in levels, with all values put in."""

from __future__ import annotations

import itertools
import json
import math
import random
import re
from collections.abc import Iterable
from decimal import Decimal
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias

import msgspec

from logical_robots_tui.errors import InputError
from logical_robots_tui.game.measuring import patience_for
from logical_robots_tui.game.source import load_program
from logical_robots_tui.game.victory import reference_for
from logical_robots_tui.lab.folder import BUILT_IN, MEASURES, Cell, Manifest, digest
from logical_robots_tui.lab.tasks import QueryMeasure, Reduction
from logical_robots_tui.mind import Program, ProgramError
from logical_robots_tui.toml_files import Bounds, Given, Path_, TomlFile
from logical_robots_tui.world import Level, load_level
from logical_robots_tui.world.levels.load import SUFFIXES, is_of_web, read_level, read_text

_TICKS = re.compile(r"(?:(\d+)\s*\*\s*)?reference(?:\s*\+\s*(\d+))?")
_MOST_CELLS = 100_000

Scalar: TypeAlias = bool | int | float | str


_MOST_VALUES = 10_000

Positive: TypeAlias = Annotated[int, Bounds(1)]
Starts: TypeAlias = Annotated[int, Bounds(0, 10_000)]
Name: TypeAlias = Annotated[str, Bounds(1)]


class Limit(msgspec.Struct, frozen=True):
    """``[limits]``: steps per think, which affect the result, and seconds per run."""

    steps: Positive = 100_000_000
    seconds: Annotated[float, Bounds(0.001)] = 600.0


class RunLimit(Limit, frozen=True):
    """The same with the steps of all thoughts of a run, which affect the result; 0 means none."""

    run_steps: Annotated[int, Bounds(0)] = 0


class Query(msgspec.Struct, frozen=True):
    """A query in Logica, asked every so many ticks; 0 means in the last tick only."""

    query: Name
    at: Literal["end"] | None = None
    every: Annotated[int, Bounds(0)] = 0
    reduce: Reduction | list[Reduction] = []


class Vary(msgspec.Struct, frozen=True):
    """``[[vary]]``: the values of one constant or one field of the level.

    What is `between` two numbers, both included, is sampled as ``[sample]`` says.
    """

    constant: str = ""
    level: str = ""
    values: list[Scalar] = []
    range: Annotated[list[float], Bounds(2, 3)] | None = None
    between: Annotated[list[int | float], Bounds(2, 2)] | None = None


class SampleTable(msgspec.Struct, frozen=True):
    """``[sample]``: how many values are taken of each range that is sampled."""

    count: Annotated[int, Bounds(1, _MOST_VALUES)]
    seed: int = 1


class Case(msgspec.Struct, frozen=True):
    """``[[case]]``: one combination of constants and fields of the level."""

    constants: dict[str, Scalar] = {}
    level: dict[str, Scalar] = {}


class ExperimentTable(msgspec.Struct, frozen=True):
    level: Name | Annotated[list[Name], Bounds(1)]
    program: Name | Annotated[list[Name], Bounds(1)]
    title: str = ""
    starts: Starts | Annotated[list[Annotated[int, Bounds(1, 10**9)]], Bounds(2, 2)] = 0
    ticks: Positive | Name = "2*reference+200"
    given_first: bool = False
    until: str = ""

    @property
    def span(self) -> tuple[int, int]:
        """The first and the last varied start."""
        return (
            (1, self.starts) if isinstance(self.starts, int) else (self.starts[0], self.starts[1])
        )


class Experiment(msgspec.Struct, frozen=True):
    experiment: ExperimentTable
    vary: list[Vary] = []
    case: list[Case] = []
    sample: SampleTable | None = None
    measure: dict[str, Literal["end"] | Query] = {}
    limits: RunLimit = RunLimit()


def read_experiment(spec: TomlFile) -> Experiment:
    """Return an experiment, without looking up names; raises TomlFileError if there is none.

    What is wrong with parts of it is reported only.
    """
    draft = spec.draft(Experiment)
    for number, vary in enumerate(draft.vary):
        path: Path_ = ("vary", number)
        if spec.is_wrong(path):
            continue
        if bool(vary.constant) == bool(vary.level):
            spec.problem(path, 'Name either a "constant" or a field of the "level" to vary')
        sources = (vary.values or None, vary.range, vary.between)
        if sum(source is not None for source in sources) != 1:
            message = 'Give "values", a "range" [from, to, step], or "between" [from, to]'
            spec.problem(path, message)
        elif vary.between is not None:
            first, last = vary.between
            if not -math.inf < first <= last < math.inf:
                spec.problem((*path, "between"), "It is between [from, to], the smaller one first")
            if "sample" not in spec.data:
                message = "Say how many values to sample: [sample] count = 20"
                spec.problem((*path, "between"), message)
        elif vary.range is not None and not _range_numbers(vary.range):
            spec.problem((*path, "range"), f"A range is [from, to, step], at most {_MOST_VALUES:,}")
        _check_texts(spec, (*path, "values"), vary.values)
    for number, case in enumerate(draft.case):
        _check_texts(spec, ("case", number, "constants"), case.constants.values())
        _check_texts(spec, ("case", number, "level"), case.level.values())
    if draft.sample and not any(vary.between for vary in draft.vary):
        spec.problem(("sample",), '[sample] needs a [[vary]] with "between"')
    first, last = draft.experiment.span if not spec.is_wrong(("experiment", "starts")) else (1, 1)
    if not -1 <= last - first < _MOST_VALUES:
        message = f"Varied starts are [from, to], at most {_MOST_VALUES:,}"
        spec.problem(("experiment", "starts"), message)
    for name, measure in draft.measure.items():
        path = ("measure", name)
        if spec.is_wrong(path):
            continue
        if name in _COLUMNS:
            spec.problem(path, f'A column of the tables is called "{name}": take another name')
        if isinstance(measure, Query) and bool(measure.at) and measure.every:
            spec.problem(path, 'It is measured either at = "end" or every so many ticks')
        if isinstance(measure, Query) and measure.reduce and not measure.every:
            spec.problem(path, '"reduce" needs "every"')
        if (measure == "end") != (name in _AT_END):
            spec.problem(
                path,
                f'"{name}" is measured at the "end"'
                if name in _AT_END
                else f'Write {name} = {{query = "...", every = 10}}; measured without a query are '
                + ", ".join(_AT_END),
            )
    return draft


_AT_END = tuple(name for name in MEASURES if name != "rules")

_COLUMNS = {
    *("run", "level", "program", "start", "outcome", "last_tick", "notices", "first_notice"),
    *("engine", "replay", "measure", "tick", "row", "column", "number", "text", "until"),
}


def draw_samples(
    sample: SampleTable, ranges: dict[_Parameter, list[int | float]]
) -> list[dict[_Parameter, Scalar]]:
    """Return values of each range by its key, together `sample.count` times, always the same.

    Between whole numbers are whole numbers.
    """
    chance, count = random.Random(sample.seed), sample.count  # noqa: S311 - not for security
    columns: list[list[Scalar]] = []
    for low, high in ranges.values():
        shares = [chance.random() for _ in range(count)]
        if isinstance(low, int) and isinstance(high, int):
            columns.append([low + int(share * (high - low + 1)) for share in shares])
        else:
            columns.append([float(f"{low + share * (high - low):.12g}") for share in shares])
    return [dict(zip(ranges, values, strict=True)) for values in zip(*columns, strict=True)]


def _range_numbers(bounds: list[float]) -> list[Scalar]:
    """Return the numbers of a range by step; [] if there are infinitely or too many."""
    first, last, step = (*bounds, 1.0)[:3]
    steps = (last - first) / step if step else -1.0
    if not 0 <= steps < _MOST_VALUES:
        return []
    numbers = [float(f"{first + number * step:.12g}") for number in range(int(steps + 1e-9) + 1)]
    whole = all(number.is_integer() for number in numbers)
    return [int(n) if whole else n for n in numbers]


def _check_texts(spec: TomlFile, path: Path_, values: Iterable[Scalar]) -> None:
    texts = [value for value in values if isinstance(value, str)]
    if not all(text.isprintable() and '"' not in text for text in texts):
        spec.problem(path, "A string must be on one line, without double quotes")


def plan_sweep(file: Given) -> tuple[Manifest, dict[str, str]]:
    """Return what to run, and levels and programs by digest, or raise TomlFileError."""
    spec = TomlFile(file)
    return _Plan(spec, read_experiment(spec)).manifest()


def level_with_text(name: str, folder: Path) -> tuple[Level, str]:
    """Return a shipped level or one relative to `folder`, and its text, or raise InputError."""
    is_path = Path(name).suffix in SUFFIXES or "/" in name
    level = load_level(folder / name if is_path else name)
    if not Path(level.source).exists():
        hint = f"Make one: logical-robots level new {name}.toml --copy {name}"
        raise InputError("A labyrinth of the day has no file", place=name, hint=hint)
    return level, read_text(Path(level.source))


def _last_tick(level: Level, ticks: int | str) -> int:
    """Return a run's last tick; raises ValueError for no expression or no reference program."""
    if isinstance(ticks, int):
        return ticks
    match = _TICKS.fullmatch(ticks.strip())
    if not match:
        raise ValueError('"ticks" is a number or like "2*reference+200"')
    reference = reference_for(level)
    if reference is None:
        raise ValueError(
            f"{level.name} has no reference program; give a number, such as ticks = 2000"
        )
    limit = patience_for(10**9)
    return min(int(match[1] or 1) * reference.ticks + int(match[2] or 0), limit)


def level_to_run(
    spec: TomlFile, path: Path_, name: str, ticks_path: Path_, ticks: int | str
) -> tuple[Level, str, int] | None:
    """Return a level, its text and the run's last tick; None after reporting a problem."""
    try:
        level, text = level_with_text(name, spec.folder)
    except InputError as error:
        spec.problem(path, str(error))
        return None
    try:
        return level, text, _last_tick(level, ticks)
    except ValueError as error:
        spec.problem(ticks_path, str(error))
        return None


_Combination: TypeAlias = tuple[Path_, dict[str, Scalar], dict[str, Scalar]]
"""The place in the specification, and the values of constants and of fields of the level."""


_Parameter: TypeAlias = tuple[str, bool]
"""The name of what is varied, and whether it is a constant."""


def _combination(path: Path_, values: dict[_Parameter, Scalar]) -> _Combination:
    constants = {name: value for (name, is_constant), value in values.items() if is_constant}
    fields = {name: value for (name, is_constant), value in values.items() if not is_constant}
    return path, constants, fields


class _Plan:
    """Plans an experiment, and reports everything that is wrong with it."""

    def __init__(self, spec: TomlFile, experiment: Experiment) -> None:
        self._spec, self._experiment = spec, experiment
        self._levels: dict[str, tuple[Level, str, int]] = {}
        self._programs: dict[str, str] = {}
        self._inputs: dict[str, str] = {}

    def manifest(self) -> tuple[Manifest, dict[str, str]]:
        table = self._experiment.experiment
        for name in _unique_names(table.level):
            place = ("experiment", "level"), name, ("experiment", "ticks")
            if (level_run := level_to_run(self._spec, *place, table.ticks)) is not None:
                self._levels[name] = level_run
        for number, name in enumerate(_unique_names(table.program), 1):
            self._load_program(name, number)
        self._spec.refuse()
        query_measures = tuple(self._query_measures())
        combinations = list(self._combinations())
        self._spec.refuse()
        cells = [
            self._cell(level, program, combination)
            for level in self._levels
            for program in self._programs
            for combination in combinations
        ]
        self._spec.refuse()
        first, last = table.span
        measures = tuple(name for name in self._experiment.measure if name in _AT_END)
        limits = self._experiment.limits
        manifest = Manifest(
            "sweep",
            table.title or self._spec.file.stem,
            self._spec.text,
            last - first + 1,
            table.given_first,
            measures or BUILT_IN,
            query_measures,
            limits.steps,
            limits.seconds,
            tuple(cell for cell in cells if cell is not None),
            run_steps=limits.run_steps,
            first_start=first,
            until=table.until,
        )
        return manifest, self._inputs

    def _load_program(self, name: str, number: int) -> None:
        path: Path_ = ("experiment", "program")
        try:
            if ";" in name or "\n" in name:
                name, text = f"program {number}", name
            else:
                file = self._spec.folder / name
                text = load_program(file if file.is_file() else name).text
            Program.compile(text)
        except InputError as error:
            self._spec.problem(path, str(error))
        except ProgramError as error:
            for d in error.diagnostics:
                self._spec.problem(path, f"{name}:{d.line}:{d.column}: {d.message}")
        else:
            self._programs[name] = text

    def _query_measures(self) -> list[QueryMeasure]:
        """Return the measures that are questions; report programs that can't answer one."""
        measures = []
        if until := self._experiment.experiment.until:
            self._check_question(("experiment", "until"), until)
        for name, measure in self._experiment.measure.items():
            if isinstance(measure, Query):
                kinds = [measure.reduce] if isinstance(measure.reduce, str) else measure.reduce
                reduction = tuple(dict.fromkeys(kinds))
                measures.append(QueryMeasure(name, measure.query, measure.every, reduction))
                self._check_question(("measure", name), measure.query)
        return measures

    def _check_question(self, path: Path_, query: str) -> None:
        for program, text in self._programs.items():
            try:
                Program.compile(text).question(query)
            except ProgramError as error:
                messages = "; ".join(d.message for d in error.diagnostics)
                self._spec.problem(path, f"{program}: {messages}")

    def _combinations(self) -> list[_Combination]:
        """Return all combinations of values; report those that can't be put in, one by one."""
        varied: dict[_Parameter, list[Scalar]] = {}
        ranges: dict[_Parameter, list[int | float]] = {}
        for number, vary in enumerate(self._experiment.vary):
            key = vary.constant or vary.level, bool(vary.constant)
            values = _range_numbers(vary.range) if vary.range is not None else vary.values
            if vary.between is not None:
                ranges[key], values = vary.between, [vary.between[0]]
            if key in varied:
                self._spec.problem(("vary", number), f"{key[0]} is varied twice")
            varied[key] = values
            for level, program in itertools.product(self._levels, self._programs):
                self._cell(level, program, _combination(("vary", number), {key: values[0]}))
        combinations: list[_Combination] = []
        sample = self._experiment.sample
        samples = draw_samples(sample, ranges) if sample and ranges else [{}]
        if varied or not self._experiment.case:
            for choice, point in itertools.product(itertools.product(*varied.values()), samples):
                grid = dict(zip(varied, choice, strict=True))
                combinations.append(_combination(("vary",), grid | point))
                if len(combinations) > _MOST_CELLS:
                    self._spec.problem(("vary",), f"More than {_MOST_CELLS:,} combinations")
                    break
        for number, case in enumerate(self._experiment.case):
            combinations.append((("case", number), case.constants, case.level))
        return combinations

    def _cell(self, level_name: str, program_name: str, combination: _Combination) -> Cell | None:
        path, constants, fields = combination
        _, level_text, ticks = self._levels[level_name]
        program = self._programs[program_name]
        try:
            if constants:
                values = {name: _literal(value) for name, value in constants.items()}
                program = Program.with_constants(program, values)
            level_text = _with_fields(level_text, tuple(fields.items())) if fields else level_text
            if fields and digest(level_text) not in self._inputs:
                read_level(level_text, level_name)
        except ProgramError as error:
            for d in error.diagnostics:
                self._spec.problem(path, f"{program_name}: {d.message}. {d.hint}".strip())
            return None
        except InputError as error:
            self._spec.problem(path, str(error))
            return None
        level, text = digest(level_text), digest(program)
        self._inputs |= {level: level_text, text: program}
        return Cell(level, text, level_name, program_name, ticks, {**constants, **fields})


def _unique_names(names: str | list[str]) -> list[str]:
    candidates = [names] if isinstance(names, str) else [name for name in names if name is not None]
    return list(dict.fromkeys(candidates))


def _literal(value: Scalar) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else format(Decimal(repr(value)), "f")


@lru_cache(maxsize=1000)
def _with_fields(text: str, fields: tuple[tuple[str, Scalar], ...]) -> str:
    """Return a level's text with other values of some fields, or raise InputError.

    A key looks like ``robots.*.battery.capacity``.
    """
    has_sensors = any(key.startswith("sensors.") for key, _ in fields)
    if is_of_web(text):
        tree = json.loads(text) | ({"sensors": {}} if has_sensors else {})
        for key, value in fields:
            _set(tree, key.split("."), key, value)
        return json.dumps(tree, indent=2, ensure_ascii=False)
    import tomlkit

    document = tomlkit.parse(text)
    if has_sensors and "sensors" not in document:
        document["sensors"] = tomlkit.inline_table()
    for key, value in fields:
        _set(document, key.split("."), key, value)
    return tomlkit.dumps(document)


def _set(tree: Any, keys: list[str], whole: str, value: Scalar) -> None:
    """Set a key in nested data; ``*`` stands for all list items that have the other keys."""
    *path, last = keys
    nodes = [tree]
    for key in path:
        nodes = [inner for node in nodes for inner in _children(node, key)]
    tables = [node for node in nodes if isinstance(node, dict)]
    if not tables:
        hint = "Only tables that the level has can be varied, such as areas.0 in areas.0.radius."
        raise InputError("The level has no such key", place=whole, hint=hint)
    for table in tables:
        if isinstance(table.get(last), list) and type(value) is int:
            _truncate(tree, table, last, whole, value)
        else:
            table[last] = value


def _truncate(tree: Any, table: Any, key: str, whole: str, count: int) -> None:
    """Keep the first ones of a list, such as the robots, and goals for those only."""
    items = table[key]
    if not 0 <= count <= len(items):
        raise InputError(f"The level has {len(items)}, so there can't be {count}", place=whole)
    removed_names = {item.get("name") for item in items[count:] if isinstance(item, dict)}
    del items[count:]
    for area in tree.get("areas", []) if key == "robots" else ():
        for goal in {"goal_for", "victory_robots"} & area.keys():
            area[goal] = [name for name in area[goal] if name not in removed_names]


def _children(node: Any, key: str) -> list[Any]:
    if isinstance(node, list):
        if key == "*":
            return list(node)
        return node[int(key) : int(key) + 1] if key.isdecimal() else []
    return [node[key]] if isinstance(node, dict) and key in node else []
