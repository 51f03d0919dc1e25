"""TOML files that people write: read within bounds, and checked as a whole, with lines."""

from __future__ import annotations

import json
import re
import sys
import tomllib
from collections.abc import Iterable, Mapping
from datetime import datetime
from inspect import Parameter, signature
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    NamedTuple,
    TypeAlias,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from logical_robots_tui.errors import InputError, LogicalRobotsError
from logical_robots_tui.paths import did_you_mean, read_text
from logical_robots_tui.wording import clip

Path_: TypeAlias = tuple[str | int, ...]
"""Where a value is: keys, and indices of lists."""

Given: TypeAlias = Path | str | Mapping[str, Any]
"""A file, or the content of one, in which names are relative to the working folder."""

T = TypeVar("T")

_MOST_BYTES = 1_000_000
_MOST_SHOWN = 60  # characters of a wrong value
_MOST_PROBLEMS = 100
_MAX_NUMBER = sys.float_info.max


class TomlFileError(LogicalRobotsError):
    """All problems of a file, in the order of the text, each with file and line."""

    title = "This file can't be used"

    def __init__(self, problems: tuple[str, ...]) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a text; the `place` of the InputError is like ``line 2, column 8``, or ""."""
    if excess := _excess(text):
        raise InputError(f"The file has {excess}")
    place = ""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message, separator, position = str(error).rpartition(" (at ")
        message, place = (message, position.removesuffix(")")) if separator else (position, "")
    except RecursionError:
        message = "it is nested too deeply"
    except ValueError:  # a number with thousands of digits, or a date that doesn't exist
        message = "a number or date in it is out of range"
    raise InputError(f"This is not valid TOML: {message}", place=place)


class Bounds(NamedTuple):
    """The bounds of a number, or of the length of a text or a list; in its type's annotation."""

    minimum: float = -_MAX_NUMBER
    maximum: float = _MAX_NUMBER


class Kind(NamedTuple):
    """A type that a value may have; `inner` is that of its items, or the class of a table."""

    base: type
    inner: Any = None
    choices: tuple[str, ...] = ()
    bounds: Bounds = Bounds()

    @classmethod
    def all_of(cls, hint: Any) -> list[Kind]:
        """Return what a type hint allows, except None, which TOML does not have."""
        origin, inner = get_origin(hint), get_args(hint)
        if origin in (Union, UnionType):
            return [kind for hint in inner if hint is not NoneType for kind in cls.all_of(hint)]
        if origin is Annotated:
            bounds = next((part for part in inner if isinstance(part, Bounds)), Bounds())
            return [kind._replace(bounds=bounds) for kind in cls.all_of(inner[0])]
        if origin is Literal:
            return [cls(str, choices=inner)]
        return [cls(hint) if hint in _WORDS else cls(origin or dict, inner[-1] if inner else hint)]

    def allows(self, value: Any) -> bool:
        value_type: type = type(value)
        if value_type is not self.base and (value_type, self.base) != (int, float):
            return False
        if self.base is datetime:
            return value.tzinfo is not None
        size = len(value) if self.base in (str, list, dict) else value
        minimum, maximum = self.bounds
        return minimum <= size <= maximum and value in (self.choices or [value])

    def __str__(self) -> str:
        """Return the type in words, as an object of "must be"."""
        if self.choices:
            return " or ".join(f'"{choice}"' for choice in self.choices)
        minimum, maximum = self.bounds
        span = f"from {minimum:,} to {maximum:,}"
        if maximum == _MAX_NUMBER:
            span = f"of {minimum:,} or more"
        is_bound = self.bounds != Bounds()
        return _WORDS[self.base] + (f" {span}{_UNITS.get(self.base, '')}" if is_bound else "")


_WORDS: dict[Any, str] = {
    bool: "true or false",
    int: "an integer",
    float: "a number",
    str: "text",
    datetime: "a date and time with a zone, such as 2026-01-31T23:59:00Z",
    list: "a list",
    dict: "a table",
}
_UNITS: dict[Any, str] = {str: " characters", list: " items"}


