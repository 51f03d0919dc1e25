"""The player's settings: one row for each, read from a TOML file."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias, get_origin, get_type_hints

from platformdirs import user_config_path

from logical_robots_tui.errors import InputError
from logical_robots_tui.paths import read_text, write_atomically
from logical_robots_tui.toml_files import Bounds, Kind, TomlFile, TomlFileError, parse_toml

Keys: TypeAlias = Mapping[str, tuple[str, ...]]  # by the names of commands
Complain: TypeAlias = Callable[[str, str], None]  # takes a name in [keys], and what is wrong

Theme: TypeAlias = Literal[
    "night", "textual-dark", "textual-light", "nord", "gruvbox", "catppuccin-mocha", "dracula",
    "tokyo-night", "monokai", "flexoki", "catppuccin-latte", "catppuccin-frappe",
    "catppuccin-macchiato", "solarized-light", "solarized-dark", "rose-pine", "rose-pine-moon",
    "rose-pine-dawn", "atom-one-dark", "atom-one-light", "ansi-dark", "ansi-light",
]  # fmt: skip
_MOST_BYTES = 1_000_000
DrawingStyle: TypeAlias = Literal["quadrants", "halves", "sextants", "ascii"]


class Settings(NamedTuple):
    """What a player can set: type and sentence, then the default; None lets the game choose.

    `keys` are the keys that are not as usual. `complaints` are errors in the file, with places.
    """

    theme: Annotated[Theme | None, "Colours; by default those last chosen in the game."] = None
    drawing: Annotated[
        DrawingStyle | None, "How the map is drawn; chosen for your terminal by default."
    ] = None
    frames: Annotated[int, Bounds(1, 60), "Maximum frames per second."] = 30
    cones: Annotated[bool, "Show what the robots' radars reach."] = True
    trails: Annotated[bool, "Show where the robots came from."] = True
    completion: Annotated[bool, "List words after a dot or a capital letter, unasked."] = True
    wrap: Annotated[bool, "Wrap long lines of the program instead of cutting them."] = True
    drag_robots: Annotated[bool, "Let the mouse drag robots; else it drags the map."] = True
    keys: Keys = MappingProxyType({})
    complaints: tuple[str, ...] = ()


class Setting(NamedTuple):
    """A row of the settings; `hint` is the type of its values, with bounds."""

    name: str
    hint: Any
    default: Any
    sentence: str

    @property
    def kind(self) -> Kind:
        return Kind.all_of(self.hint)[0]


def rows() -> list[Setting]:
    return [
        Setting(name, hint, Settings._field_defaults[name], hint.__metadata__[-1])
        for name, hint in get_type_hints(Settings, include_extras=True).items()
        if get_origin(hint) is Annotated
    ]


def settings_path() -> Path:
    return user_config_path("logical-robots", appauthor=False) / "config.toml"


def read_settings(path: Path, read_keys: Callable[[Mapping[str, Any], Complain], Keys]) -> Settings:
    """Return a file's settings, or defaults if it is missing; errors become complaints.

    `read_keys` is given the table [keys].
    """
    try:
        file = TomlFile(path)
    except TomlFileError as error:
        if isinstance(error.__cause__, FileNotFoundError):
            return Settings()
        return Settings(complaints=(f"{error}. The file is ignored.",))
    hints = {row.name: row.hint for row in rows()} | {"keys": dict[str, Any]}
    values = file.table(hints, file.data)
    keys = read_keys(values.get("keys", {}), lambda name, text: file.problem(("keys", name), text))
    return Settings(**values | {"keys": keys, "complaints": file.problems})


def write_setting(path: Path, name: str, value: object) -> None:
    """Write one setting into a file, which keeps its comments; None leaves it to the game.

    Raises InputError if the file is not valid, or can't be written.
    """
    try:
        text = _edit_text(read_text(path, _MOST_BYTES) if path.exists() else "", name, value)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, text)
    except (OSError, InputError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"The setting can't be saved in {path}: {reason}") from error


def _edit_text(text: str, name: str, value: object) -> str:
    """Return the text with one line changed: tomlkit takes minutes for a hostile megabyte."""
    expected = {key: setting for key, setting in parse_toml(text).items() if key != name}
    header = re.search(r"^[ \t]*+\[", text, re.MULTILINE)
    end = header.start() if header else len(text)
    head, tables = text[:end], text[end:]
    assignment = rf"""^[ \t]*+{name}[ \t]*+=[ \t]*+(?:"[^"\n]*"|'[^'\n]*'|[^\s#]++)"""
    if value is None:
        head = re.sub(rf"{assignment}.*\n?", "", head, count=1, flags=re.MULTILINE)
    else:
        expected[name] = value
        line = f"{name} = {json.dumps(value, ensure_ascii=False)}"
        head, number = re.subn(assignment, lambda _: line, head, count=1, flags=re.MULTILINE)
        if not number:
            body = head.rstrip()
            tail = head[len(body) :] or "\n"
            head = f"{body}\n{line}{tail}".lstrip("\n")
    if parse_toml(head + tables) != expected:
        raise InputError(f"Change {name} there by hand: it is not on a line of its own")
    return head + tables


def as_toml(settings: Settings) -> Iterator[str]:
    """Yield the lines of a file that sets the same, but for the keys."""
    for row in rows():
        value = getattr(settings, row.name)
        if value is None:
            yield toml_line(f"# {row.name}", row.kind.choices[0], row.sentence)
        else:
            yield toml_line(row.name, value, row.sentence)


def toml_line(name: str, value: object, sentence: str) -> str:
    return f"{f'{name} = {json.dumps(value, ensure_ascii=False)}':<40}  # {sentence}"
