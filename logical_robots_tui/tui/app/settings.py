"""The player's settings, from a TOML file."""

from __future__ import annotations

import json
import re
import tomllib
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from platformdirs import user_config_path

from logical_robots_tui.paths import did_you_mean, read_ordinary
from logical_robots_tui.tui.commands.command import Command, key_name
from logical_robots_tui.tui.commands.keymap import key_from
from logical_robots_tui.tui.commands.table import COMMANDS
from logical_robots_tui.tui.labyrinth.drawing.glyphs import Drawing
from logical_robots_tui.tui.theme.themes import NIGHT, THEMES
from logical_robots_tui.world.levels.fields import excess_of_toml

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from typing import TypeAlias

    Complain: TypeAlias = Callable[[str, str], None]

_MOST_FRAMES = 60
_LONGEST = 100_000  # bytes of the file
_ONLY_EDITING = ("enter", "tab", "shift+tab", "delete", "backspace")
"""Keys that only commands of the level editor can have, by their printed names."""

_CHANGEABLE = {entry.id: entry for entry in COMMANDS if entry.scope != "text"}
"""The commands whose keys can be changed."""


class Settings(NamedTuple):
    """Settings from the configuration file, with defaults; None is the terminal's default.

    `complaints` are errors in the file, each with its place; `frames` is pictures per second.
    """

    theme: str = ""
    drawing: Drawing | None = None
    frames: int = 30
    cones: bool = True
    trails: bool = True
    completion: bool = True
    wrap: bool = True
    drag_robots: bool = True
    keys: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    complaints: tuple[str, ...] = ()


def settings_path() -> Path:
    return user_config_path("logical-robots", appauthor=False) / "config.toml"


def read_settings(path: Path) -> Settings:
    """Return a file's settings, or defaults if it is missing; errors become complaints."""
    try:
        text = read_ordinary(path, _LONGEST + 1).decode("utf-8-sig")
        if len(text) > _LONGEST or excess_of_toml(text):
            raise ValueError("it is too large")
        found = tomllib.loads(text)
    except FileNotFoundError:
        return Settings()
    except (OSError, ValueError, RecursionError) as error:
        said = _refusal(error)
        return Settings(complaints=(f"{path}: {said}. The file is ignored.",))
    complaints: list[str] = []

    def complain(name: str, said: str) -> None:
        complaints.append(f"{path}{_line_of(name, text)}: {said}{'' if said[-1] in '.?' else '.'}")

    return _settings(found, complain)._replace(complaints=tuple(complaints))


def _refusal(error: Exception) -> str:
    if isinstance(error, OSError):
        return error.strerror or str(error)
    if isinstance(error, UnicodeDecodeError):
        return "it is not UTF-8 text"
    return "it is nested too deeply" if isinstance(error, RecursionError) else str(error)


def _settings(found: dict[str, Any], complain: Complain) -> Settings:
    readers: dict[str, Callable[[Any], Any]] = {
        "theme": lambda value: _one_of(value, THEMES),
        "drawing": lambda value: Drawing(_one_of(value, [way.value for way in Drawing])),
        "frames": _frames,
        **dict.fromkeys(("cones", "trails", "completion", "wrap", "drag_robots"), _truth),
        "keys": lambda value: _keys(value, complain),
    }
    taken: dict[str, Any] = {}
    for name, value in found.items():
        if name not in readers:
            hint = did_you_mean(name, readers) or f"There are {', '.join(readers)}."
            complain(name, f'there is no setting "{name}". {hint}')
            continue
        try:
            taken[name] = readers[name](value)
        except ValueError as error:
            complain(name, f"{name}: {error}")
    return Settings(**taken)


def _one_of(value: object, known: Sequence[str]) -> str:
    if value not in known:
        hint = did_you_mean(str(value), known) or f"There are {', '.join(known)}"
        raise ValueError(f"{value!r} is not known. {hint}")
    return str(value)


def _frames(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= _MOST_FRAMES:
        raise ValueError(f"{value!r} is not an integer from 1 to {_MOST_FRAMES}")
    return value


def _truth(value: object) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{value!r} is neither true nor false")
    return value


def _keys(found: object, complain: Complain) -> dict[str, tuple[str, ...]]:
    """Return the keys in the file; a key may have one command, and one in the level editor."""
    if not isinstance(found, dict):
        raise ValueError("this must be a table, [keys]")
    owners: dict[tuple[str, str], str] = {
        (entry.scope, key): entry.id
        for entry in _CHANGEABLE.values()
        if entry.id not in found
        for key in entry.keys
    }
    chosen: dict[str, tuple[str, ...]] = {}
    for name, value in found.items():
        if name not in _CHANGEABLE:
            hint = did_you_mean(name, _CHANGEABLE) or "logical-robots config lists all."
            complain(f"keys.{name}", f'keys: there is no command "{name}". {hint}')
            continue
        keys = []
        for text in value if isinstance(value, list) else [value]:
            try:
                keys.append(_take(text, _CHANGEABLE[name], owners))
            except ValueError as error:
                complain(f"keys.{name}", f"keys.{name}: {error}")
        if keys or value == []:
            chosen[name] = tuple(keys)
    for name in found.keys() & _CHANGEABLE.keys() - chosen.keys():
        entry = _CHANGEABLE[name]
        chosen[name] = tuple(key for key in entry.keys if (entry.scope, key) not in owners)
    return chosen


def _take(text: object, entry: Command, owners: dict[tuple[str, str], str]) -> str:
    is_free = entry.scope == "level" and isinstance(text, str) and text in _ONLY_EDITING
    key = str(text) if is_free else key_from(text)
    other = owners.setdefault((entry.scope, key), entry.id)
    if other != entry.id:
        raise ValueError(
            f"{key_name(key)} is the key of {other}. Give that another key, or none: {other} = []"
        )
    return key


def _line_of(name: str, text: str) -> str:
    """Return the line of a name such as ``keys.run`` in a file, as ``:3``; "" if unknown."""
    table, _, last = name.rpartition(".")
    lines = text.splitlines()
    begins = re.compile(rf"""\s*["']?{re.escape(last)}["']?\s*[=.]""")
    heads = (number for number, line in enumerate(lines) if line.strip() == f"[{table}]")
    first = next(heads, 0)
    numbers = (n for n, line in enumerate(lines[first:], start=first + 1) if begins.match(line))
    return next((f":{number}" for number in numbers), "")


def as_toml(settings: Settings) -> str:
    examples = {"theme": NIGHT.name, "drawing": "quadrants"}
    values = settings._asdict() | {"drawing": settings.drawing and settings.drawing.value}
    del values["keys"], values["complaints"]
    lines = [_set(name, value, examples.get(name, "")) for name, value in values.items()]
    lines += ["", "[keys]"]
    for entry in _CHANGEABLE.values():
        keys = settings.keys.get(entry.id, entry.keys)
        lines.append(f"{_set(entry.id, [key_name(key) for key in keys]):<40}  # {entry.title}")
    return "\n".join(lines)


def _set(name: str, value: object, example: str = "") -> str:
    if not value and example:
        return f"# {_set(name, example)}"
    return f"{name} = {json.dumps(value, ensure_ascii=False)}"
