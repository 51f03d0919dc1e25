"""From the specification of an experiment to programs in levels, with everything put in."""

from __future__ import annotations

import itertools
import json
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
from logical_robots_tui.lab.folder import BUILT_IN, Cell, Manifest, digest
from logical_robots_tui.lab.running import Asked
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
    """The same with the steps of all thoughts of a run, which affect the result; 0 is no limit."""

    run_steps: Annotated[int, Bounds(0)] = 0


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
    limits: RunLimit = RunLimit()


def read_experiment(spec: TomlFile) -> Experiment:
    """Return an experiment, without looking up names; raises TomlFileError if there is none.

    What is wrong with parts of it is reported only.
    """
    found: Experiment | None = spec.value(Experiment, spec.data, ())
    if found is None:
        spec.refuse()
    assert found is not None
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
    return found


def _values_of(vary: Vary) -> list[Scalar]:
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


def plan_sweep(file: Given) -> tuple[Manifest, dict[str, str]]:
    """Return what to run, and levels and programs by digest, or raise TomlFileError."""
    spec = TomlFile(file)
    return _Plan(spec, read_experiment(spec)).manifest()


def level_with_text(name: str, folder: Path) -> tuple[Level, str]:
    """Return a shipped level or one relative to `folder`, and its text, or raise InputError."""
    is_path = Path(name).suffix in SUFFIXES or "/" in name
    level = load_level(folder / name if is_path else name)
    if not Path(level.source).exists():
        hint = "Save it as a file: logical-robots level new"
        raise InputError("a level of a day has no file", place=name, hint=hint)
    return level, read_text(Path(level.source))


def _last_tick(level: Level, ticks: int | str) -> int:
    """Return a run's last tick; raises ValueError for no expression or no reference program."""
    if isinstance(ticks, int):
        return ticks
    found = _TICKS.fullmatch(ticks.strip())
    if not found:
        raise ValueError('"ticks" is a number or like "2*reference+200"')
    reference = reference_for(level)
    if reference is None:
        raise ValueError(f"{level.name} has no reference program; give the number of ticks")
    most = patience_for(10**9)
    return min(int(found[1] or 1) * reference.ticks + int(found[2] or 0), most)


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
"""Where it is said, and the values of constants and of fields of the level."""