class TomlFile:
    """A file and its problems; raises TomlFileError if it can't be read or is not TOML."""

    def __init__(self, source: Given) -> None:
        self._is_file = not isinstance(source, Mapping)
        file = Path("untitled") if isinstance(source, Mapping) else Path(source)
        self.file, self.folder = file, file.parent
        self._problems: set[tuple[int, str]] = set()
        self._other_problems: list[str] = []
        self._wrong_paths: set[Path_] = set()
        if isinstance(source, Mapping):
            import tomlkit

            self.data = _plain(source)
            self.text = tomlkit.dumps(self.data)
            self._lines = dict(_lines(self.text))
            return
        try:
            self.text = read_text(file, _MOST_BYTES)
            self.data = parse_toml(self.text)
        except OSError as error:
            message = f"{file}: This can't be read: {error.strerror or error}"
            raise TomlFileError((message,)) from error
        except InputError as error:
            number = re.search(r"\d+", error.place)
            last_line = self.text.count("\n") + 1
            line = f":{number[0] if number else last_line}" if error.place else ""
            raise TomlFileError((f"{file}{line}: {error.message}",)) from error
        self._lines = dict(_lines(self.text))

    @property
    def problems(self) -> tuple[str, ...]:
        located = sorted(self._problems)
        lines = (
            f"{self.file}:{line}: {message}" if self._is_file else message
            for line, message in located
        )
        return (*lines, *self._other_problems)

    def problem(self, path: Path_, message: str) -> None:
        sentence = _sentence(message)
        self._wrong_paths.update(path[:length] for length in range(len(path) + 1))
        if not self._is_file and (name := _name(path)) not in sentence:
            sentence = f"{name}: {sentence}"
        while path and path not in self._lines:
            path = path[:-1]
        self._problems.add((self._lines.get(path, 1), sentence))
        self._refuse_if_many()

    def problem_in(self, name: str, line: int, message: str) -> None:
        """Report a problem of another file, which this one names."""
        self._other_problems.append(f"{self.folder / name}:{line}: {_sentence(message)}")
        self._refuse_if_many()

    def _refuse_if_many(self) -> None:
        if len(self._problems) + len(self._other_problems) >= _MOST_PROBLEMS:
            remark = f"{self.file}: There may be more problems. Correct these first."
            raise TomlFileError((*self.problems, remark))

    def is_wrong(self, path: Path_) -> bool:
        """Return whether there is a problem with a value or a part of it."""
        return path in self._wrong_paths

    def refuse(self) -> None:
        """Raise TomlFileError if something is wrong."""
        if self.problems:
            raise TomlFileError(self.problems)

    def draft(self, kind: type[T]) -> T:
        """Return the whole file as a record, with defaults in place of wrong values.

        Raises TomlFileError if a required value is wrong.
        """
        record = self.value(kind, self.data, ())
        if record is None:
            self.refuse()
        assert isinstance(record, kind)
        return record

    def table(
        self, hints: Mapping[str, Any], table: Mapping[str, Any], path: Path_ = ()
    ) -> dict[str, Any]:
        """Return the values of the known keys, by type hints, without those that are wrong."""
        for key in (key for key in table if key not in hints):
            hint = did_you_mean(key, hints) or f"Known keys: {', '.join(hints)}."
            self.problem((*path, key), f'"{clip(key, _MOST_SHOWN)}" is not a known key. {hint}')
        names = hints.keys() & table.keys()
        values = {name: self.value(hints[name], table[name], (*path, name)) for name in names}
        return {name: value for name, value in values.items() if value is not None}

    def value(self, hint: Any, value: Any, path: Path_) -> Any:
        """Convert a value to a type, or return None; report problems in all its parts."""
        kinds = Kind.all_of(hint)
        kind = next((kind for kind in kinds if kind.allows(value)), None)
        if kind is None:
            choices = [choice for k in kinds for choice in k.choices]
            suggestion = did_you_mean(value, choices) if isinstance(value, str) else ""
            verb = "can't be" if suggestion else f"must be {' or '.join(map(str, kinds))}, not"
            self.problem(path, f'"{_name(path)}" {verb} {_display(value)}. {suggestion}'.strip())
            return None
        if kind.base not in (list, dict) or kind.inner is Any:
            return float(value) if kind.base is float else value
        if kind.base is list:
            return [self.value(kind.inner, item, (*path, i)) for i, item in enumerate(value)]
        if not isinstance(kind.inner, type):
            return {key: self.value(kind.inner, item, (*path, key)) for key, item in value.items()}
        return self._record(kind.inner, value, path)

    def _record(self, kind: type, table: Mapping[str, Any], path: Path_) -> Any:
        values = self.table(get_type_hints(kind, include_extras=True), table, path)
        parameters = signature(kind).parameters.values()
        required = {p.name for p in parameters if p.default is Parameter.empty}
        for name in required - table.keys():
            self.problem(path, f'"{_name((*path, name))}" is missing')
        return kind(**values) if required <= values.keys() else None