class _Plan:
    """Plans an experiment, and reports everything that is wrong with it."""

    def __init__(self, spec: TomlFile, experiment: Experiment) -> None:
        self._spec, self._experiment = spec, experiment
        self._levels: dict[str, tuple[Level, str, int]] = {}
        self._programs: dict[str, str] = {}
        self._inputs: dict[str, str] = {}

    def manifest(self) -> tuple[Manifest, dict[str, str]]:
        table = self._experiment.experiment
        for name in _several(table.level):
            place = ("experiment", "level"), name, ("experiment", "ticks")
            if (found := level_to_run(self._spec, *place, table.ticks)) is not None:
                self._levels[name] = found
        for number, name in enumerate(_several(table.program), 1):
            self._load_program(name, number)
        self._spec.refuse()
        asked = tuple(self._asked())
        combinations = list(self._combinations())
        self._spec.refuse()
        cells = [
            self._cell(level, program, combination)
            for level in self._levels
            for program in self._programs
            for combination in combinations
        ]
        self._spec.refuse()
        measures = tuple(name for name in self._experiment.measure if name in BUILT_IN)
        limits = self._experiment.limits
        manifest = Manifest(
            "sweep",
            table.title or self._spec.file.stem,
            self._spec.text,
            table.starts,
            table.given_first,
            measures or BUILT_IN,
            asked,
            limits.steps,
            limits.seconds,
            tuple(cell for cell in cells if cell is not None),
            run_steps=limits.run_steps,
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
            for found in error.diagnostics:
                self._spec.problem(path, f"{name}:{found.line}:{found.column}: {found.message}")
        else:
            self._programs[name] = text

    def _asked(self) -> list[Asked]:
        """Return the measures that are questions; report programs that can't answer one."""
        asked = []
        for name, measure in self._experiment.measure.items():
            if not isinstance(measure, Query):
                continue
            asked.append(Asked(name, measure.query, measure.every))
            for program, text in self._programs.items():
                try:
                    Program.compile(text).question(measure.query)
                except ProgramError as error:
                    said = "; ".join(found.message for found in error.diagnostics)
                    self._spec.problem(("measure", name), f"{program}: {said}")
        return asked

    def _combinations(self) -> list[_Combination]:
        """Return all combinations of values; report those that can't be put in, one by one."""
        varied = [
            (vary.constant or vary.level, bool(vary.constant), _values_of(vary))
            for vary in self._experiment.vary
        ]
        for number, (name, is_constant, values) in enumerate(varied):
            if (name, is_constant) in [known[:2] for known in varied[:number]]:
                self._spec.problem(("vary", number), f"{name} is varied twice")
            one = {name: values[0]}
            combination = ("vary", number), *((one, {}) if is_constant else ({}, one))
            for level, program in itertools.product(self._levels, self._programs):
                self._cell(level, program, combination)
        found: list[_Combination] = []
        if varied or not self._experiment.case:
            for each in itertools.product(*(values for *_, values in varied)):
                constants: dict[str, Scalar] = {}
                fields: dict[str, Scalar] = {}
                for (name, is_constant, _), value in zip(varied, each, strict=True):
                    (constants if is_constant else fields)[name] = value
                found.append((("vary",), constants, fields))
                if len(found) > _MOST_CELLS:
                    self._spec.problem(("vary",), f"more than {_MOST_CELLS:,} combinations")
                    break
        for number, case in enumerate(self._experiment.case):
            found.append((("case", number), case.constants, case.level))
        return found

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
            for found in error.diagnostics:
                self._spec.problem(path, f"{program_name}: {found.message}. {found.hint}".strip())
            return None
        except InputError as error:
            self._spec.problem(path, str(error))
            return None
        level, text = digest(level_text), digest(program)
        self._inputs |= {level: level_text, text: program}
        return Cell(level, text, level_name, program_name, ticks, {**constants, **fields})


def _several(names: str | list[str]) -> list[str]:
    found = [names] if isinstance(names, str) else [each for each in names if each is not None]
    return list(dict.fromkeys(found))


def _literal(value: Scalar) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else format(Decimal(repr(value)), "f")


@lru_cache(maxsize=1000)
def _with_fields(text: str, fields: tuple[tuple[str, Scalar], ...]) -> str:
    """Return a level's text with other values of some fields, or raise InputError.

    A key looks like ``robots.*.battery.capacity``.
    """
    if is_of_web(text):
        data = json.loads(text)
        for key, value in fields:
            _set(data, key.split("."), key, value)
        return json.dumps(data, indent=2, ensure_ascii=False)
    import tomlkit

    document = tomlkit.parse(text)
    for key, value in fields:
        _set(document, key.split("."), key, value)
    return tomlkit.dumps(document)


def _set(data: Any, keys: list[str], whole: str, value: Scalar) -> None:
    """Set a key in nested data; ``*`` stands for all list items that have the other keys."""
    *path, last = keys
    found = [data]
    for key in path:
        found = [inner for each in found for inner in _inside(each, key)]
    tables = [each for each in found if isinstance(each, dict)]
    if not tables:
        hint = "Only tables that the level has can be varied, such as areas.0 in areas.0.radius."
        raise InputError("the level has no such key", place=whole, hint=hint)
    for table in tables:
        table[last] = value


def _inside(data: Any, key: str) -> list[Any]:
    if isinstance(data, list):
        if key == "*":
            return list(data)
        return data[int(key) : int(key) + 1] if key.isdecimal() else []
    return [data[key]] if isinstance(data, dict) and key in data else []