def _plain(value: Any) -> Any:
    """Convert a value for TOML: paths become texts, arrays and ranges lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items() if item is not None}
    if hasattr(value, "tolist"):  # of numpy
        return value.tolist()
    if isinstance(value, Iterable) and not isinstance(value, str | Path):
        return [_plain(item) for item in value]
    return value if isinstance(value, bool | int | float | str | datetime) else str(value)


def _sentence(message: str) -> str:
    return message if message[-1] in ".?" else f"{message}."


def _name(path: Path_) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)[1:]


def _display(value: object) -> str:
    if isinstance(value, list | dict):
        return _WORDS[type(value)]
    if isinstance(value, int) and abs(value) > _MAX_NUMBER:
        return "so large a number"
    return clip(json.dumps(value, ensure_ascii=False, default=str), _MOST_SHOWN)


_HEADER = re.compile(r"\s*+(\[\[?+)([^\[\]]++)\]\]?+\s*+(?:#.*)?$")
_KEY = re.compile(r"""\s*+([\w-]++|"[^"]*+"|'[^']*+')\s*+[=.]""")


def _lines(text: str) -> list[tuple[Path_, int]]:
    """Return the line of each table and key, the last first: of several, the first counts."""
    lines: list[tuple[Path_, int]] = []
    table: Path_ = ()
    counts: dict[str, int] = {}
    for number, line in enumerate(text.split("\n"), 1):
        if header := _HEADER.match(line):
            name = header[2].strip()
            table = tuple(part.strip(" \"'") for part in name.split("."))
            if header[1] == "[[":
                table = (*table, counts.get(name, 0))
                counts[name] = counts.get(name, 0) + 1
            lines.append((table, number))
        elif key := _KEY.match(line):
            lines.append(((*table, key[1].strip("\"'")), number))
    return lines[::-1]


_MOST_BESIDES = 4_000_000  # characters outside long literal strings such as a drawing
_MOST_STRINGS = 600_000  # and comments
_MOST_OF_TOML = {"=": 60_000, "[": 60_000, "{": 30_000, ",": 300_000, "\n": 300_000, '"': 300_000}

_STRING = re.compile(
    r"'{3}(?:[^']++|'(?!''))*+(?:'{3})?"
    r'|"{3}(?:[^"\\]++|\\.|"(?!""))*+(?:"{3})?'
    r"|'[^'\n]*+'?"
    r'|"(?:[^"\\\n]++|\\[^\n])*+"?'
    r"|#[^\n]*+",
    re.DOTALL,
)
_KEYS = re.compile(r"""(?<![\w"'-])(?:(?:[\w-]++|""|'')[ \t]*+\.[ \t]*+){10}""")
_NUMBER = re.compile(r"(?<![\w-])[\d_]{10000}")


def _excess(text: str) -> str:
    """Return what a text has too much of, as an object of "The file has", or ""."""
    drawing_length = 0

    def empty(match: re.Match[str]) -> str:
        nonlocal drawing_length
        if text.startswith("'''", match.start()):
            drawing_length += match.end() - match.start()
        return "''"

    without_strings, strings = _STRING.subn(empty, text, _MOST_STRINGS)
    if len(text) - drawing_length > _MOST_BESIDES:
        return f"more than {_MOST_BESIDES:,} characters besides its drawing"
    if strings == _MOST_STRINGS:
        return "too many strings"
    if excess := too_many(without_strings, _MOST_OF_TOML):
        return excess
    if _KEYS.search(without_strings):
        return "a key of more than 10 parts"
    return "a number of more than 10,000 digits" if _NUMBER.search(without_strings) else ""


def too_many(text: str, limits: dict[str, int]) -> str:
    for character, number in limits.items():
        if text.count(character) > number:
            noun = "lines" if character == "\n" else f"of the character {character}"
            return f"more than {number:,} {noun}"
    return ""
